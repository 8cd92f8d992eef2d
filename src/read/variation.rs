//! Reads the numbers of a robot that a study varies.

use crate::description::{Collision, Description, Geometry};
use crate::read::json::Node;
use crate::{Error, Reason, Result};

/// Returns `description` with these numbers replaced: `{"links": {name: {"mass", "com", "inertia", "radius"}},
/// "joints": {name: {"origin"}}}`. They are mass \[kg\], CoG in the link's frame \[m\], moment of inertia about every
/// axis through the CoG \[kg m^2\], radius of the link's round collision shapes \[m\], joint's origin in its parent's
/// frame \[m\].
pub fn applied(field: Node, description: &Description) -> Result<Description> {
    let mut varied = description.clone();
    let [links, joints] = field.object("Variation", ["links", "joints"])?;
    if let Some(links) = links {
        links.fields("link")?.try_for_each(|entry| link(entry, &mut varied))?;
    }
    if let Some(joints) = joints {
        joints.fields("joint")?.try_for_each(|entry| joint(entry, &mut varied))?;
    }
    Ok(varied)
}

fn link(entry: Node, varied: &mut Description) -> Result<()> {
    let Some(at) = varied.links.iter().position(|link| link.name == entry.key()) else {
        return Err(unknown(entry, "link", varied.links.iter().map(|link| link.name.as_str())));
    };
    let link = &mut varied.links[at];
    for part in entry.fields("field")? {
        match part.key() {
            "mass" => link.inertial.get_or_insert_default().mass = part.number_from_zero("mass")?,
            "com" => link.inertial.get_or_insert_default().origin.xyz = part.numbers("a list of 3 numbers")?,
            "inertia" => {
                let moment = part.number_from_zero("the moment of inertia")?;
                let inertia = [[moment, 0.0, 0.0], [0.0, moment, 0.0], [0.0, 0.0, moment]];
                link.inertial.get_or_insert_default().inertia = Some(inertia);
            }
            "radius" => radius(part, &mut link.collisions)?,
            _ => return Err(part.unknown_field("LinkVariation")),
        }
    }
    Ok(())
}

fn radius(part: Node, collisions: &mut [Collision]) -> Result<()> {
    let value = part.number_from_zero("radius")?;
    let mut any = false;
    for collision in collisions {
        match &mut collision.geometry {
            Geometry::Sphere { radius } | Geometry::Cylinder { radius, .. } | Geometry::Capsule { radius, .. } => {
                (*radius, any) = (value, true);
            }
            Geometry::Box { .. } | Geometry::Mesh { .. } | Geometry::Unknown { .. } => {}
        }
    }
    if any {
        return Ok(());
    }
    let refused = part.refuse(Reason::Inconsistent("the link has no round collision shape".into()));
    Err(refused.hint("a radius belongs to spheres, cylinders and capsules; name the link that carries the foot"))
}

fn joint(entry: Node, varied: &mut Description) -> Result<()> {
    let Some(at) = varied.joint(entry.key()) else {
        return Err(unknown(entry, "joint", varied.joints.iter().map(|joint| joint.name.as_str())));
    };
    if let [Some(origin)] = entry.object("JointVariation", ["origin"])? {
        varied.joints[at].origin.xyz = origin.numbers("a list of 3 numbers")?;
    }
    Ok(())
}

fn unknown<'a>(entry: Node, what: &'static str, known: impl Iterator<Item = &'a str>) -> Error {
    let name = entry.key();
    entry.refuse_name(name, Reason::UnknownName { what, name: name.to_owned() }).did_you_mean(name, known)
}
