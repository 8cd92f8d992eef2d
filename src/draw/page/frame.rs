//! The data of a page: bodies, contacts and outcomes of its states, and the scale of all drawings.

use super::{Interned, PageState};
use crate::draw::KeyframeAnswer;
use crate::draw::plot::significant;
use crate::draw::robot::{Arrow, Drawing, DrawnBody, DrawnContact, DrawnShape, Extent, picture};
use crate::planar::{Pair, Vector};
use crate::write::words::Wording;
use crate::{Error, Outcome, Verdict};
use serde::Serialize;

/// A state. Texts and body parts are indices into the page's lists.
#[derive(Debug, Clone, Serialize)]
pub(super) struct PageFrame {
    #[serde(skip_serializing_if = "Option::is_none")]
    region: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<Verdict>,
    #[serde(skip_serializing_if = "Option::is_none")]
    proven: Option<bool>,
    /// The verdict as a sentence, or the reason why there is none.
    sentence: usize,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pose: Option<PageDrawing>,
    outcomes: Vec<PageOutcome>,
}

#[derive(Debug, Clone, Serialize)]
struct PageDrawing {
    /// For each body, the index of its part, and the origin (x, z) and x axis (x, z) of its frame in the world frame.
    bodies: Vec<(usize, f64, f64, f64, f64)>,
    /// For each bone, its start (x, z), its end (x, z) and the index of its body.
    bones: Vec<(f64, f64, f64, f64, usize)>,
    joints: Vec<Vector<f64>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    loops: Vec<Vector<f64>>,
    ground: Vec<Vector<f64>>,
    #[serde(rename = "profile", skip_serializing_if = "std::ops::Not::not")]
    is_profile: bool,
    contacts: Vec<PageContact>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    applied: Vec<Arrow>,
    /// The middle of the drawing's extent.
    middle: Vector<f64>,
}

/// The part of a drawn body that does not depend on the configuration, in the body's frame.
#[derive(Debug, Clone, Serialize)]
struct BodyPart {
    outlines: Vec<DrawnShape>,
    com: Option<Vector<f64>>,
    mass: f64,
    last: bool,
}

#[derive(Debug, Clone, Serialize)]
struct PageContact {
    name: usize,
    point: Vector<f64>,
    normal: Vector<f64>,
    /// The velocity before the impact, in the world frame \[m/s\].
    before: Vector<f64>,
}

#[derive(Debug, Clone, Serialize)]
struct PageOutcome {
    /// The modes of the contacts in words, as the index of a text.
    words: usize,
    #[serde(rename = "marks", skip_serializing_if = "Vec::is_empty")]
    remarks: Vec<usize>,
    margin: Option<f64>,
    index: Option<i8>,
    energy_loss: f64,
    /// The tangential and normal components for each contact.
    impulse: Vec<Pair<f64>>,
    after: Vec<Pair<f64>>,
    /// For each loop, the link on which its impulse is drawn, and the impulse in the world frame.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    loops: Vec<(usize, Vector<f64>)>,
}

/// The scale of all drawings of a page.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct PageScale {
    /// The unit of coordinates, which are multiples of it \[m\].
    #[serde(skip)]
    pub unit: f64,
    /// The corners of the view \[m\]; along axes on which the view follows the robot, relative to the robot's middle.
    low: Vector<f64>,
    high: Vector<f64>,
    /// Whether the view follows the robot along x and along z.
    follows: [bool; 2],
    /// The mass of the heaviest body \[kg\].
    mass: f64,
    /// The impulse \[N s\], and the velocities after and before the impact \[m/s\], whose arrows have the usual length.
    impulse: f64,
    velocity: f64,
    before: f64,
}

/// The view is fixed along an axis if all states lie within this multiple of the largest size of the robot.
const FIXED: f64 = 1.5;

/// How values are weighted in the choice of the usual value, below which the `share` of all weights lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weight {
    share: f64,
    of: fn(f64) -> f64,
}

impl Weight {
    /// Each value has its size as weight. Many values near zero, such as those of feet at rest, have little effect.
    pub const SIZE: Self = Self { share: 0.9, of: |value| value };
    /// All values have the same weight. A few values next to a pole, where they are unbounded, have little effect.
    pub const ALIKE: Self = Self { share: 0.75, of: |_| 1.0 };
}

impl PageScale {
    pub fn of(states: &[PageState], weight: Weight) -> Self {
        let drawings: Vec<&Drawing> = states.iter().filter_map(|state| state.keyframe.drawing.as_ref()).collect();
        let extents: Vec<Extent> = drawings.iter().map(|drawing| drawing.extent()).collect();
        let size = extents.iter().map(|extent| extent.size()).fold(0.0, f64::max);
        let whole = Extent::of(extents.iter().flat_map(|extent| [extent.low, extent.high]));
        let widest = extents.iter().map(|extent| extent.high - extent.low).fold(Vector::zero(), Vector::greatest);
        let follows = (whole.high - whole.low).components().map(|span| span > FIXED * size);
        let unit = unit(size);
        let side = |way: f64, whole: Vector<f64>| {
            let x = if follows[0] { 0.5 * way * widest.x } else { whole.x };
            place(Vector::new(x, if follows[1] { 0.5 * way * widest.z } else { whole.z }), unit)
        };
        let masses = drawings.iter().flat_map(|drawing| &drawing.bodies).map(|body| body.mass);
        Self {
            unit,
            low: side(-1.0, whole.low),
            high: side(1.0, whole.high),
            follows,
            mass: significant(masses.fold(0.0, f64::max), 5),
            impulse: usual(drawings.iter().map(|drawing| drawing.greatest_impulse()), weight),
            velocity: usual(drawings.iter().map(|drawing| drawing.greatest_velocities()[1]), weight),
            before: usual(drawings.iter().map(|drawing| drawing.greatest_velocities()[0]), weight),
        }
    }
}

/// Returns the value that most of the positive values, by weight, do not exceed; 0 if no value is positive.
fn usual(values: impl Iterator<Item = f64>, Weight { share, of }: Weight) -> f64 {
    let mut values: Vec<f64> = values.filter(|value| *value > 0.0).collect();
    values.sort_unstable_by(f64::total_cmp);
    let share = share * values.iter().copied().map(of).sum::<f64>();
    let mut sum = 0.0;
    let usual = values.into_iter().find(|&value| {
        sum += of(value);
        sum >= share
    });
    significant(usual.unwrap_or(0.0), 5)
}

impl PageFrame {
    /// Creates the data of a state. Its coordinates are multiples of `unit` \[m\].
    pub fn new(state: &PageState, unit: f64, parts: &mut Interned, texts: &mut Interned) -> Self {
        let PageState { keyframe, region, name } = state;
        let answer = keyframe.answer.as_ref();
        Self {
            region: *region,
            name: name.clone(),
            verdict: answer.ok().map(|answer| answer.verdict),
            proven: answer.ok().map(|answer| answer.proven),
            sentence: texts.number(match answer {
                Ok(answer) => {
                    Wording::of(answer.aspect).verdict(answer.verdict, &answer.outcomes, answer.open.as_ref())
                }
                Err(error) => refusal(error),
            }),
            notes: keyframe.notes.iter().map(|note| texts.number(note)).collect(),
            outcomes: answer.iter().flat_map(|answer| outcomes(answer, keyframe.drawing.as_ref(), texts)).collect(),
            pose: keyframe.drawing.as_ref().map(|drawing| PageDrawing::new(drawing, unit, parts, texts)),
        }
    }
}

/// Returns why a state is refused, with the place and the remedy, as a sentence.
fn refusal(error: &Error) -> String {
    let place = error.place().map_or(String::new(), |place| format!("{place}: "));
    let remedy = error.remedy().map_or(String::new(), |remedy| format!(" (hint: {remedy})"));
    format!("Refused: {place}{}{remedy}", error.reason())
}

fn outcomes(answer: &KeyframeAnswer, drawing: Option<&Drawing>, texts: &mut Interned) -> Vec<PageOutcome> {
    let pairs = |pairs: &[Pair<f64>]| pairs.iter().map(|pair| pair.map(|entry| significant(entry, 5))).collect();
    let contacts = drawing.map_or(&[][..], |drawing| &drawing.contacts);
    let in_loops = |at: usize| drawing.and_then(|drawing| drawing.outcomes.get(at)).map(|drawn| &drawn.loop_impulse);
    let outcome = |(at, outcome): (usize, &Outcome)| PageOutcome {
        words: texts.number(picture::modes(contacts.iter().map(|contact| &contact.name), outcome)),
        remarks: picture::remarks(outcome, answer.aspect).into_iter().map(|remark| texts.number(remark)).collect(),
        margin: outcome.margin.map(|margin| significant(margin, 5)),
        index: outcome.index,
        energy_loss: significant(outcome.energy_loss, 5),
        impulse: pairs(&outcome.impulse),
        after: pairs(&outcome.velocity_after),
        loops: in_loops(at).into_iter().flatten().map(|(link, push)| (texts.number(link), vector(push))).collect(),
    };
    answer.outcomes.iter().enumerate().map(outcome).collect()
}

impl PageDrawing {
    fn new(drawing: &Drawing, unit: f64, parts: &mut Interned, texts: &mut Interned) -> Self {
        let at = |point: &Vector<f64>| place(*point, unit);
        let outline = |shape: &DrawnShape| match shape {
            DrawnShape::Disc { center, radius } => {
                DrawnShape::Disc { center: at(center), radius: to_unit(*radius, unit) }
            }
            DrawnShape::Polygon(corners) => DrawnShape::Polygon(corners.iter().map(at).collect()),
        };
        let body = |body: &DrawnBody| {
            let outlines = body.shapes.iter().map(outline).collect();
            let (com, mass) = (body.com.as_ref().map(at), significant(body.mass, 5));
            let part = BodyPart { outlines, com, mass, last: body.is_last };
            // Writing into memory cannot fail.
            let part = parts.number(serde_json::to_string(&part).unwrap_or_default());
            let (origin, axis) = (at(&body.origin), vector(&body.x_axis));
            (part, origin.x, origin.z, axis.x, axis.z)
        };
        let bones = |(number, body): (usize, &DrawnBody)| -> Vec<_> {
            let from = at(&body.origin);
            body.bones.iter().map(at).map(|to| (from.x, from.z, to.x, to.z, number)).collect()
        };
        let contact = |contact: &DrawnContact| PageContact {
            name: texts.number(&contact.name),
            point: at(&contact.point),
            normal: vector(&contact.normal),
            before: vector(&contact.velocity_before),
        };
        let arrow = |arrow: &Arrow| Arrow { point: at(&arrow.point), vector: vector(&arrow.vector) };
        let Extent { low, high } = drawing.extent();
        Self {
            bodies: drawing.bodies.iter().map(body).collect(),
            bones: drawing.bodies.iter().enumerate().flat_map(bones).collect(),
            joints: drawing.joints.iter().map(at).collect(),
            loops: drawing.loops.iter().map(at).collect(),
            ground: drawing.ground.iter().map(at).collect(),
            is_profile: drawing.is_profile,
            contacts: drawing.contacts.iter().map(contact).collect(),
            applied: drawing.applied.iter().map(arrow).collect(),
            middle: at(&((low + high) * 0.5)),
        }
    }
}

/// Rounds the entries of a vector to five significant digits.
fn vector(vector: &Vector<f64>) -> Vector<f64> {
    vector.map(|entry| significant(entry, 5))
}

/// Returns the unit of coordinates \[m\]: a power of ten such that `size` is at least ten thousand units.
fn unit(size: f64) -> f64 {
    let size = if size > 0.0 && size.is_finite() { size } else { 1.0 };
    libm::pow(10.0, libm::floor(libm::log10(size)) - 4.0)
}

/// Rounds a value to a multiple of `unit`, which is a power of ten.
fn to_unit(value: f64, unit: f64) -> f64 {
    let whole = (value / unit).round();
    // A quotient by an integer power of ten has fewer digits than a product with `unit`. Adding 0 gives -0 no sign.
    let rounded = if unit < 1.0 { whole / (1.0 / unit).round() } else { whole * unit };
    if rounded.is_finite() { rounded + 0.0 } else { value }
}

fn place(point: Vector<f64>, unit: f64) -> Vector<f64> {
    point.map(|entry| to_unit(entry, unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_or_tiny_values_do_not_set_the_scale() {
        let feet_at_rest = std::iter::repeat_n(5e-7, 600);
        assert_eq!(usual(feet_at_rest.chain([4.0, 4.4, 4.2]), Weight::SIZE), 4.4);
        // A single value that is far greater than many others does not set it, either.
        assert_eq!(usual(std::iter::repeat_n(2.0, 600).chain([40.0]), Weight::SIZE), 2.0);
        // Values next to the poles of a study do not set it.
        assert_eq!(usual(std::iter::repeat_n(17.4, 50).chain([8e11, 3e9]), Weight::ALIKE), 17.4);
    }

    #[test]
    fn numbers_have_the_digits_of_a_screen() {
        let unit = unit(1.3);
        let texts = [0.1 + 0.2, -1e-9, 1234.56789].map(|value| to_unit(value, unit).to_string());
        assert_eq!(texts, ["0.3", "0", "1234.5679"]);
        assert_eq!(to_unit(123_456.0, super::unit(5e6)), 123_500.0);
        assert_eq!([1.0 / 3.0, 2e-300, -123_456.7].map(|value| significant(value, 5)), [0.33333, 2e-300, -123_460.0]);
        assert_eq!(super::unit(0.0), 1e-4);
    }
}
