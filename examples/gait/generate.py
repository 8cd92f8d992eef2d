#!/usr/bin/env python3
"""Makes ramone_walk.ndjson and ramone_walk.csv: keyframes of the robot RAMone walking on level ground toward +x.

    python3 examples/gait/generate.py        (numpy and scipy, nothing else)

The step results from a trajectory optimization with the full rigid-body dynamics; the keyframes are states on it.

Model       Read from urdf/ramone.urdf: a planar floating base (x, z, pitch) and four joints, every link's mass, CoG and
            moment of inertia, two round feet. One foot at a time stands and rolls without slip; a step ends when the other
            foot touches down: a rigid impact in which the leading foot sticks and the trailing one lifts (checked).
            Coriolis, centrifugal and gravity terms are all there; the ground is level; hips and knees are driven.
Method      Rolling leaves 5 degrees of freedom and there are 4 motors. The four joints follow virtual constraints, Bezier
            polynomials of a phase s in [0, 1] that runs with the stance leg's angle in space; what is left is one equation
            of motion, that of the unactuated rotation about the contact. Written for K = (ds/dt)^2 it is a linear ODE in s:
            A(s) K'/2 + B(s) K + C(s) = 0, solved on Chebyshev points to rounding. (Westervelt, Grizzle and Koditschek,
            "Hybrid zero dynamics of planar biped walkers", IEEE TAC 2003.)
Problem     Least integral of the squared joint torques per metre, at a given speed, such that the state after the impact,
            with the legs swapped, is the state at the step's beginning; with the ground's force inside the friction cone,
            the swing foot clear of the ground, and the knees bent backward. SLSQP with complex-step gradients, then
            Newton's method on the periodicity. Half a minute; another BLAS moves the keyframes by some 1e-9.
Checks      (printed; a failure stops) the step is simulated once more another way: 7 coordinates, contact force as Lagrange
            multiplier, joint feedback, touchdown as an event. Energy, momentum, cones and clearance are balanced as well.

Frames as in heelstrike: SI units and radians, x forward, z up, pitch positive nose down, joints with the URDF's sign,
velocities are time derivatives of positions. RAMone's joint axes are 0 -1 0: a positive hip angle swings the leg forward,
and the human-like knee for a walk toward +x is negative (the shank goes backward).
"""
import json
import os
import xml.etree.ElementTree as ET

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")   # the last digits of the result depend on it

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize

HERE = os.path.dirname(os.path.abspath(__file__))
URDF = os.path.join(HERE, "..", "..", "urdf", "ramone.urdf")

GRAVITY = 9.81      # m/s^2
FRICTION = 0.6      # written into the NDJSON's states
SPEED = 0.5         # m/s, average
KEYFRAMES = 50      # per step, intervals of equal time
CONE = 0.5          # friction that the walk may need at most, in the step and in the impact
CLEARANCE = 0.015   # m, the swing foot's least height at mid-step
KNEE = -0.08        # rad, the straightest knee
DEGREE = 7          # degree of the Bezier polynomials
RATE = 8.0          # rad/s, the fastest joint
SLIP = 0.3          # m/s, the fastest striking foot along the ground
COARSE, FINE = 41, 121   # Chebyshev points along a step, for the optimization and for its result


# ------------------------------------------------------------------------------------------------------------ the model

class Robot:
    """A planar tree with floating base, q = [x, z, pitch, joints in the file's order]; every method takes stacks of q.

    A link's angle about +y is linear in q (row `turn`), and a point of it is the base plus a sum of vectors that each turn
    with one link: a list of (turn, (x, z)).
    """

    def __init__(self, path):
        root = ET.parse(path).getroot()
        links = {e.get("name"): e for e in root.findall("link")}
        joints = root.findall("joint")
        moving = [j for j in joints if j.get("type") in ("continuous", "revolute")]
        self.names = [j.get("name") for j in moving]
        self.n = 3 + len(moving)
        base = (set(links) - {j.find("child").get("link") for j in joints}).pop()
        at = {base: (np.eye(self.n)[2], [])}
        todo = list(joints)
        while todo:
            for joint in [j for j in todo if j.find("parent").get("link") in at]:
                todo.remove(joint)
                turn, chain = at[joint.find("parent").get("link")]
                chain = chain + [(turn, vector(joint.find("origin")))]
                if joint in moving:
                    x, y, z = (float(w) for w in joint.find("axis").get("xyz").split())
                    assert x == z == 0 and abs(y) == 1
                    turn = turn + y * np.eye(self.n)[3 + self.names.index(joint.get("name"))]
                at[joint.find("child").get("link")] = (turn, chain)
        self.bodies, self.feet = [], {}
        for name, link in links.items():
            turn, chain = at[name]
            inertial, sphere = link.find("inertial"), link.find("collision/geometry/sphere")
            if inertial is not None:
                mass = float(inertial.find("mass").get("value"))
                iyy = float(inertial.find("inertia").get("iyy"))
                self.bodies.append((mass, iyy, turn, chain + [(turn, vector(inertial.find("origin")))]))
            if sphere is not None:
                centre = chain + [(turn, vector(link.find("collision/origin")))]
                self.feet[name] = (float(sphere.get("radius")), turn, centre)
        self.mass = sum(b[0] for b in self.bodies)

    def point(self, q, chain):
        """Position (.., 2), Jacobian (.., 2, n) and, as a function of v, the Jacobian's rate times v."""
        p = q[..., :2].copy()
        jac = np.zeros(q.shape[:-1] + (2, self.n), q.dtype)
        jac[..., 0, 0] = jac[..., 1, 1] = 1
        parts = []
        for turn, (x, z) in chain:
            c, s = np.cos(q @ turn), np.sin(q @ turn)
            r = np.stack([x * c + z * s, z * c - x * s], -1)          # turned about +y
            p = p + r
            jac += np.stack([r[..., 1], -r[..., 0]], -1)[..., None] * turn
            parts.append((turn, r))

        def rate(v):
            return -sum(r * ((v @ turn) ** 2)[..., None] for turn, r in parts)
        return p, jac, rate

    def foot(self, q, name):
        """A foot's lowest point (.., 2), the Jacobian of that material point, rows t and n, and its rate times v.

        The tangential row is the gradient of (center's x - radius * angle), which rolling keeps constant."""
        radius, turn, chain = self.feet[name]
        p, jac, rate = self.point(q, chain)
        p[..., 1] -= radius
        jac[..., 0, :] -= radius * turn
        return p, jac, rate

    def dynamics(self, q, v):
        """Mass matrix, Coriolis and centrifugal terms, gravity terms: M dv/dt + h + g = generalized force."""
        mass = np.zeros(q.shape + (self.n,), q.dtype)
        h, g = np.zeros_like(q), np.zeros_like(q)
        for m, iyy, turn, chain in self.bodies:
            _, jac, rate = self.point(q, chain)
            jact = np.swapaxes(jac, -1, -2)
            mass += m * (jact @ jac) + iyy * np.outer(turn, turn)
            h = h + m * (jact @ rate(v)[..., None])[..., 0]
            g = g + m * GRAVITY * jac[..., 1, :]
        return mass, h, g

    def energy(self, q, v):
        """Kinetic and potential energy."""
        t = u = 0
        for m, iyy, turn, chain in self.bodies:
            p, jac, _ = self.point(q, chain)
            w = (jac @ v[..., None])[..., 0]
            t = t + m / 2 * (w ** 2).sum(-1) + iyy / 2 * (v @ turn) ** 2
            u = u + m * GRAVITY * p[..., 1]
        return t, u

    def impact(self, q, v, foot):
        """The rigid impact in which `foot` sticks and nothing else touches: velocity after, impulse (t, n)."""
        mass, _, _ = self.dynamics(q, v)
        _, jac, _ = self.foot(q, foot)
        a = np.linalg.solve(mass, jac.T)
        impulse = np.linalg.solve(jac @ a, -(jac @ v))
        return v + a @ impulse, impulse


def vector(origin):
    x, _, z = (float(w) for w in origin.get("xyz").split()) if origin is not None else (0.0, 0.0, 0.0)
    assert origin is None or origin.get("rpy", "0 0 0").split() == ["0"] * 3
    return x, z


robot = Robot(URDF)
assert robot.names == ["left_hip", "left_knee", "right_hip", "right_knee"]
STANCE, SWING = "left_foot", "right_foot"                             # of the step that is optimized
SWAP = [0, 1, 2, 5, 6, 3, 4]                                          # left leg <-> right leg


def ride(y, dy, ddy):
    """All of q and its derivatives from (pitch, joints) and their derivatives, while the stance foot rolls.

    The foot touches x = radius * angle, where angle is its angle in space."""
    radius, turn, _ = robot.feet[STANCE]
    q = np.concatenate([np.zeros(y.shape[:-1] + (2,), y.dtype), y], -1)
    p, jac, rate = robot.foot(q, STANCE)
    q[..., 0] = radius * (q @ turn) - p[..., 0]
    q[..., 1] = -p[..., 1]
    basis = np.zeros(y.shape[:-1] + (robot.n, robot.n - 2), y.dtype)  # dq = basis dy
    basis[..., 2:, :] = np.eye(robot.n - 2)
    basis[..., :2, :] = -jac[..., :, 2:]
    dq = (basis @ dy[..., None])[..., 0]
    ddq = (basis @ ddy[..., None])[..., 0]
    ddq[..., :2] -= rate(dq)
    return q, dq, ddq, basis


# ----------------------------------------------------------------------------------------------- one step, by its phase

def chebyshev(n):
    """Points ascending in [0, 1], differentiation matrix, weights of the integral (Clenshaw and Curtis)."""
    k = np.arange(n)
    x = -np.cos(np.pi * k / (n - 1))
    c = np.where((k == 0) | (k == n - 1), 2.0, 1.0) * (-1.0) ** k
    dx = x[:, None] - x[None, :] + np.eye(n)
    d = np.outer(c, 1 / c) / dx
    d -= np.diag(d.sum(1))
    vander = np.polynomial.chebyshev.chebvander(x, n - 1)
    moments = np.array([2 / (1 - j * j) if j % 2 == 0 else 0.0 for j in range(n)])
    return (x + 1) / 2, 2 * d, np.linalg.solve(vander.T, moments) / 2


def bernstein(s, degree):
    """Values, first and second derivatives of the Bernstein basis, (len(s), degree + 1)."""
    def basis(d):
        b = np.ones((len(s), 1))
        for _ in range(d):
            b = (np.pad(b, ((0, 0), (0, 1))) * (1 - s)[:, None]) + np.pad(b, ((0, 0), (1, 0))) * s[:, None]
        return b

    def derive(b):                                                    # from degree d - 1 to d
        return b.shape[1] * (np.pad(b, ((0, 0), (1, 0))) - np.pad(b, ((0, 0), (0, 1))))
    return basis(degree), derive(basis(degree - 1)), derive(derive(basis(degree - 2)))


def path(z, s):
    """(pitch, joints) of the phase, and its first two derivatives. z: leg angle at both ends, K at 0, Bezier points.

    The leg angle in space is pitch - hip - knee/2 of the stance leg: about the line from the hip to the foot."""
    bezier = z[3:].reshape(4, DEGREE + 1).T
    out = []
    for order, basis in enumerate(bernstein(s, DEGREE)):
        joints = basis @ bezier
        leg = [z[0] + (z[1] - z[0]) * s, (z[1] - z[0]) + 0 * s, 0 * s][order]
        out.append(np.concatenate([(leg + joints[:, 0] + joints[:, 1] / 2)[:, None], joints], 1))
    return out


def grid(n):
    global NODES, S, D, W
    NODES, (S, D, W) = n, chebyshev(n)


def step(z):
    """Everything about the step that the unknowns z describe, on the Chebyshev points."""
    y, dy, ddy = path(z, S)
    q, dq, ddq, basis = ride(y, dy, ddy)
    mass, h, g = robot.dynamics(q, dq)
    # The pitch's row of the equations of motion, in which neither motors nor the rolling contact appear.
    free = basis[..., :, 0]
    a = (free * (mass @ dq[..., None])[..., 0]).sum(-1)
    b = (free * ((mass @ ddq[..., None])[..., 0] + h)).sum(-1)
    c = (free * g).sum(-1)
    lhs = D + np.diag(2 * b / a)
    rhs = -2 * c / a
    lhs[0], rhs[0] = np.eye(NODES)[0], z[2]
    k = np.linalg.solve(lhs, rhs)                                     # (ds/dt)^2
    dds = -(b * k + c) / a
    v = dq * np.sqrt(k)[:, None]
    acc = dq * dds[:, None] + ddq * k[:, None]
    force = (mass @ acc[..., None])[..., 0] + h * k[:, None] + g      # generalized: the ground's and the motors'
    torque = (np.swapaxes(basis, -1, -2) @ force[..., None])[..., 0]  # the motors' alone; [0] is zero
    time = W @ (1 / np.sqrt(k))
    foot, jac, _ = robot.foot(q, SWING)
    strike, impulse = robot.impact(q[-1], v[-1], SWING)
    trailing = robot.foot(q[-1], STANCE)[1] @ strike
    return dict(y=y, q=q, v=v, k=k, slope=b / a, time=time, torque=torque, ground=force[:, :2], foot=foot,
                down=(jac[-1] @ v[-1]), strike=strike, impulse=impulse, trailing=trailing,
                length=foot[-1, 0] - robot.foot(q[0], STANCE)[0][0],
                effort=W @ ((torque[:, 1:] ** 2).sum(-1) / np.sqrt(k)))


def periodic(r):
    """Zero for a step that repeats itself: pose, height of the foot, velocity."""
    return np.concatenate([r["q"][-1, SWAP][2:] - r["q"][0, 2:], r["foot"][-1:, 1],
                           (r["strike"][SWAP][2:] - r["v"][0, 2:]) / 10])


def equalities(r):
    return np.append(periodic(r), r["length"] / r["time"] - SPEED)


def inequalities(r):
    fx, fz = r["ground"].T / robot.mass / GRAVITY
    lx, lz = r["impulse"]
    pitch, knees, rates = r["q"][:, 2], r["q"][:, [4, 6]].ravel(), r["v"][:, 3:].ravel() / RATE
    slip, fall = r["down"]
    inner = slice(1, -1)
    return np.concatenate([
        r["k"] - 0.3,                                                 # the phase never stops
        CONE * fz - fx, CONE * fz + fx, fz - 0.2,                     # the ground only pushes
        [CONE * lz - lx, CONE * lz + lx],
        [10 * r["trailing"][1] - 0.5, -10 * fall - 0.5, SLIP - slip, SLIP + slip],   # one foot lifts, the other falls
        50 * (r["foot"][inner, 1] - CLEARANCE * (4 * S * (1 - S))[inner]),
        KNEE - knees, knees + 1.6, 0.25 - pitch, pitch + 0.25, 1 - rates, 1 + rates])


def objective(r):
    return np.array([r["effort"] / r["length"] / 100])


PARTS = [objective, equalities, inequalities]


class Cached:
    """Values of PARTS and their Jacobians by complex steps, each point computed once."""

    def __init__(self):
        self.at = self.values = self.jacobians = None

    def move(self, z):
        if self.at is None or not np.array_equal(z, self.at):
            self.at, self.jacobians = z.copy(), None
            r = step(z)
            self.values = [part(r) for part in PARTS]

    def value(self, i):
        def of(z):
            self.move(z)
            return self.values[i] if i else self.values[i][0]
        return of

    def jacobian(self, i):
        def of(z):
            self.move(z)
            if self.jacobians is None:
                rs = [step(z + 1e-30j * e) for e in np.eye(len(z))]
                self.jacobians = [np.array([part(r).imag / 1e-30 for r in rs]).T for part in PARTS]
            return self.jacobians[i] if i else self.jacobians[i][0]
        return of


def optimize():
    grid(COARSE)
    s = np.linspace(0, 1, DEGREE + 1)
    bump = np.sin(np.pi * s)
    guess = np.concatenate([[-0.28, 0.28, 9.0], 0.38 - 0.60 * s, -0.2 - 0.1 * bump, -0.22 + 0.60 * s, -0.2 - 0.9 * bump])
    f = Cached()
    best = minimize(f.value(0), guess, jac=f.jacobian(0), method="SLSQP",
                    constraints=[dict(type="eq", fun=f.value(1), jac=f.jacobian(1)),
                                 dict(type="ineq", fun=f.value(2), jac=f.jacobian(2))],
                    options=dict(maxiter=600, ftol=1e-8))
    print(f"optimization: {best.message}, {best.nit} iterations")
    grid(FINE)
    z, f = best.x, Cached()
    for _ in range(6):                                                # to the nearest solution of the equalities
        z = z - np.linalg.lstsq(f.jacobian(1)(z), f.value(1)(z), rcond=None)[0]
    return z


# -------------------------------------------------------------------------------------------------------- the keyframes

def interpolation(s):
    """Matrix that takes values on the Chebyshev points to values at s."""
    vander = np.polynomial.chebyshev.chebvander
    return np.linalg.solve(vander(2 * S - 1, NODES - 1).T, vander(2 * s - 1, NODES - 1).T).T


def states(z, k, s):
    """q and v at phases s."""
    y, dy, ddy = path(z, s)
    q, dq, _, _ = ride(y, dy, ddy)
    return q, dq * np.sqrt(interpolation(s) @ k)[:, None]


def phases(r, times):
    """The phases at these times: t(s) is the integral of 1 / sqrt(K), inverted by Newton's method."""
    rate = 1 / np.sqrt(r["k"])
    lhs, rhs = D.copy(), rate.copy()
    lhs[0], rhs[0] = np.eye(NODES)[0], 0
    t = np.linalg.solve(lhs, rhs)
    s = np.interp(times, t, S)
    for _ in range(20):
        m = interpolation(s)
        s = np.clip(s - (m @ t - times) / (m @ rate), 0, 1)
    s[0], s[-1] = 0, 1
    return s


def keyframes(z):
    """Two steps, each from just after the impact to just before the next: times, q, v."""
    r = step(z)
    times = np.linspace(0, r["time"], KEYFRAMES + 1)
    q, v = states(z, r["k"], phases(r, times))
    second = q[:, SWAP] + r["length"] * np.eye(robot.n)[0]
    return np.append(times, times + r["time"]), np.append(q, second, 0), np.append(v, v[:, SWAP], 0)


# ----------------------------------------------------------------------------------------------------------- the checks

def simulate(z, q, v, stance, swing, samples):
    """One step from q, v in all 7 coordinates until the swing foot strikes: times of the samples and the states there.

    Unknown at every instant: accelerations, the ground's force, the motors' torques. Equations: motion, rolling without
    slip, joint feedback onto the virtual constraints (computed torque)."""
    left = stance == STANCE
    order = np.arange(robot.n) if left else np.array(SWAP)
    leg = np.zeros(robot.n)
    leg[[2, order[3], order[4]]] = 1, -1, -0.5

    def rate(_, state):
        q, v = state[:robot.n], state[robot.n:]
        mass, h, g = robot.dynamics(q, v)
        _, jac, bend = robot.foot(q, stance)
        s, ds = (leg @ q - z[0]) / (z[1] - z[0]), leg @ v / (z[1] - z[0])
        y, dy, ddy = (p[0, 1:] for p in path(z, np.array([s])))
        joints = order[3:]
        want = ddy * ds ** 2 - 400 * (q[joints] - y) - 40 * (v[joints] - dy * ds)
        n, m = robot.n, robot.n - 3
        lhs, rhs = np.zeros((n + 2 + m, n + 2 + m)), np.zeros(n + 2 + m)
        lhs[:n, :n], lhs[:n, n:n + 2], lhs[joints, n + 2 + np.arange(m)] = mass, -jac.T, -1
        rhs[:n] = -h - g
        lhs[n:n + 2, :n], rhs[n:n + 2] = jac, -bend(v)
        lhs[n + 2:, :n] = np.eye(n)[joints] - np.outer(dy, leg) / (z[1] - z[0])
        rhs[n + 2:] = want
        return np.append(v, np.linalg.solve(lhs, rhs)[:n])

    def touchdown(t, state):
        return robot.foot(state[:robot.n], swing)[0][1] if t > 0.05 else 1.0
    touchdown.terminal, touchdown.direction = True, -1
    run = solve_ivp(rate, (0, 5), np.append(q, v), "DOP853", rtol=1e-12, atol=1e-13, events=touchdown, dense_output=True)
    assert run.status == 1
    times = np.linspace(0, run.t_events[0][0], samples)
    return times, run.sol(times).T


def check(z, times, q, v):
    def tell(what, value, good):
        print(f"  {what:<72} {value:.3g}")
        if not good:
            raise SystemExit(f"failed: {what}")

    def small(what, value, bound):
        tell(what, np.abs(value).max(), np.abs(value).max() <= bound)

    r = step(z)
    weight = robot.mass * GRAVITY
    print(f"step: {r['length']:.6f} m in {r['time']:.6f} s; torques up to {np.abs(r['torque']).max():.3g} N m, "
          f"joint speeds up to {np.abs(r['v'][:, 3:]).max():.3g} rad/s")
    print(f"impact: impulse {r['impulse'][0]:.4f}, {r['impulse'][1]:.4f} N s; the trailing foot leaves with "
          f"{r['trailing'][0]:.4f}, {r['trailing'][1]:.4f} m/s")
    small("periodicity (pose, foot height, velocity)", periodic(r), 1e-11)
    small("generalized force on the unactuated pitch [N m]", r["torque"][:, 0], 1e-10)

    fine = np.linspace(0, 1, 2001)
    fx, fz = (interpolation(fine) @ r["ground"]).T
    tell("least normal force over the weight", fz.min() / weight, fz.min() > 0)
    tell("greatest friction needed in the step", np.abs(fx / fz).max(), np.abs(fx / fz).max() < FRICTION)
    lx, lz = r["impulse"]
    tell("friction needed in the impact", abs(lx) / lz, lz > 0 and abs(lx) < FRICTION * lz)
    tell("trailing foot's normal speed after the impact [m/s]", r["trailing"][1], r["trailing"][1] > 0)
    tell("striking foot's normal speed before [m/s]", r["down"][1], r["down"][1] < 0)
    fq, fv = states(z, r["k"], fine)
    clear = robot.foot(fq, SWING)[0][:, 1]
    tell("swing foot's least height between 5 % and 95 % of the phase [m]", clear[100:-100].min(), clear[1:-1].min() > 0)
    tell("greatest knee angle (straight is 0) [rad]", fq[:, [4, 6]].max(), fq[:, [4, 6]].max() < 0)

    work = W @ (r["torque"][:, 1:] * r["v"][:, 3:] / np.sqrt(r["k"])[:, None]).sum(-1)
    kinetic, potential = robot.energy(r["q"], r["v"])
    loss = kinetic[-1] - robot.energy(r["q"][-1], r["strike"])[0]
    print(f"energy: motors {work:.6f} J per step, impact takes {loss:.6f} J, kinetic before it {kinetic[-1]:.6f} J")
    gained = (kinetic + potential)[-1] - (kinetic + potential)[0]
    small("energy over the step minus the motors' work [J]", gained - work, 1e-10)
    small("the motors' work minus what the impact takes [J]", work - loss, 1e-10)
    down = r["down"] + robot.foot(r["q"][-1], SWING)[1] @ r["strike"]
    small("what the impact takes minus -L (c- + c+) / 2 [J]", loss + r["impulse"] @ down / 2, 1e-12)
    push = W @ (r["ground"] / np.sqrt(r["k"])[:, None]) + r["impulse"]
    small("ground's momentum over a whole step minus (0, weight * time) [N s]", push - [0, weight * r["time"]], 1e-9)
    before, after = (momentum(r["q"][-1], w, r["foot"][-1]) for w in (r["v"][-1], r["strike"]))
    small("impact: linear momentum gained minus the impulse [N s]", (after - before)[:2] - r["impulse"], 1e-12)
    small("impact: angular momentum about the leading contact gained [N m s]", (after - before)[2], 1e-12)

    gain = np.exp(-2 * W @ r["slope"]) * r["k"][0] / r["k"][-1]
    tell("return map's multiplier (below 1: the walk is stable)", gain, abs(gain) < 1)
    # Simulate both steps once more, in all coordinates.
    half, worst, state = KEYFRAMES + 1, 0, np.append(q[0], v[0])
    for i, (stance, swing) in enumerate([(STANCE, SWING), (SWING, STANCE)]):
        t, run = simulate(z, state[:robot.n], state[robot.n:], stance, swing, half)
        rows = slice(i * half, (i + 1) * half)
        worst = max(worst, np.abs(run - np.append(q, v, 1)[rows]).max(), np.abs(t - times[rows] + i * r["time"]).max())
        end = run[-1]
        state = np.append(end[:robot.n], robot.impact(end[:robot.n], end[robot.n:], swing)[0])
    small("second simulation against the keyframes (times, positions, velocities)", worst, 1e-8)
    back = state - np.append(q[0] + 2 * r["length"] * np.eye(robot.n)[0], v[0])
    small("second simulation, after two steps, against its beginning", back, 1e-8)

    for i, foot in enumerate([STANCE, SWING]):
        rows = slice(i * half, (i + 1) * half)
        point, jac, _ = robot.foot(q[rows], foot)
        small(f"{foot} in its stance: height [m]", point[:, 1], 1e-14)
        small(f"{foot} in its stance: speed [m/s]", (jac @ v[rows][..., None]), 1e-14)


def momentum(q, v, about):
    """Linear momentum x, z, and angular momentum about +y and the point `about`."""
    out = np.zeros(3)
    for m, iyy, turn, chain in robot.bodies:
        p, jac, _ = robot.point(q, chain)
        (wx, wz), (x, z) = m * (jac @ v), p - about
        out += [wx, wz, z * wx - x * wz + iyy * (turn @ v)]
    return out


def write(times, q, v):
    names = ["x", "z", "pitch"] + robot.names
    with open(os.path.join(HERE, "ramone_walk.ndjson"), "w") as ndjson:
        for i in range(len(q)):
            def entries(row):
                values = dict(zip(names, map(float, row)))
                return {"base": {n: values[n] for n in names[:3]}, "joints": {n: values[n] for n in names[3:]}}
            state = {"id": f"gait/{i:03}", "position": entries(q[i]), "velocity": entries(v[i]), "friction": FRICTION}
            ndjson.write(json.dumps(state) + "\n")
    columns = ["base_x", "base_z", "base_pitch"] + robot.names
    with open(os.path.join(HERE, "ramone_walk.csv"), "w") as csv:
        csv.write(",".join(["id", "time"] + ["q_" + c for c in columns] + ["v_" + c for c in columns]) + "\n")
        for i in range(len(q)):
            numbers = [times[i], *q[i], *v[i]]
            csv.write(",".join([f"gait/{i:03}"] + [repr(float(x)) for x in numbers]) + "\n")


if __name__ == "__main__":
    unknowns = optimize()
    frames = keyframes(unknowns)
    check(unknowns, *frames)
    write(*frames)
    print(f"{len(frames[0])} keyframes")
