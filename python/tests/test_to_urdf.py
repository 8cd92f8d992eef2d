"""Models of Drake as URDF: the same mass matrix, and a contact at the same place."""

import warnings

import numpy as np
import pytest
from conftest import peer

import heelstrike

MJCF = """<mujoco model="hopper"><compiler angle="radian"/><worldbody>
  <body name="torso" pos="0 0 1.25">
    <joint name="rootx" type="slide" axis="1 0 0" pos="0 0 -1.25"/><joint name="rootz" type="slide" axis="0 0 1"/>
    <joint name="rooty" type="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0.2 0 0 -0.2" size="0.05"/>
    <body name="thigh" pos="0 0 -0.2"><joint name="hip" type="hinge" axis="0 -1 0" pos="0.02 0 0.01"/>
      <inertial mass="2" pos="0.01 0 -0.2" fullinertia="0.03 0.035 0.02 0.001 0.002 0.003"/>
      <geom type="sphere" size="0.04" pos="0.1 0 -0.4"/></body>
  </body></worldbody></mujoco>"""

SDF = """<sdf version="1.7"><model name="hopper">
  <link name="torso"><inertial><mass>3</mass>
    <inertia><ixx>.1</ixx><iyy>.2</iyy><izz>.15</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link>
  <link name="leg"><pose>0.1 0 -0.3 0 0.2 0</pose><inertial><pose>0 0 -.1 0 .3 0</pose><mass>1</mass>
    <inertia><ixx>.02</ixx><iyy>.03</iyy><izz>.02</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>
    <collision name="foot"><pose>0 0 -.3 0 0 0</pose><geometry><sphere><radius>.05</radius></sphere></geometry></collision>
  </link>
  <joint name="hip" type="revolute"><parent>torso</parent><child>leg</child><pose>0 0 .1 0 0 0</pose>
    <axis><xyz>0 1 0</xyz><limit><lower>-2</lower><upper>2</upper></limit></axis></joint>
</model></sdf>"""


@pytest.mark.parametrize("name, text, base", [("m.xml", MJCF, "rootx rootz rooty"), ("m.sdf", SDF, None)])
def test_mass_matrix_is_that_of_drake(tmp_path, name, text, base):
    peer("pydrake")
    from pydrake.math import RigidTransform, RollPitchYaw
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    from heelstrike.to_urdf import convert

    (tmp_path / name).write_text(text)
    with warnings.catch_warnings():
        # A converted robot causes no cautions.
        warnings.simplefilter("error", UserWarning)
        robot = heelstrike.Robot.from_string(convert(str(tmp_path / name)))
    assert robot.coordinates == ["x", "z", "pitch", "hip"]
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(tmp_path / name))
    plant.Finalize()
    context = plant.CreateDefaultContext()
    pitch, hip = 0.3, 0.4
    if base:
        for joint, angle in zip([*base.split(), "hip"], [0.0, 0.0, pitch, hip]):
            joint = plant.GetJointByName(joint)
            (joint.set_angle if joint.name() in ("rooty", "hip") else joint.set_translation)(context, angle)
        places = [plant.GetJointByName(joint).velocity_start() for joint in [*base.split(), "hip"]]
    else:
        body = plant.GetBodyByName("torso")
        plant.SetFreeBodyPose(context, body, RigidTransform(RollPitchYaw(0, pitch, 0), [0, 0, 0]))
        plant.GetJointByName("hip").set_angle(context, hip)
        start = body.floating_velocities_start_in_v()
        # Drake's base velocities are angular first, then linear: vx, vz and the rate about y.
        places = [start + 3, start + 5, start + 1, plant.GetJointByName("hip").velocity_start()]
    expected = plant.CalcMassMatrix(context)[np.ix_(places, places)]
    state = {"friction": 0.5, "place": "lowest", "position": {"base": {"pitch": pitch}, "joints": {"hip": hip}}}
    result = robot.impact(state, matrices=True)
    np.testing.assert_allclose(result["mass_matrix"], expected, rtol=1e-12, atol=1e-12)
    assert result["contacts"]


def test_joints_without_a_name_in_urdf_are_refused(tmp_path):
    peer("pydrake")
    from heelstrike.to_urdf import convert

    ball = SDF.replace('type="revolute"', 'type="ball"')
    (tmp_path / "ball.sdf").write_text(ball)
    with pytest.raises(SystemExit, match='joint "hip" is a BallRpyJoint, which a URDF does not have'):
        convert(str(tmp_path / "ball.sdf"))
