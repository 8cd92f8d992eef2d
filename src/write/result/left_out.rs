//! What does not enter the analysis of a state, in words.

use crate::contact::Merged;
use crate::pipeline::{Impact, LeftOut};
use crate::{Robot, description};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Something of the robot's file or of the scene that does not enter the analysis.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "LeftOut")]
pub struct LeftOutRecord<'a> {
    /// What, as in `joint "left_ankle"`.
    pub what: Cow<'a, str>,
    /// Why, as in `fixed: welded into left_shank`.
    pub why: Cow<'a, str>,
}

impl<'a> LeftOutRecord<'a> {
    /// Returns what the analysis of an impact leaves out: parts of `robot`, and what no impact depends on.
    pub fn all(robot: &'a Robot) -> Vec<Self> {
        Self::of_robot(robot, ("gravity, Coriolis forces, joint limits", "do not enter an impact"))
    }

    fn of_robot(robot: &'a Robot, (what, why): (&'static str, &'static str)) -> Vec<Self> {
        let never = Self { what: Cow::Borrowed(what), why: Cow::Borrowed(why) };
        let of_robot =
            robot.left_out.iter().map(|left| Self { what: Cow::Borrowed(&left.what), why: Cow::Borrowed(&left.why) });
        of_robot.chain([never]).collect()
    }

    /// Returns what the analysis of `impact` leaves out: first parts of the scene, then those of its `robot`.
    pub fn of_impact(robot: &'a Robot, impact: &Impact) -> Vec<Self> {
        let contacts = |of: &[usize]| of.iter().map(|&at| &*impact.contacts[at].name).collect::<Vec<_>>().join(", ");
        let shapes = |count: usize| if count == 1 { "1 shape".to_owned() } else { format!("{count} shapes") };
        let of_scene = impact.left_out.iter().map(|left| {
            let (what, why) = match left {
                LeftOut::Column(joint) => (
                    description::joint_place(&robot.joints[*joint].name),
                    "braked: it keeps its rate and has no column".into(),
                ),
                LeftOut::OutOfReach(count) => {
                    (format!("{} out of reach", shapes(*count)), "too high to reach the ground".into())
                }
                LeftOut::NotAsked(count) => {
                    (format!("{} of the file", shapes(*count)), "contacts are named by hand".into())
                }
                LeftOut::Merged(Merged { inner, outer, off, .. }) => {
                    let points =
                        if *inner == 1 { "1 contact point".to_owned() } else { format!("{inner} contact points") };
                    let off = if *off > 0.0 { format!(", at most {off:.1e} m off their line") } else { String::new() };
                    let why = format!("the outer points of the same body on straight ground act for them{off}");
                    (format!("{points} next to {}", contacts(outer)), why.into())
                }
                LeftOut::Tangential(of) => (format!("tangential impulse of {}", contacts(of)), "friction 0".into()),
                LeftOut::Cone(of) => (format!("friction cone of {}", contacts(of)), "infinite friction".into()),
            };
            Self { what: Cow::Owned(what), why }
        });
        let of_robot = match impact.sustained {
            None => Self::all(robot),
            Some(_) => Self::of_robot(robot, ("joint limits", "do not enter the forces")),
        };
        of_scene.chain(of_robot).collect()
    }
}
