//! A still as its data: poses, contacts and outcomes, and the scale on which all stills are drawn.

use super::Still;
use super::number::{place, significant, unit, vector};
use super::part::Parts;
use super::texts::Texts;
use crate::Error;
use crate::draw::keyframe::{Answer, Pose};
use crate::draw::robot::{Arrow, Drawing, Extent, Touch};
use crate::impact::{self, Verdict};
use crate::planar::{Pair, Vector};
use crate::write::words;
use serde::Serialize;

/// A still. Texts are given by their numbers.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Frame {
    #[serde(skip_serializing_if = "Option::is_none")]
    region: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<Verdict>,
    #[serde(skip_serializing_if = "Option::is_none")]
    proven: Option<bool>,
    /// The verdict as a sentence, or why there is none.
    sentence: usize,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pose: Option<Placed>,
    outcomes: Vec<Effect>,
}

/// A robot where it is.
#[derive(Debug, Clone, Serialize)]
struct Placed {
    /// Of each body its part, and its frame's origin and x axis in the world.
    bodies: Vec<(usize, f64, f64, f64, f64)>,
    /// From where to where.
    bones: Vec<[f64; 4]>,
    joints: Vec<Vector<f64>>,
    ground: Vec<Vector<f64>>,
    contacts: Vec<Contact>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    applied: Vec<Arrow>,
    /// The middle of all that is drawn.
    middle: Vector<f64>,
}

#[derive(Debug, Clone, Serialize)]
struct Contact {
    name: usize,
    point: Vector<f64>,
    normal: Vector<f64>,
    /// In the world's axes \[m/s\].
    before: Vector<f64>,
}

#[derive(Debug, Clone, Serialize)]
struct Effect {
    /// What each contact does, in words.
    words: usize,
    /// What else is to be said of it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    marks: Vec<usize>,
    margin: Option<f64>,
    index: Option<i8>,
    energy_loss: f64,
    /// Tangential and normal.
    impulse: Vec<Pair<f64>>,
    after: Vec<Pair<f64>>,
}

/// How large stills are drawn, all alike.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Scale {
    /// What places are told to \[m\].
    #[serde(skip)]
    pub unit: f64,
    /// The lower left corner of what is in view, from the middle of the robot along an axis on which the view follows it \[m\].
    low: Vector<f64>,
    /// The upper right one \[m\].
    high: Vector<f64>,
    /// Along which axes the view follows the robot.
    follows: [bool; 2],
    /// The mass of the heaviest body \[kg\].
    mass: f64,
    /// An impulse that is drawn as long as an arrow should be \[N s\].
    impulse: f64,
    /// A velocity that is \[m/s\].
    velocity: f64,
}

/// Of the largest robot: where all stills are within less, the view stays where it is.
const FIXED: f64 = 1.5;
/// So many of a hundred stills have no longer arrow than one should be.
const USUAL: usize = 90;

impl Scale {
    /// That of these stills.
    pub fn of(stills: &[Still]) -> Self {
        let drawings: Vec<&Drawing> =
            stills.iter().filter_map(|still| still.keyframe.pose.as_ref()).map(|pose| &pose.drawing).collect();
        let extents = || drawings.iter().map(|drawing| drawing.extent());
        let size = extents().map(|extent| extent.size()).fold(0.0, f64::max);
        let whole = Extent::of(extents().flat_map(|extent| [extent.low, extent.high]));
        let spans = extents().map(|extent| extent.high - extent.low);
        let widest = spans.fold(Vector::zero(), Vector::greatest);
        let follows = (whole.high - whole.low).components().map(|span| span > FIXED * size);
        let side = |way: f64, whole: Vector<f64>| {
            Vector::new(
                if follows[0] { 0.5 * way * widest.x } else { whole.x },
                if follows[1] { 0.5 * way * widest.z } else { whole.z },
            )
        };
        let masses = drawings.iter().flat_map(|drawing| &drawing.bodies).map(|body| body.mass);
        let impulses = drawings.iter().map(|drawing| {
            let applied = drawing.applied.iter().map(|arrow| arrow.vector);
            longest(drawing.outcomes.iter().flat_map(|outcome| outcome.impulse.iter().copied()).chain(applied))
        });
        let velocities = drawings.iter().map(|drawing| {
            let before = drawing.contacts.iter().map(|contact| contact.velocity_before);
            longest(drawing.outcomes.iter().flat_map(|outcome| outcome.velocity_after.iter().copied()).chain(before))
        });
        let unit = unit(size);
        Self {
            unit,
            low: place(side(-1.0, whole.low), unit),
            high: place(side(1.0, whole.high), unit),
            follows,
            mass: significant(masses.fold(0.0, f64::max), 5),
            impulse: significant(usual(impulses.collect()), 5),
            velocity: significant(usual(velocities.collect()), 5),
        }
    }
}

fn longest(vectors: impl Iterator<Item = Vector<f64>>) -> f64 {
    vectors.map(Vector::length).fold(0.0, f64::max)
}

/// What most of these do not exceed, of those that are anything at all.
fn usual(mut lengths: Vec<f64>) -> f64 {
    lengths.retain(|length| *length > 0.0);
    lengths.sort_unstable_by(f64::total_cmp);
    lengths.get((lengths.len() * USUAL / 100).min(lengths.len().saturating_sub(1))).copied().unwrap_or(0.0)
}

impl Frame {
    /// A still; its places are multiples of `unit` \[m\].
    pub fn new(still: &Still, unit: f64, parts: &mut Parts, texts: &mut Texts) -> Self {
        let Still { keyframe, region, name } = still;
        let answer = keyframe.answer.as_ref();
        let (verdict, proven) = (answer.ok().map(|answer| answer.verdict), answer.ok().map(|answer| answer.proven));
        let sentence = match answer {
            Ok(answer) => words::verdict(answer.verdict, answer.outcomes.len()),
            Err(error) => refusal(error),
        };
        let contacts = keyframe.pose.as_ref().map_or(&[][..], |pose| &pose.drawing.contacts);
        Self {
            region: *region,
            name: name.clone(),
            verdict,
            proven,
            sentence: texts.number(sentence),
            notes: keyframe.notes.iter().map(|note| texts.number(note.clone())).collect(),
            outcomes: answer.map_or_else(|_| Vec::new(), |answer| effects(answer, contacts, texts)),
            pose: keyframe.pose.as_ref().map(|pose| Placed::new(pose, unit, parts, texts)),
        }
    }
}

/// Why a state is refused, where and what to do.
fn refusal(error: &Error) -> String {
    let place = error.place().map(|place| format!("{place}: ")).unwrap_or_default();
    let remedy = error.remedy().map(|remedy| format!(" (hint: {remedy})")).unwrap_or_default();
    format!("Refused: {place}{}{remedy}", error.reason())
}

fn effects(answer: &Answer, contacts: &[Touch], texts: &mut Texts) -> Vec<Effect> {
    let names = || contacts.iter().map(|contact| contact.name.as_str());
    let pair = |pair: &Pair<f64>| pair.map(|entry| significant(entry, 5));
    let effect = |outcome: &impact::Outcome| Effect {
        words: texts.number(match outcome.modes[..] {
            [] => "nothing changes".to_owned(),
            _ => words::modes(names(), &outcome.modes),
        }),
        marks: marks(outcome).into_iter().map(|mark| texts.number(mark)).collect(),
        margin: outcome.margin.map(|margin| significant(margin, 5)),
        index: outcome.index,
        energy_loss: significant(outcome.energy_loss, 5),
        impulse: outcome.impulse.iter().map(pair).collect(),
        after: outcome.velocity_after.iter().map(pair).collect(),
    };
    answer.outcomes.iter().map(effect).collect()
}

fn marks(outcome: &impact::Outcome) -> Vec<String> {
    let border = outcome.border.as_ref().map(|border| {
        let zeros: Vec<String> = border.at_zero.iter().map(|(_, zero)| zero.to_string()).collect();
        format!("on a border: {}", zeros.join(", "))
    });
    let marks = [
        (outcome.family, "the end of a family"),
        (!outcome.impulse_unique, "one of many impulses"),
        (!outcome.decided, "not excluded"),
        (outcome.decided && !outcome.proven, "not proven"),
    ];
    border.into_iter().chain(marks.into_iter().filter(|mark| mark.0).map(|mark| mark.1.to_owned())).collect()
}

impl Placed {
    fn new(Pose { drawing, turns }: &Pose, unit: f64, parts: &mut Parts, texts: &mut Texts) -> Self {
        let at = |point: &Vector<f64>| place(*point, unit);
        let placed = |(number, (body, turn)): (usize, (&_, &Vector<f64>))| {
            let part = parts.number(number, body, *turn, unit);
            let (Vector { x, z }, Vector { x: cos, z: sin }) = (at(&body.origin), vector(turn));
            (part, x, z, cos, sin)
        };
        let bones = drawing.bodies.iter().flat_map(|body| body.bones.iter().map(|end| [at(&body.origin), at(end)]));
        let extent = drawing.extent();
        Self {
            bodies: drawing.bodies.iter().zip(turns).enumerate().map(placed).collect(),
            bones: bones.map(|[Vector { x, z }, Vector { x: to_x, z: to_z }]| [x, z, to_x, to_z]).collect(),
            joints: drawing.joints.iter().map(at).collect(),
            ground: drawing.ground.iter().map(at).collect(),
            contacts: drawing
                .contacts
                .iter()
                .map(|contact| Contact {
                    name: texts.number(contact.name.clone()),
                    point: at(&contact.point),
                    normal: vector(&contact.normal),
                    before: vector(&contact.velocity_before),
                })
                .collect(),
            applied: drawing
                .applied
                .iter()
                .map(|arrow| Arrow { point: at(&arrow.point), vector: vector(&arrow.vector) })
                .collect(),
            middle: at(&((extent.low + extent.high) * 0.5)),
        }
    }
}
