//! Joins the values of the strict copy, read by urdf-rs, with the draft.

use super::draft::{self, Draft, Shape, Stated};
use super::{Collision, Description, Geometry, Inertial, Joint, Link, Mesh, Mimic, Pose};
use crate::error::{Reason, Result};

/// The description, its root still to be found.
pub(super) fn join(draft: Draft) -> Result<Description> {
    let unread = |message: String| Reason::Syntax(format!("urdf-rs could not read the checked values: {message}"));
    let (mut links, mut joints) = (Vec::new(), Vec::new());
    for part in &draft.strict {
        let part = urdf_rs::read_from_string(part).map_err(|error| unread(error.to_string()))?;
        links.extend(part.links);
        joints.extend(part.joints);
    }
    if links.len() != draft.links.len() || joints.len() != draft.joints.len() {
        return Err(unread("links or joints were lost".into()).into());
    }
    Ok(Description {
        name: draft.name,
        links: draft.links.into_iter().zip(&links).map(|(link, values)| join_link(link, values)).collect(),
        joints: draft.joints.into_iter().zip(&joints).map(|(joint, values)| join_joint(joint, values)).collect(),
        root: 0,
        ignored: draft.ignored,
    })
}

fn join_link(draft: draft::Link, values: &urdf_rs::Link) -> Link {
    let inertial = (draft.inertial != Stated::Nothing).then(|| {
        let urdf_rs::Inertia { ixx, ixy, ixz, iyy, iyz, izz } = values.inertial.inertia;
        Inertial {
            origin: pose(&values.inertial.origin),
            mass: values.inertial.mass.value,
            inertia: (draft.inertial == Stated::Everything).then_some([
                [ixx, ixy, ixz],
                [ixy, iyy, iyz],
                [ixz, iyz, izz],
            ]),
        }
    });
    let shapes = draft.shapes.into_iter().zip(&values.collision);
    let collisions = shapes
        .map(|(shape, values)| Collision { origin: pose(&values.origin), geometry: geometry(shape, &values.geometry) });
    Link { inertial, collisions: collisions.collect(), name: draft.name, joint: None, location: draft.location }
}

fn join_joint(draft: draft::Joint, values: &urdf_rs::Joint) -> Joint {
    let mimic = draft.mimic.zip(values.mimic.as_ref()).map(|(joint, values)| Mimic {
        joint,
        multiplier: values.multiplier.unwrap_or(1.0),
        offset: values.offset.unwrap_or(0.0),
    });
    Joint {
        name: draft.name,
        kind: draft.kind,
        parent: draft.parent,
        child: draft.child,
        origin: pose(&values.origin),
        axis: values.axis.xyz.0,
        mimic,
        location: draft.location,
    }
}

fn pose(values: &urdf_rs::Pose) -> Pose {
    Pose { xyz: values.xyz.0, rpy: values.rpy.0 }
}

fn geometry(shape: Shape, values: &urdf_rs::Geometry) -> Geometry {
    use urdf_rs::Geometry as Values;
    if let Shape::Unknown(tag) = shape {
        return Geometry::Unknown { tag };
    }
    match *values {
        Values::Box { size } => Geometry::Box { size: size.0 },
        Values::Cylinder { radius, length } => Geometry::Cylinder { radius, length },
        Values::Capsule { radius, length } => Geometry::Capsule { radius, length },
        Values::Sphere { radius } => Geometry::Sphere { radius },
        Values::Mesh { ref filename, scale } => Geometry::Mesh {
            file: if let Shape::Mesh(file) = shape { file } else { filename.clone() },
            scale: scale.map_or([1.0; 3], |scale| scale.0),
            mesh: Mesh::Unread,
        },
    }
}
