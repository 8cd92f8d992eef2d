"""Converts coordinates of other packages into those of a planar robot, by the names of the joints.

+-----------+------------------------+---------------------------------------------+--------------------+
|           | base in q              | base in v                                   | continuous joints  |
+===========+========================+=============================================+====================+
| Pinocchio | x y z, quaternion xyzw | linear, angular, both in the body's frame   | cosine and sine    |
| MuJoCo    | x y z, quaternion wxyz | linear in the world's, angular in the body's| angle              |
| Drake     | quaternion wxyz, x y z | angular, linear, both in the world's frame  | angle              |
+-----------+------------------------+---------------------------------------------+--------------------+

Forward and up in the world are the axes of the robot's plane: x and z for a robot in its x-z plane.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import Robot

Array = NDArray[np.float64]

_AXES = dict(zip("xyz", np.eye(3), strict=True))


@dataclass
class Joint:
    """The places of a joint of one degree of freedom in q and in v."""

    q: int
    v: int
    unit_circle: bool = False
    """Whether q holds the cosine and the sine of the joint's angle."""
    zero: float = 0.0
    """The value in q at which the robot's coordinate is zero [rad, m]."""


@dataclass
class Base:
    """The places of a free base in q and in v, and the frames of its velocities."""

    position: slice
    """x, y, z."""
    quaternion: list[int]
    """w, x, y, z."""
    linear: slice
    angular: slice
    linear_in_body: bool
    angular_in_body: bool


@dataclass
class Layout:
    """The vectors q and v of another package's model."""

    nq: int
    nv: int
    joints: dict[str, Joint] = field(default_factory=dict)
    base: Base | None = None

    def __call__(self, robot: Robot, q: ArrayLike, v: ArrayLike, *, tolerance: float = 1e-6) -> tuple[Array, Array]:
        """Convert states to the arrays that `Robot.impacts` takes.

        `q` is (n, nq) or (nq,), `v` (n, nv) or (nv,), both as the other package has them. Returns q and v, each
        (n, len(robot.coordinates)), x z pitch first [m, rad, m/s, rad/s].

        Raises ValueError if the motion leaves the robot's plane by more than `tolerance` [rad, m/s, rad/s], a joint
        that the planar robot does not have moves, or one does not follow the joint that it mimics; the message says by
        how much. A row with a number that is not finite or masked becomes NaN, which `Robot.impacts` refuses.
        """
        given_q, given_v = self._rows("q", q, self.nq), self._rows("v", v, self.nv)
        if len(given_q) != len(given_v):
            raise ValueError(f"q has {len(given_q)} rows and v {len(given_v)}")
        finite = np.isfinite(np.hstack([given_q, given_v])).all(axis=1, keepdims=True)
        given_q, given_v = np.where(finite, given_q, np.nan), np.where(finite, given_v, np.nan)
        names = robot.coordinates
        joints = names[3:] if names[:3] == ["x", "z", "pitch"] and self._is_floating(robot) else names
        missing = [name for name in joints if name not in self.joints]
        if missing:
            raise ValueError(f"the model has no joint of one degree of freedom named {', '.join(missing)}")
        positions: list[Array] = []
        velocities: list[Array] = []
        if len(joints) < len(names):
            positions, velocities = self._planar(robot, given_q, given_v, tolerance)
        elif self.base is not None:
            self._refuse_base(self.base, given_q, given_v, tolerance)
        for name in joints:
            positions.append(self._angle(given_q, self.joints[name]))
            velocities.append(given_v[:, self.joints[name].v])
        self._refuse_others(robot, given_q, given_v, tolerance)
        return np.stack(positions, axis=1), np.stack(velocities, axis=1)

    @staticmethod
    def _rows(what: str, values: ArrayLike, columns: int) -> Array:
        if np.iscomplexobj(values):
            raise TypeError(f"{what} holds complex numbers")
        rows: Array = np.atleast_2d(np.ma.asarray(values, dtype=float).filled(np.nan))
        if rows.ndim != 2 or rows.shape[1] != columns:
            raise ValueError(f"{what} has the shape {np.shape(values)}, and the model needs (n, {columns})")
        return rows

    def _is_floating(self, robot: Robot) -> bool:
        floating: bool = robot.inspect()["base"] == "floating"
        if floating and self.base is None:
            raise ValueError("the robot has a floating base and the model has none: add a free joint to the model")
        return floating

    @staticmethod
    def _angle(q: Array, joint: Joint) -> Array:
        if not joint.unit_circle:
            return q[:, joint.q] - joint.zero
        _refuse_length("the cosine and sine of a joint have", q[:, joint.q : joint.q + 2])
        return np.arctan2(q[:, joint.q + 1], q[:, joint.q])

    def _planar(self, robot: Robot, q: Array, v: Array, tolerance: float) -> tuple[list[Array], list[Array]]:
        """x, z, pitch of the base and their rates."""
        assert self.base is not None
        base = self.base
        forward, up = (_AXES[axis] for axis in robot.plane)
        normal = np.cross(up, forward)
        quaternion = q[:, base.quaternion]
        _refuse_length("a quaternion of the base has", quaternion)
        w, vector = quaternion[:, 0], quaternion[:, 1:]
        across = np.linalg.norm(vector - np.outer(vector @ normal, normal), axis=1)
        _refuse("the base is turned out of the plane", 2 * across, "rad", tolerance)
        pitch = np.arctan2(2 * w * (vector @ normal), w**2 - (vector @ normal) ** 2)
        cos, sin = np.cos(pitch)[:, None], np.sin(pitch)[:, None]

        def to_world(vectors: Array, in_body: bool) -> Array:
            if not in_body:
                return vectors
            along, upward = (vectors @ forward)[:, None], (vectors @ up)[:, None]
            turned: Array = (cos * along + sin * upward) * forward + (cos * upward - sin * along) * up
            return turned + np.outer(vectors @ normal, normal)

        linear = to_world(v[:, base.linear], base.linear_in_body)
        angular = to_world(v[:, base.angular], base.angular_in_body)
        _refuse("the base moves out of the plane", np.abs(linear @ normal), "m/s", tolerance)
        tilt = np.linalg.norm(angular - np.outer(angular @ normal, normal), axis=1)
        _refuse("the base turns out of the plane", tilt, "rad/s", tolerance)
        origin = q[:, base.position]
        return [origin @ forward, origin @ up, pitch], [linear @ forward, linear @ up, angular @ normal]

    @staticmethod
    def _refuse_base(base: Base, q: Array, v: Array, tolerance: float) -> None:
        what = "the base, which is fixed in the planar robot,"
        off = np.linalg.norm(np.hstack([q[:, base.position], 2 * q[:, base.quaternion[1:]]]), axis=1)
        rate = np.linalg.norm(np.hstack([v[:, base.linear], v[:, base.angular]]), axis=1)
        _refuse(f"{what} is off", off, "m or rad", tolerance)
        _refuse(f"{what} moves", rate, "m/s or rad/s", tolerance)

    def _refuse_others(self, robot: Robot, q: Array, v: Array, tolerance: float) -> None:
        inspection = robot.inspect()
        followers = {follower["name"]: follower for follower in inspection["followers"]}
        held = robot.held
        for name in sorted(self.joints.keys() - set(robot.coordinates)):
            joint = self.joints[name]
            position, rate = self._angle(q, joint), v[:, joint.v]
            if follower := followers.get(name):
                leader, multiplier = self.joints[follower["leader"]], follower["multiplier"]
                what = f"joint {name}, which mimics {follower['leader']} in the planar robot,"
                moves = "is off in its rate"
                off = position - (multiplier * self._angle(q, leader) + follower["offset"])
                rate = rate - multiplier * v[:, leader.v]
            else:
                what, moves = f"joint {name}, which is held in the planar robot,", "moves"
                off = position - held.get(name, 0.0)
            if joint.unit_circle:
                off = np.remainder(off + np.pi, 2 * np.pi) - np.pi
            _refuse(f"{what} is off", np.abs(off), "rad or m", tolerance)
            _refuse(f"{what} {moves}", np.abs(rate), "rad/s or m/s", tolerance)


def _refuse_length(what: str, vectors: Array) -> None:
    length = np.linalg.norm(vectors, axis=1)
    if np.any(np.abs(length - 1) > 1e-3):
        worst = length[np.nanargmax(np.abs(length - 1))]
        raise ValueError(f"{what} the length {worst}, not 1")


def _refuse(what: str, sizes: Array, unit: str, tolerance: float) -> None:
    # Rows of NaN pass here: `Robot.impacts` refuses them.
    sizes = np.nan_to_num(sizes, nan=0.0)
    worst = int(np.argmax(sizes)) if len(sizes) else 0
    if len(sizes) and not sizes[worst] <= tolerance:
        size = f"{sizes[worst]:.3e} {unit} in row {worst}"
        raise ValueError(f"{what} by {size}, more than the tolerance of {tolerance:.3e}")


def from_pinocchio(model: Any) -> Layout:
    """The layout of a `pinocchio.Model`; its base is a JointModelFreeFlyer."""
    layout = Layout(model.nq, model.nv)
    for at in range(1, model.njoints):
        q, v = model.idx_qs[at], model.idx_vs[at]
        match model.nqs[at], model.nvs[at]:
            case 7, 6 if layout.base is None:
                if not model.jointPlacements[at].isIdentity(1e-12):
                    raise ValueError(
                        f"the base's joint {model.names[at]} is not placed at the world's origin, so that its numbers are "
                        "not those of the base: set its entry of model.jointPlacements to the identity"
                    )
                quaternion = [q + 6, q + 3, q + 4, q + 5]
                layout.base = Base(slice(q, q + 3), quaternion, slice(v, v + 3), slice(v + 3, v + 6), True, True)
            case 1 | 2 as size, 1:
                layout.joints[model.names[at]] = Joint(q, v, size == 2)
            case 0, _:
                pass
            case size:
                raise ValueError(f"joint {model.names[at]} has {size} numbers in q and v, which no planar joint has")
    return layout


def from_mujoco(model: Any) -> Layout:
    """The layout of a `mujoco.MjModel`; its base is a free joint, which must be added to a model from a URDF."""
    layout = Layout(model.nq, model.nv)
    for at in range(model.njnt):
        joint = model.joint(at)
        q, v, kind = int(joint.qposadr[0]), int(joint.dofadr[0]), int(joint.type[0])
        if kind == 0 and layout.base is None:
            quaternion = list(range(q + 3, q + 7))
            layout.base = Base(slice(q, q + 3), quaternion, slice(v, v + 3), slice(v + 3, v + 6), False, True)
        elif kind in (2, 3):
            layout.joints[joint.name] = Joint(q, v, zero=float(model.qpos0[q]))
        else:
            raise ValueError(f"joint {joint.name} is a ball joint or a second free one, which no planar robot has")
    return layout


def from_drake(plant: Any) -> Layout:
    """The layout of a finalized `pydrake.multibody.plant.MultibodyPlant` of one robot with a free base."""
    layout = Layout(plant.num_positions(), plant.num_velocities())
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        q, v = joint.position_start(), joint.velocity_start()
        match joint.num_positions(), joint.num_velocities():
            case 7, 6 if layout.base is None:
                frames = [own.GetFixedPoseInBodyFrame() for own in (joint.frame_on_parent(), joint.frame_on_child())]
                is_on_world = joint.parent_body().index() == plant.world_body().index()
                if not is_on_world or not all(own.IsNearlyIdentity(1e-12) for own in frames):
                    raise ValueError(
                        f"the base's joint {joint.name()} does not join the frames of the world and of its body, so "
                        "that its numbers are not those of the base: let it join plant.world_frame() and "
                        "body.body_frame()"
                    )
                quaternion = list(range(q, q + 4))
                layout.base = Base(slice(q + 4, q + 7), quaternion, slice(v + 3, v + 6), slice(v, v + 3), False, False)
            case 1, 1:
                layout.joints[joint.name()] = Joint(q, v)
            case 0, _:
                pass
            case size:
                raise ValueError(f"joint {joint.name()} has {size} numbers in q and v, which no planar joint has")
    return layout
