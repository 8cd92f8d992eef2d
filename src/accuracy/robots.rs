//! The robots of the suite, read from this repository's URDFs or built link by link.

use crate::Result;
use crate::planar::Vector;
use crate::robot::{Axis, Base, Body, FootShape, Joint, Link, ParentJoint, Robot};

/// The paper's minimalistic biped: two point masses on hinged legs.
pub fn minimalistic() -> Result<Robot> {
    Robot::from_urdf(include_str!("../../urdf/minimalistic.urdf"))
}

/// The paper's RAMone, as in its Table 1.
pub fn ramone() -> Result<Robot> {
    Robot::from_urdf(include_str!("../../urdf/ramone.urdf"))
}

/// The paper's single body.
pub fn block() -> Result<Robot> {
    Robot::from_urdf(include_str!("../../urdf/block.urdf"))
}

/// The passive dynamic walker with legs of the given moment of inertia \[kg m^2\].
pub fn walker(moment: f64) -> Result<Robot> {
    Ok(with_bodies(Robot::from_urdf(include_str!("../../urdf/pdw.urdf"))?, |body| body.moment = moment))
}

/// The minimalistic biped with massless feet, each hinged to the end of its leg.
pub fn with_massless_feet() -> Result<Robot> {
    let mut robot = minimalistic()?;
    for leg in 0..2 {
        robot.links[leg].shapes.clear();
        let name = format!("{} foot", robot.links[leg].name);
        let (joint, body) = (robot.joints.len(), robot.bodies.len());
        robot.joints.push(hinge(format!("{name} ankle"), robot.links[leg].body, body, Vector::new(0.0, -1.0)));
        let joint = Some(ParentJoint::Joint(joint));
        robot.bodies.push(Body { name: name.clone(), joint, mass: 0.0, com: Vector::zero(), moment: 0.0 });
        robot.links.push(point_foot(name, body, Vector::new(0.05, -0.05)));
    }
    Ok(robot)
}

/// A chain of hinged rods of 1 m and 1 kg; its two free ends can touch the ground.
pub fn chain(links: usize) -> Robot {
    let rod = |index: usize| Body {
        name: format!("rod {index}"),
        joint: index.checked_sub(1).map(ParentJoint::Joint),
        mass: 1.0,
        com: Vector::new(0.0, -0.5),
        moment: 1.0 / 12.0,
    };
    let tip = links - 1;
    Robot {
        name: format!("chain of {links}"),
        base: Base::Floating,
        bodies: (0..links).map(rod).collect(),
        joints: (0..tip)
            .map(|index| hinge(format!("joint {index}"), index, index + 1, Vector::new(0.0, -1.0)))
            .collect(),
        links: vec![
            point_foot("near end".into(), 0, Vector::zero()),
            point_foot("far end".into(), tip, Vector::new(0.0, -1.0)),
        ],
        mimic_joints: Vec::new(),
        left_out: Vec::new(),
        reading: Default::default(),
    }
}

/// Returns `robot` with all masses multiplied by `mass` and all lengths by `length`.
pub fn resized(mut robot: Robot, mass: f64, length: f64) -> Robot {
    for body in &mut robot.bodies {
        body.mass *= mass;
        body.com = body.com * length;
        body.moment *= mass * length * length;
    }
    for joint in robot.joints.iter_mut().chain(robot.mimic_joints.iter_mut().map(|mimic| &mut mimic.joint)) {
        joint.origin = joint.origin * length;
    }
    for link in &mut robot.links {
        for row in &mut link.pose {
            row[3] *= length;
        }
        for shape in &mut link.shapes {
            if let Some(resized) = shape.resized(length) {
                *shape = resized;
            }
        }
    }
    robot
}

/// Returns `robot` with `change` applied to every body.
pub fn with_bodies(mut robot: Robot, change: impl FnMut(&mut Body)) -> Robot {
    robot.bodies.iter_mut().for_each(change);
    robot
}

fn hinge(name: String, parent: usize, child: usize, origin: Vector<f64>) -> Joint {
    Joint { name, parent, child, origin, axis: Axis::Revolute { sign: -1.0 }, limits: None }
}

/// A link with the frame of its body, which can touch the ground at one point.
fn point_foot(name: String, body: usize, center: Vector<f64>) -> Link {
    let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    Link { name, body, pose, shapes: vec![FootShape::disc(center, 0.0)], has_inertial: true, line: None }
}
