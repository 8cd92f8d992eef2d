"""Writes a URDF of an SDF or MJCF model, as Drake reads it: ``python -m heelstrike.to_urdf MODEL ROBOT.urdf``.

Needs ``pip install drake``. Masses, inertias, joints and collision shapes are kept to the last digit; a capsule becomes a
cylinder and two spheres. What a URDF cannot express is refused by name.
"""

from __future__ import annotations

import importlib
import sys
from typing import Any
from xml.etree import ElementTree as ET


def _drake(name: str) -> Any:
    try:
        return importlib.import_module(f"pydrake.{name}")
    except ImportError as error:
        raise SystemExit("error: Drake is missing: pip install drake") from error


def _numbers(values: Any) -> str:
    return " ".join(repr(float(value)) for value in values)


def _origin(parent: ET.Element, pose: Any) -> None:
    angles = _drake("math").RollPitchYaw(pose.rotation()).vector()
    ET.SubElement(parent, "origin", xyz=_numbers(pose.translation()), rpy=_numbers(angles))


def _shapes(shape: Any, pose: Any) -> list[tuple[str, dict[str, str], Any]]:
    """The URDF elements of a Drake shape, each with sizes and pose."""
    geometry, pose_of = _drake("geometry"), _drake("math").RigidTransform
    if isinstance(shape, geometry.Sphere):
        return [("sphere", {"radius": repr(shape.radius())}, pose)]
    if isinstance(shape, geometry.Box):
        return [("box", {"size": _numbers(shape.size())}, pose)]
    if isinstance(shape, (geometry.Cylinder, geometry.Capsule)):
        radius, length = repr(shape.radius()), repr(shape.length())
        parts = [("cylinder", {"radius": radius, "length": length}, pose)]
        if isinstance(shape, geometry.Capsule):
            ends = (pose @ pose_of([0, 0, side * shape.length() / 2]) for side in (-1, 1))
            parts += [("sphere", {"radius": radius}, end) for end in ends]
        return parts
    if isinstance(shape, (geometry.Mesh, geometry.Convex)):
        scale = getattr(shape, "scale3", lambda: [shape.scale()] * 3)()
        return [("mesh", {"filename": str(shape.source().path()), "scale": _numbers(scale)}, pose)]
    if isinstance(shape, geometry.HalfSpace):
        return []
    raise SystemExit(f"error: a URDF has no {type(shape).__name__}")


def convert(path: str) -> str:
    """The model of a file as URDF."""
    tree, pose_of = _drake("multibody.tree"), _drake("math").RigidTransform
    builder = _drake("systems.framework").DiagramBuilder()
    plant, scene = _drake("multibody.plant").AddMultibodyPlantSceneGraph(builder, 0.0)
    models = _drake("multibody.parsing").Parser(plant).AddModels(path)
    plant.Finalize()
    robot = ET.Element("robot", name=plant.GetModelInstanceName(models[0]))
    joints = [plant.get_joint(index) for index in plant.GetJointIndices(models[0])]
    # A URDF link has its frame at its joint: the pose of each body in that frame.
    poses = {joint.child_body().name(): joint.frame_on_child().GetFixedPoseInBodyFrame().inverse() for joint in joints}
    for index in plant.GetBodyIndices(models[0]):
        body = plant.get_body(index)
        link = ET.SubElement(robot, "link", name=body.name())
        own_pose = poses.get(body.name(), pose_of())
        inertia = body.CalcSpatialInertiaInBodyFrame(plant.CreateDefaultContext())
        if inertia.get_mass() > 0:
            own = ET.SubElement(link, "inertial")
            center = inertia.get_com()
            _origin(own, own_pose @ pose_of(center))
            ET.SubElement(own, "mass", value=repr(inertia.get_mass()))
            moments = inertia.Shift(center).CalcRotationalInertia().CopyToFullMatrix3()
            entries = {f"i{'xyz'[i]}{'xyz'[j]}": repr(float(moments[i, j])) for i in range(3) for j in range(i, 3)}
            ET.SubElement(own, "inertia", entries)
        for shape in plant.GetCollisionGeometriesForBody(body):
            inspector = scene.model_inspector()
            for form, sizes, pose in _shapes(inspector.GetShape(shape), own_pose @ inspector.GetPoseInFrame(shape)):
                collision = ET.SubElement(link, "collision")
                _origin(collision, pose)
                ET.SubElement(ET.SubElement(collision, "geometry"), form, sizes)
    kinds = {tree.RevoluteJoint: "revolute", tree.PrismaticJoint: "prismatic", tree.WeldJoint: "fixed"}
    world = plant.world_body()
    for joint in joints:
        if isinstance(joint, tree.QuaternionFloatingJoint):
            continue
        kind = kinds.get(type(joint), "")
        if not kind:
            raise SystemExit(f'error: joint "{joint.name()}" is a {type(joint).__name__}, which a URDF does not have')
        if joint.parent_body() is world and robot.find("link[@name='world']") is None:
            ET.SubElement(robot, "link", name="world")
        element = ET.SubElement(robot, "joint", name=joint.name(), type=kind)
        parent = poses.get(joint.parent_body().name(), pose_of())
        _origin(element, parent @ joint.frame_on_parent().GetFixedPoseInBodyFrame())
        ET.SubElement(element, "parent", link=joint.parent_body().name())
        ET.SubElement(element, "child", link=joint.child_body().name())
        if kind != "fixed":
            axis = joint.revolute_axis() if kind == "revolute" else joint.translation_axis()
            ET.SubElement(element, "axis", xyz=_numbers(axis))
            [lower], [upper] = joint.position_lower_limits(), joint.position_upper_limits()
            # `float`, because the repr of NumPy's numbers names their type.
            lower, upper = repr(float(max(lower, -1e9))), repr(float(min(upper, 1e9)))
            ET.SubElement(element, "limit", lower=lower, upper=upper, effort="0", velocity="0")
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode") + "\n"


def _main() -> None:
    if len(sys.argv) != 3:
        raise SystemExit("usage: python -m heelstrike.to_urdf MODEL.sdf|MODEL.xml ROBOT.urdf")
    text = convert(sys.argv[1])
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    _main()
