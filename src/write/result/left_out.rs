//! Describes what does not enter the analysis of a state.

use crate::contact::Merged;
use crate::pipeline::{Impact, LeftOut};
use crate::write::words::counted;
use crate::{Robot, description};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A part of the robot's file or of the scene that does not enter the analysis.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "LeftOut")]
pub struct LeftOutRecord<'a> {
    /// The part, as in `joint "left_ankle"`.
    pub what: Cow<'a, str>,
    /// The reason, as in `fixed: welded into left_shank`.
    pub why: Cow<'a, str>,
}

impl<'a> LeftOutRecord<'a> {
    /// Returns what the analysis of an impact leaves out: parts of `robot`, and what no impact depends on.
    pub fn all(robot: &'a Robot) -> Vec<Self> {
        Self::of_robot(robot, "gravity, Coriolis forces, joint limits", "do not enter an impact").collect()
    }

    fn of_robot(robot: &'a Robot, never: &'static str, why: &'static str) -> impl Iterator<Item = Self> {
        let parts = robot.left_out.iter().map(|left| (&*left.what, &*left.why));
        parts.chain([(never, why)]).map(|(what, why)| Self { what: what.into(), why: why.into() })
    }

    /// Returns what the analysis of `impact` leaves out: first parts of the scene, then those of its `robot`.
    pub fn of_impact(robot: &'a Robot, impact: &Impact) -> Vec<Self> {
        let contacts = |of: &[usize]| {
            of.iter().filter_map(|&at| Some(&*impact.contacts.get(at)?.name)).collect::<Vec<_>>().join(", ")
        };
        let of_scene = impact.left_out.iter().filter_map(|left| {
            let (what, why) = match left {
                LeftOut::Column(joint) => (
                    description::joint_place(&robot.joints.get(*joint)?.name),
                    "braked: it keeps its rate and has no column".into(),
                ),
                LeftOut::OutOfReach(count) => {
                    (counted(*count, "shape") + " out of reach", "too high to reach the ground".into())
                }
                LeftOut::NotAsked(count) => {
                    (counted(*count, "shape") + " of the file", "contacts are named by hand".into())
                }
                LeftOut::Merged(Merged { inner, outer, off, .. }) => {
                    let points = counted(*inner, "contact point");
                    let off = if *off > 0.0 { format!(", at most {off:.1e} m off their line") } else { String::new() };
                    let why = format!("the outer points of the same body on straight ground act for them{off}");
                    (format!("{points} next to {}", contacts(outer)), why.into())
                }
                LeftOut::Tangential(of) => (format!("tangential impulse of {}", contacts(of)), "friction 0".into()),
                LeftOut::Cone(of) => (format!("friction cone of {}", contacts(of)), "infinite friction".into()),
            };
            Some(Self { what: Cow::Owned(what), why })
        });
        match impact.sustained {
            None => of_scene.chain(Self::all(robot)).collect(),
            Some(_) => of_scene.chain(Self::of_robot(robot, "joint limits", "do not enter the forces")).collect(),
        }
    }
}
