"""Converted states of Pinocchio, MuJoCo and Drake, against the packages' own kinematics."""

import numpy as np
import pytest
from conftest import peer

import heelstrike
from heelstrike._convert import Base

# The right leg comes before the left one; the knees are continuous; a roll joint leaves the plane.
LEG = """
  <link name="{side}_thigh"><inertial><origin xyz="0.01 0 -0.1"/><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="{side}_hip" type="revolute"><parent link="torso"/><child link="{side}_thigh"/>
    <origin xyz="0.02 {y} -0.1"/><axis xyz="0 {sign} 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <link name="{side}_shank"><inertial><origin xyz="0 0 -0.1"/><mass value="0.5"/>
    <inertia ixx="0.005" ixy="0" ixz="0" iyy="0.005" iyz="0" izz="0.005"/></inertial></link>
  <joint name="{side}_knee" type="continuous"><parent link="{side}_thigh"/><child link="{side}_shank"/>
    <origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/></joint>
"""
URDF = (
    """<robot name="biped"><link name="torso"><inertial><mass value="5"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>"""
    + LEG.format(side="right", y=-0.1, sign=1)
    + LEG.format(side="left", y=0.1, sign=-1)
    + """<link name="head"><inertial><mass value="0.2"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="neck_roll" type="revolute"><parent link="torso"/><child link="head"/><origin xyz="0 0 0.2"/>
    <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
)
FOOT = [0.03, 0.0, -0.25]
CONTACTS = [{"link": "right_shank", "offset": FOOT}, {"link": "left_shank", "offset": FOOT}]


class Pinocchio:
    def __init__(self):
        self.pin = peer("pinocchio")
        self.model = self.pin.buildModelFromXML(URDF, self.pin.JointModelFreeFlyer())
        self.layout = heelstrike.from_pinocchio(self.model)

    def state(self, position, quaternion, linear, angular, joints, rates):
        """q and v of the package, from base velocities in the world's frame and a quaternion w x y z."""
        q, v = self.pin.neutral(self.model), np.zeros(self.model.nv)
        turn = self.pin.Quaternion(*quaternion).toRotationMatrix()
        q[:7] = [*position, *quaternion[1:], quaternion[0]]
        v[:6] = [*(turn.T @ linear), *(turn.T @ angular)]
        for name, angle in joints.items():
            at = self.model.getJointId(name)
            start, size = self.model.idx_qs[at], self.model.nqs[at]
            q[start : start + size] = angle if size == 1 else [np.cos(angle), np.sin(angle)]
            v[self.model.idx_vs[at]] = rates[name]
        return q, v

    def velocities(self, q, v):
        pin, data = self.pin, self.model.createData()
        pin.forwardKinematics(self.model, data, q, v)
        for side in ("right", "left"):
            at = self.model.getJointId(f"{side}_knee")
            motion = pin.getVelocity(self.model, data, at, pin.LOCAL_WORLD_ALIGNED)
            yield motion.linear + np.cross(motion.angular, data.oMi[at].rotation @ FOOT)


class MuJoCo:
    def __init__(self):
        self.mujoco = peer("mujoco")
        spec = self.mujoco.MjSpec.from_string(URDF)
        spec.compiler.fusestatic = False
        root = spec.body("torso")
        root.add_freejoint()
        self.model = spec.compile()
        self.layout = heelstrike.from_mujoco(self.model)

    def state(self, position, quaternion, linear, angular, joints, rates):
        q, v = np.zeros(self.model.nq), np.zeros(self.model.nv)
        w, *vector = quaternion
        vector = np.array(vector)
        # MuJoCo has the angular velocity in the body's frame: turned by the conjugate quaternion.
        cross = np.cross(-vector, angular)
        local = angular + 2 * (w * cross + np.cross(-vector, cross))
        q[:7], v[:6] = [*position, *quaternion], [*linear, *local]
        for name, angle in joints.items():
            joint = self.model.joint(name)
            q[joint.qposadr[0]], v[joint.dofadr[0]] = angle, rates[name]
        return q, v

    def velocities(self, q, v):
        data = self.mujoco.MjData(self.model)
        data.qpos, data.qvel = q, v
        self.mujoco.mj_forward(self.model, data)
        for side in ("right", "left"):
            body = self.model.body(f"{side}_shank").id
            point = data.xpos[body] + data.xmat[body].reshape(3, 3) @ FOOT
            jacobian = np.zeros((3, self.model.nv))
            self.mujoco.mj_jac(self.model, data, jacobian, None, point, body)
            yield jacobian @ v


class Drake:
    def __init__(self):
        plant_module = peer("pydrake.multibody.plant")
        parsing = peer("pydrake.multibody.parsing")
        self.plant = plant_module.MultibodyPlant(0.0)
        parsing.Parser(self.plant).AddModelsFromString(URDF, "urdf")
        self.plant.Finalize()
        self.context = self.plant.CreateDefaultContext()
        self.layout = heelstrike.from_drake(self.plant)

    def state(self, position, quaternion, linear, angular, joints, rates):
        plant = self.plant
        q, v = np.zeros(plant.num_positions()), np.zeros(plant.num_velocities())
        base = plant.GetBodyByName("torso")
        at, rate = base.floating_positions_start(), base.floating_velocities_start_in_v()
        q[at : at + 7] = [*quaternion, *position]
        v[rate : rate + 6] = [*angular, *linear]
        for name, angle in joints.items():
            joint = plant.GetJointByName(name)
            q[joint.position_start()], v[joint.velocity_start()] = angle, rates[name]
        return q, v

    def velocities(self, q, v):
        self.plant.SetPositions(self.context, q)
        self.plant.SetVelocities(self.context, v)
        for side in ("right", "left"):
            body = self.plant.GetBodyByName(f"{side}_shank")
            motion = body.EvalSpatialVelocityInWorld(self.context)
            arm = body.EvalPoseInWorld(self.context).rotation().matrix() @ FOOT
            yield motion.translational() + np.cross(motion.rotational(), arm)


NAMES = ["right_hip", "right_knee", "left_hip", "left_knee"]


@pytest.fixture(scope="module")
def robot():
    return heelstrike.Robot.from_string(URDF)


@pytest.fixture(scope="module", params=[Pinocchio, MuJoCo, Drake], ids=lambda package: package.__name__)
def package(request):
    return request.param()


def planar(package, random, **change):
    """A random state in the plane, with the changes; and its x, z, pitch, joints and their rates."""
    pitch, turning = random.uniform(-1.5, 1.5), random.normal()
    angles, rates = random.uniform(-1.5, 1.5, 4), random.normal(size=4)
    x, z, along, up = random.normal(size=4)
    given = {
        "position": [x, 0.3, z],
        "quaternion": [np.cos(pitch / 2), 0.0, np.sin(pitch / 2), 0.0],
        "linear": np.array([along, 0.0, up]),
        "angular": np.array([0.0, turning, 0.0]),
        "joints": dict(zip(NAMES, angles)),
        "rates": dict(zip(NAMES, rates)),
    }
    own = np.array([x, z, pitch, *angles]), np.array([along, up, turning, *rates])
    return package.state(**{**given, **change}), own


def test_contact_velocities_are_those_of_the_package(package, robot):
    assert robot.coordinates == ["x", "z", "pitch", *NAMES]
    random = np.random.default_rng(3)
    states = [planar(package, random) for _ in range(50)]
    q, v = package.layout(robot, *(np.array(part) for part in zip(*(own for own, _ in states))))
    for row, ((own_q, own_v), (expected_q, expected_v)) in enumerate(states):
        np.testing.assert_allclose(q[row], expected_q, rtol=0, atol=1e-14)
        np.testing.assert_allclose(v[row], expected_v, rtol=0, atol=1e-14)
        parts = [
            {"base": dict(zip(("x", "z", "pitch"), numbers)), "joints": dict(zip(NAMES, numbers[3:]))}
            for numbers in (q[row], v[row])
        ]
        state = {"position": parts[0], "velocity": parts[1], "contacts": CONTACTS, "friction": 0.5}
        found = [contact["velocity_before"] for contact in robot.impact(state)["contacts"]]
        expected = [velocity[[0, 2]] for velocity in package.velocities(own_q, own_v)]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)
    answers = robot.impacts(q, v, friction=0.5, contacts=CONTACTS)
    assert len(answers) == 50 and (answers.verdict != heelstrike.Verdict.REFUSED).all()
    one, _ = package.layout(robot, *states[0][0])
    assert one.tolist() == q[:1].tolist()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"quaternion": [np.cos(0.05), np.sin(0.05), 0.0, 0.0]}, "turned out of the plane by 9.996e-02 rad in row 0"),
        ({"linear": np.array([0.0, 0.25, 0.0])}, "moves out of the plane by 2.500e-01 m/s"),
        ({"angular": np.array([0.0, 0.0, 0.5])}, "turns out of the plane by 5.000e-01 rad/s"),
        ({"joints": {"neck_roll": 0.1}, "rates": {"neck_roll": 0.0}}, "neck_roll.* is off by 1.000e-01"),
        ({"joints": {"neck_roll": 0.0}, "rates": {"neck_roll": 0.2}}, "neck_roll.* moves by 2.000e-01"),
    ],
)
def test_motion_out_of_the_plane_is_refused_with_its_size(package, robot, change, message):
    state, _ = planar(package, np.random.default_rng(4), **change)
    with pytest.raises(ValueError, match=message):
        package.layout(robot, *state)


def test_cosine_and_sine_of_no_angle_are_refused(robot):
    package = Pinocchio()
    (q, v), _ = planar(package, np.random.default_rng(4))
    knee = package.layout.joints["left_knee"].q
    q[knee : knee + 2] *= 2
    with pytest.raises(ValueError, match="the cosine and sine of a joint have the length 2"):
        package.layout(robot, q, v)


# The left knee mimics the right one: twice its angle plus 0.1 rad.
MIMIC = URDF.replace(
    '<joint name="left_knee" type="continuous">',
    '<joint name="left_knee" type="continuous"><mimic joint="right_knee" multiplier="2" offset="0.1"/>',
)


def test_joints_that_mimic_others_must_follow_them(package):
    robot = heelstrike.Robot.from_string(MIMIC)
    assert "left_knee" not in robot.coordinates

    def layout(off=0.0, rate_off=0.0):
        joints = dict(zip(NAMES, [0.2, 1.7, 0.1, 2 * 1.7 + 0.1 + off]))
        rates = dict(zip(NAMES, [0.2, -0.5, 0.1, 2 * -0.5 + rate_off]))
        state, _ = planar(package, np.random.default_rng(6), joints=joints, rates=rates)
        return package.layout(robot, *state)

    assert layout()[0].shape == (1, 6)
    with pytest.raises(ValueError, match="left_knee, which mimics right_knee .* is off by 2.000e-01 rad"):
        layout(off=0.2)
    with pytest.raises(ValueError, match="left_knee, which mimics right_knee .* off in its rate by 3.000e-01 rad/s"):
        layout(rate_off=0.3)


def test_joint_is_held_beyond_a_half_turn(package):
    robot = heelstrike.Robot.from_string(URDF, hold={"left_knee": 4.0})
    joints, rates = dict(zip(NAMES, [0.2, 1.7, 0.1, 4.0])), dict(zip(NAMES, [0.0, 1.0, 0.0, 0.0]))
    state, _ = planar(package, np.random.default_rng(6), joints=joints, rates=rates)
    assert package.layout(robot, *state)[0].shape == (1, 6)
    followed = heelstrike.Robot.from_string(MIMIC, hold={"right_knee": 0.3})
    assert followed.held == {"right_knee": 0.3, "left_knee": 0.7}


def test_row_that_is_not_finite_is_a_refused_row(package, robot):
    states = [planar(package, np.random.default_rng(8))[0] for _ in range(60)]
    clean, broken = (np.array(part) for part in zip(*states)), [np.array(part) for part in zip(*states)]
    for part in broken:
        for at in range(part.shape[1]):
            part[at + (20 if part is broken[1] else 0), at] = np.inf if at % 2 else np.nan
    answers = robot.impacts(*package.layout(robot, *broken), friction=0.5, contacts=CONTACTS)
    columns = [part.shape[1] for part in broken]
    assert set(np.flatnonzero(answers.verdict == heelstrike.Verdict.REFUSED)) == {
        *range(columns[0]), *range(20, 20 + columns[1])
    }
    assert robot.impacts(*package.layout(robot, *clean), friction=0.5).error == [None] * 60


def test_other_models_are_refused_by_name(package, robot):
    other = heelstrike.Robot.from_string(URDF.replace("left_knee", "left_kneee"))
    state, _ = planar(package, np.random.default_rng(5))
    with pytest.raises(ValueError, match="left_kneee"):
        package.layout(other, *state)
    with pytest.raises(ValueError, match="the model needs"):
        package.layout(robot, state[0][1:], state[1])


FLOATING = """<robot name="hopper"><link name="world"/>
  <joint name="free" type="floating"><parent link="world"/><child link="body"/><origin xyz="0.2 0 0.7"/></joint>
  <link name="body"><inertial><mass value="5"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link></robot>"""


def test_masked_numbers_become_nan():
    other = Pinocchio()
    robot = heelstrike.Robot.from_string(URDF)
    q, v = other.pin.neutral(other.model), np.zeros(other.model.nv)
    masked = np.ma.masked_array(np.stack([q, q]), mask=np.arange(2 * len(q)).reshape(2, -1) == 2)
    assert np.isnan(other.layout(robot, masked, np.stack([v, v]))[0]).all(axis=1).tolist() == [True, False]


def test_base_that_pinocchio_counts_from_elsewhere_is_refused():
    model = peer("pinocchio").buildModelFromXML(FLOATING)
    with pytest.raises(ValueError, match="the base's joint free is not placed at the world's origin"):
        heelstrike.from_pinocchio(model)


def test_motion_of_a_base_that_the_robot_has_fixed_is_refused():
    other = Pinocchio()
    fixed = heelstrike.Robot.from_string(URDF, base="fixed")
    q, v = other.pin.neutral(other.model), np.zeros(other.model.nv)
    assert other.layout(fixed, q, v)[0].shape == (1, 4)
    v[0] = 3
    with pytest.raises(ValueError, match="the base, which is fixed in the planar robot, moves by 3.000e\\+00 m/s"):
        other.layout(fixed, q, v)
    q[2], v[0] = 1, 0
    with pytest.raises(ValueError, match="the base, which is fixed in the planar robot, is off by 1"):
        other.layout(fixed, q, v)


def test_angles_of_mujoco_count_from_its_reference():
    mujoco = peer("mujoco")
    spec = mujoco.MjSpec.from_string(URDF)
    spec.compiler.fusestatic = False
    spec.body("torso").add_freejoint()
    spec.joint("left_hip").ref = 0.5
    model = spec.compile()
    robot = heelstrike.Robot.from_string(URDF)
    q, _ = heelstrike.from_mujoco(model)(robot, model.qpos0, np.zeros(model.nv))
    assert q[0, robot.coordinates.index("left_hip")] == 0


def test_joint_that_follows_a_frozen_one_is_where_its_law_puts_it():
    pin = peer("pinocchio")
    inertial = """<inertial><origin xyz="0 0 -0.2"/><mass value="1"/>
        <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial>"""
    limit = '<limit lower="-6" upper="6" effort="1" velocity="1"/>'
    text = f"""<robot name="b"><link name="body">{inertial}</link><link name="thigh">{inertial}</link>
      <link name="la">{inertial}</link><link name="lb">{inertial}</link>
      <joint name="hip" type="revolute">{limit}<parent link="body"/><child link="thigh"/><axis xyz="0 1 0"/></joint>
      <joint name="a" type="revolute">{limit}<origin xyz="0 0 -0.4"/><parent link="thigh"/><child link="la"/>
        <axis xyz="1 0 0"/></joint>
      <joint name="b" type="revolute">{limit}<mimic joint="a" multiplier="0.5" offset="0.3"/>
        <origin xyz="0 0 -0.4"/><parent link="la"/><child link="lb"/><axis xyz="0 1 0"/></joint></robot>"""
    robot = heelstrike.Robot.from_string(text)
    assert robot.held == {"b": 0.3}
    model = pin.buildModelFromXML(text, pin.JointModelFreeFlyer())
    q, data = pin.neutral(model), model.createData()
    q[model.idx_qs[model.getJointId("b")]] = 0.3
    heelstrike.from_pinocchio(model)(robot, q, np.zeros(model.nv))
    at = model.idx_vs[model.getJointId("hip")]
    result = robot.impact({"friction": 1, "position": {"base": {"z": 3}}}, matrices=True)
    assert result["mass_matrix"][3][3] == pytest.approx(pin.crba(model, data, q)[at, at], rel=1e-12)


@pytest.mark.parametrize("plane", ["xz", "yz", "xy", "zy", "zx", "yx"])
def test_base_is_read_in_every_plane(plane):
    layout = heelstrike.Layout(7, 6, base=Base(slice(0, 3), [3, 4, 5, 6], slice(0, 3), slice(3, 6), False, False))
    robot = heelstrike.Robot.from_string(FLOATING, plane=plane)
    forward, up = (np.eye(3)["xyz".index(axis)] for axis in plane)
    # The plane's normal as `heelstrike inspect` prints it.
    axis = {"xz": "+y", "yz": "-x", "xy": "-z", "zy": "+x", "zx": "-y", "yx": "+z"}[plane]
    normal = np.eye(3)["xyz".index(axis[1])] * float(axis[0] + "1")
    q, v = layout(
        robot,
        [*(0.4 * forward + 0.5 * up), np.cos(0.15), *(np.sin(0.15) * normal)],
        [*(0.6 * forward + 0.7 * up), *(0.8 * normal)],
    )
    np.testing.assert_allclose(q[0, :3], [0.4, 0.5, 0.3])
    np.testing.assert_allclose(v[0, :3], [0.6, 0.7, 0.8])


@pytest.mark.parametrize("side", ["parent", "child"])
def test_base_that_drake_counts_from_elsewhere_is_refused(side):
    plant = peer("pydrake.multibody.plant").MultibodyPlant(0.0)
    tree, math = peer("pydrake.multibody.tree"), peer("pydrake.math")
    peer("pydrake.multibody.parsing").Parser(plant).AddModelsFromString(URDF, "urdf")
    frames = [plant.world_frame(), plant.GetBodyByName("torso").body_frame()]
    at = ["parent", "child"].index(side)
    frames[at] = plant.AddFrame(tree.FixedOffsetFrame("off", frames[at], math.RigidTransform([0.2, 0, 0.7])))
    plant.AddJoint(tree.QuaternionFloatingJoint("free", *frames))
    plant.Finalize()
    with pytest.raises(ValueError, match="the base's joint free does not join the frames of the world and of its body"):
        heelstrike.from_drake(plant)
