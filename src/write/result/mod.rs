//! The JSON contract: results are serialized from these structs, field by field in this order, and can be read back.
//!
//! Fields that do not apply are absent; fields that apply but have no value (the index on a border, the condition of a
//! singular matrix) are null. Numbers are written with every digit.

mod left_out;
mod refused;
mod brief;

pub use brief::{Brief, ContactInBrief, OutcomeInBrief};
pub use left_out::LeftOutRecord;
pub use refused::{ErrorObject, Refused};

use super::Detail;
#[cfg(feature = "schema")]
use super::state::any_object;
use super::state::{CounterexampleRecord, HoldsRecord, raw_state};
use crate::error::check_index;
use crate::gait::Landing;
use crate::impact::{Analysis, Explanation, Family, OpenCombinations, Outcome, Rejection, Verdict};
use crate::pipeline::{Aspect, Impact, LeftOut, NearestFoot, Sustained};
use crate::planar::{Pair, Vector};
use crate::read::Problem;
use crate::read::table::CarriedValue;
use crate::state::{Named, State, rough_friction};
use crate::{Mode, Robot};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use serde_json::value::RawValue;
use std::borrow::Cow;

/// The result of a state or of a contact problem. It is serialized whole; [`Report::append_json`] also writes it in
/// brief. Forces are serialized as their [`ForcesRecord`](super::ForcesRecord), under their own names, except by the
/// function `Report::serialize` that serde derives; only results of impacts are read back.
///
/// ```
/// # fn main() -> heelstrike::Result<()> {
/// # let urdf = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/minimalistic.urdf"));
/// use heelstrike::{Defaults, Options, Pipeline, Robot, State};
///
/// let robot = Robot::from_urdf(urdf)?;
/// let text = r#"{"position": {"base": {"pitch": -0.4}, "joints": {"hip": -0.8}}, "velocity": {"base": {"pitch": -1}},
///                "stance": "left_leg", "friction": "infinite"}"#;
/// let state = State::from_json(text, &robot, &Defaults::default())?;
/// let impact = Pipeline::new(&robot, Options { explain_up_to: 2, ..Options::default() }).impact(&state)?;
/// let report = heelstrike::Report::of_state(&robot, &state, &impact, heelstrike::Detail::default())?;
/// assert_eq!(report.verdict, Some(heelstrike::Verdict::Unique));
/// assert_eq!(heelstrike::Inspection::new(&robot, &[]).joints.len(), 1);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(remote = "Self")]
pub struct Report<'a> {
    /// The user's name for the input.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Id>"))]
    pub id: Option<Cow<'a, Value>>,
    /// The line on which the input begins, from 1; present in a batch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Where the state was found; present for a touchdown in a recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub touchdown: Option<Touchdown<'a>>,
    /// The answer in one word; absent if there is an `error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// Whether error bounds decide every combination; absent if there is an `error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proven: Option<bool>,
    /// Whether every state of the box has the same modes: true, false or "unknown"; absent without an uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holds: Option<HoldsRecord>,
    /// A state of the box with other outcomes; present if `holds` is false.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counterexample: Option<CounterexampleRecord<'a>>,
    /// The closed contacts, in the order of all lists per contact.
    pub contacts: Vec<ContactRecord<'a>>,
    /// The lowest foot that does not touch; absent if every foot touches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest: Option<NearestRecord<'a>>,
    /// Every outcome; absent if there is an `error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outcomes: Option<Cow<'a, [Outcome]>>,
    /// What an undecided state or problem leaves open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open: Option<OpenCombinations>,
    /// Lists of modes with many velocities, all of which are outcomes; absent if there are none.
    #[serde(default, skip_serializing_if = "<[Family]>::is_empty")]
    pub families: Cow<'a, [Family]>,
    /// Every other combination, if requested; for many contacts those that a search does not exclude.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rejected: Option<Vec<Rejected<'a>>>,
    /// Kinetic energy before the impact \[J\]; absent without a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kinetic_energy: Option<f64>,
    /// Whether some outcome has no sliding contact; null if that is undecided, absent if there is an `error`.
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-may-be-null" = true)))]
    pub no_slip_consistent: Option<Option<bool>>,
    /// beta, gamma and region of each contact (paper, section 4), if requested; null for a singular Delassus matrix.
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-may-be-null" = true)))]
    pub explain: Option<Option<Cow<'a, Explanation>>>,
    /// Sum of the outcomes' indices; null if one of them has none.
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-may-be-null" = true)))]
    pub index_sum: Option<Option<i32>>,
    /// Condition number of the Delassus matrix scaled to a unit diagonal; null if it is singular.
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-may-be-null" = true)))]
    pub condition: Option<Option<f64>>,
    /// Rank of the Delassus matrix.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
    /// Parts of the robot's file and of the scene that do not enter the analysis; absent without a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<Vec<LeftOutRecord<'a>>>,
    /// Notes for the reader, in whole sentences.
    #[serde(default, skip_serializing_if = "<[String]>::is_empty")]
    pub notes: Cow<'a, [String]>,
    /// Names of the kept coordinates in the order of q, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<Cow<'a, [String]>>,
    /// M, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_matrix: Option<Cow<'a, [Vec<f64>]>>,
    /// J, rows tangential and normal per contact, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_jacobian: Option<Cow<'a, [Vec<f64>]>>,
    /// G = J M^-1 J^T, without what the loops do not let move; if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delassus: Option<Cow<'a, [Vec<f64>]>>,
    /// Columns of the input table that are copied unchanged: as text or, from JSON and typed columns, as values.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<std::collections::BTreeMap<String, Value>>"))]
    pub carried: Option<Named<CarriedValue>>,
    /// The reason why there are no outcomes although the matrices are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorObject>,
    /// For a state in sustained contact, its additional data and the contacts' accelerations without forces. Such a
    /// result is written under other names.
    #[serde(skip)]
    pub sustained: Option<(&'a Sustained, &'a [Pair<f64>])>,
}

/// A combination of modes that is not an outcome.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rejected<'a> {
    /// One mode per contact.
    pub modes: Cow<'a, [Mode]>,
    /// The reason, with the contact's name.
    pub because: String,
    /// The smallest slack, negative; null if the combination has no solution.
    pub margin: Option<f64>,
    /// The impulses that it would have needed \[N s\].
    pub impulse: Option<Cow<'a, [Pair<f64>]>>,
    /// The contact velocities that it would have led to \[m/s\].
    pub velocity_after: Option<Cow<'a, [Pair<f64>]>>,
}

/// A closed contact.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "Contact")]
pub struct ContactRecord<'a> {
    /// The URDF link that carries the shape; absent without a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub link: Option<Cow<'a, str>>,
    /// Its name: that of its link, or link/0, link/1 ... if the link has several (link//0 if others are called link/0).
    pub name: Cow<'a, str>,
    /// The contact point in the world \[m\]; absent without a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub point: Option<Vector<f64>>,
    /// Unit normal of the ground, toward the robot; absent without a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<Vector<f64>>,
    /// Height above the ground along the normal \[m\]; absent without a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap: Option<f64>,
    /// Its velocity before the impact, [tangential, normal] \[m/s\].
    pub velocity_before: Pair<f64>,
}

/// A foot that does not touch, or that is too deep in the ground.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "NearestFoot")]
pub struct NearestRecord<'a> {
    /// The URDF link that carries it.
    pub name: Cow<'a, str>,
    /// Height of its lowest point above the ground along the normal \[m\], negative below it.
    pub height: f64,
    /// Velocity of that point before the impact, [tangential, normal] \[m/s\].
    pub velocity: Pair<f64>,
}

/// Where in a recording a foot reached the ground, and how the state was taken.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Touchdown<'a> {
    /// The line of the state's row in the table, or of the last row before it, from 1.
    pub row: usize,
    /// The time of the state \[s\].
    pub time: f64,
    /// The contact that reached the ground; the first one of several at once.
    pub striking: Cow<'a, str>,
    /// The shift of the base along z that puts this contact at height 0 \[m\].
    pub shift_z: f64,
    /// `crossing` if the state lies between two rows, `row` if it is one.
    pub at: Cow<'a, str>,
    /// Which other feet touch the ground: `strike`, `slow:SPEED,HEIGHT` or `near:HEIGHT`.
    pub touching: String,
    /// The state before the impact, to be fed back.
    #[cfg_attr(feature = "schema", schemars(schema_with = "any_object"))]
    pub state: Box<RawValue>,
    /// Its q and v, for tables.
    #[serde(skip)]
    pub coordinates: Vec<f64>,
}

impl<'a> Touchdown<'a> {
    /// Creates the record of a touchdown: its `state` at `time` \[s\] was found at or after a `row` of a recording.
    pub fn of(robot: &Robot, state: &State, landing: &'a Landing, row: usize, time: f64) -> Option<Self> {
        Some(Self {
            row,
            time,
            striking: (&landing.striking).into(),
            shift_z: landing.shift_z,
            at: landing.at.name().into(),
            touching: landing.touching.to_string(),
            state: raw_state(robot, state)?,
            coordinates: [&state.position[..], &state.velocity].concat(),
        })
    }
}

impl<'a> ContactRecord<'a> {
    pub(super) fn of_problem(name: &'a str, velocity_before: Pair<f64>) -> Self {
        Self { name: Cow::Borrowed(name), velocity_before, ..Self::default() }
    }
}

impl<'a> Report<'a> {
    /// Creates the result of a state. If the outcomes were refused, it has an `error` next to the requested matrices.
    ///
    /// # Errors
    /// Returns the refusal of the outcomes as an error if no matrices were requested, and
    /// [`Reason::Inconsistent`](crate::Reason::Inconsistent) if `impact` has contacts or joints that `robot` does not
    /// have, because it is the answer of another robot.
    pub fn of_state(robot: &'a Robot, state: &'a State, impact: &'a Impact, detail: Detail) -> crate::Result<Self> {
        impact.contacts.iter().try_for_each(|contact| check_index(contact.link, ("links", robot.links.len())))?;
        for omitted in &impact.left_out {
            if let LeftOut::Column(joint) = omitted {
                check_index(*joint, ("joints", robot.joints.len()))?;
            }
        }
        let error = match impact.analyzed() {
            Err(error) if impact.matrices.is_none() => return Err(error),
            analysis => analysis.err(),
        };
        let contacts = impact.contacts.iter().zip(&impact.velocity_before);
        let contacts = contacts.map(|(contact, velocity)| ContactRecord {
            link: robot.links.get(contact.link).map(|link| Cow::Borrowed(&*link.name)),
            point: Some(contact.point),
            normal: Some(contact.normal()),
            gap: Some(contact.gap),
            ..ContactRecord::of_problem(&contact.name, *velocity)
        });
        let nearest = impact.nearest.and_then(|NearestFoot { link, height, velocity }| {
            Some(NearestRecord { name: Cow::Borrowed(&robot.links.get(link)?.name), height, velocity })
        });
        let matrices = impact.matrices.as_ref();
        let analyzed = Self::of_analysis(contacts.collect(), impact.analysis.as_ref(), detail);
        // These fields rest on theorems about impacts; none is known for forces.
        let analyzed = match impact.aspect() {
            Aspect::Impact => analyzed,
            Aspect::Forces => Self { no_slip_consistent: None, index_sum: None, explain: None, ..analyzed },
        };
        Ok(Self {
            id: state.id.as_ref().map(Cow::Borrowed),
            nearest,
            kinetic_energy: Some(impact.kinetic_energy),
            left_out: (!detail.brief).then(|| LeftOutRecord::of_impact(robot, impact)),
            sustained: impact.sustained.as_ref().map(|sustained| (sustained, impact.problem.velocity_free())),
            holds: impact.holds.as_ref().map(HoldsRecord::from),
            counterexample: impact.holds.as_ref().and_then(|holds| CounterexampleRecord::of(robot, holds)),
            notes: Cow::Borrowed(&impact.notes),
            coordinates: matrices.map(|matrices| Cow::Borrowed(&*matrices.coordinates)),
            mass_matrix: matrices.map(|matrices| Cow::Borrowed(&*matrices.mass_matrix)),
            contact_jacobian: matrices.map(|matrices| Cow::Borrowed(&*matrices.contact_jacobian)),
            delassus: matrices.map(|matrices| Cow::Borrowed(&*matrices.delassus)),
            error: error.as_ref().map(ErrorObject::new),
            ..analyzed
        })
    }

    /// Creates the result of a contact problem without a robot.
    pub fn of_problem(problem: &'a Problem, analysis: &'a Analysis, detail: Detail) -> Self {
        let contacts = problem.names.iter().zip(problem.contact.velocity_before());
        let contacts = contacts.map(|(name, velocity)| ContactRecord::of_problem(name, *velocity)).collect();
        Self {
            id: problem.id.as_ref().map(Cow::Borrowed),
            delassus: detail.matrices.then(|| Cow::Owned(delassus(problem))),
            notes: notes(problem, analysis),
            ..Self::of_analysis(contacts, Some(analysis), detail)
        }
    }

    /// Creates the fields that results of states and of contact problems share.
    fn of_analysis(contacts: Vec<ContactRecord<'a>>, known: Option<&'a Analysis>, detail: Detail) -> Self {
        let Some(analysis) = known else { return Self { contacts, ..Self::default() } };
        let rejected = detail.explain.then(|| {
            let names: Vec<String> = contacts.iter().map(|contact| contact.name.to_string()).collect();
            let rejected = |rejection: &'a Rejection| Rejected {
                modes: Cow::Borrowed(&rejection.modes),
                because: rejection.because.describe(&names),
                margin: rejection.margin,
                impulse: rejection.motion.as_ref().map(|motion| Cow::Borrowed(&*motion.impulse)),
                velocity_after: rejection.motion.as_ref().map(|motion| Cow::Borrowed(&*motion.velocity_after)),
            };
            analysis.rejected.iter().map(rejected).collect()
        });
        Self {
            verdict: Some(analysis.verdict),
            proven: Some(analysis.proven),
            outcomes: Some(Cow::Borrowed(&analysis.outcomes)),
            open: analysis.open,
            families: Cow::Borrowed(&analysis.families),
            rejected,
            no_slip_consistent: Some(analysis.no_slip_consistent),
            explain: detail.explain.then(|| analysis.explanation.as_ref().map(Cow::Borrowed)),
            index_sum: Some(analysis.index_sum),
            condition: analysis.rank.map(|_| analysis.condition),
            rank: analysis.rank,
            contacts,
            ..Self::default()
        }
    }

    /// Appends the result as one line of JSON, whole or in brief.
    pub fn append_json(&self, detail: Detail, out: &mut Vec<u8>) {
        match detail.brief {
            true => super::append_line(out, &self.brief()),
            false => super::append_line(out, self),
        }
    }
}

impl Serialize for Report<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.forces() {
            Some(forces) => forces.serialize(serializer),
            None => Self::serialize(self, serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Report<'_> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::deserialize(deserializer)
    }
}

/// The number of characters of an id that [`short_id`] keeps.
const ID_LIMIT: usize = 200;

/// Shortens an id that only has to be recognized: a long text is cut and ends with `... (cut)`.
pub(crate) fn short_id(id: Value) -> Value {
    let end = id.as_str().and_then(|text| text.char_indices().nth(ID_LIMIT));
    match (&id, end) {
        (Value::String(text), Some((end, _))) => format!("{}... (cut)", &text[..end]).into(),
        _ => id,
    }
}

/// The user's name for a state or a problem.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
#[expect(dead_code, reason = "the schema is all that is wanted of it")]
pub(super) enum Id {
    /// A name.
    Text(String),
    /// A number.
    Number(f64),
}

/// Above this condition number, the last digits of a matrix decide whether it is regular.
const ILL_CONDITIONED: f64 = 1e14;

fn notes(problem: &Problem, analysis: &Analysis) -> Cow<'static, [String]> {
    let keep = "give mass_matrix, contact_jacobian and velocity to keep what rounding loses";
    let mut notes = Vec::from_iter(rough_friction(problem.contact.friction()));
    if problem.contact.is_repaired() {
        let rank = analysis.rank.map_or(String::new(), |rank| format!(", of rank {rank},"));
        notes.push(format!(
            "the Delassus matrix is indefinite by its rounding: the nearest semidefinite one{rank} was taken; {keep}"
        ));
    }
    let mean = |matrix: &str| {
        let taken = "the mean of it and its transpose was taken, every digit meant";
        format!("the {matrix} matrix is not symmetric by its rounding: {taken}")
    };
    notes.extend(problem.contact.is_symmetrized().then(|| mean("Delassus")));
    notes.extend(problem.contact.is_mass_symmetrized().then(|| mean("mass")));
    let is_matrix = problem.contact.is_given() || problem.contact.is_symmetrized();
    if let Some(condition) = analysis.condition.filter(|&condition| condition > ILL_CONDITIONED && is_matrix) {
        notes.push(format!(
            "the Delassus matrix has condition {condition:.1e} and may be singular except for rounding: {keep}"
        ));
    }
    notes.extend(analysis.notes(&problem.contact, || 0.0));
    notes.into()
}

/// Returns the Delassus matrix G, two rows and columns per contact.
fn delassus(problem: &Problem) -> Vec<Vec<f64>> {
    let rows = 0..2 * problem.contact.contacts();
    rows.clone().map(|row| rows.clone().map(|column| problem.contact.delassus(row, column)).collect()).collect()
}

/// Reads a field that may be absent and may also be null: null gives `Some(None)`.
fn present<'de, D: Deserializer<'de>, T: Deserialize<'de>>(field: D) -> Result<Option<T>, D::Error> {
    T::deserialize(field).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{Options, Pipeline};
    use crate::state::Defaults;

    #[test]
    fn brief_impact_has_all_of_a_brief_result() {
        let robot = Robot::from_urdf(include_str!("../../../urdf/ramone.urdf")).unwrap();
        let detail = Detail { brief: true, ..Detail::default() };
        for text in
            [include_str!("../../../examples/ramone.json"), include_str!("../../../examples/ramone_measured.json")]
        {
            let state = State::from_json(text, &robot, &Defaults::default()).unwrap();
            let [whole, brief] = [false, true].map(|brief| {
                let impact = Pipeline::new(&robot, Options { brief, ..Options::default() }).impact(&state).unwrap();
                let mut line = Vec::new();
                Report::of_state(&robot, &state, &impact, detail).unwrap().append_json(detail, &mut line);
                line
            });
            assert_eq!(String::from_utf8(whole), String::from_utf8(brief));
        }
    }

    #[test]
    fn a_written_result_reads_back_as_the_same() {
        let robot = Robot::from_urdf(include_str!("../../../urdf/ramone.urdf")).unwrap();
        let options = Options { explain_up_to: 9, matrices: true, ..Options::default() };
        let detail = Detail { explain: true, matrices: true, ..Detail::default() };
        let wide = include_str!("../../../examples/ramone_measured.json").replace("1e-3", "1e-2");
        for text in [include_str!("../../../examples/ramone.json"), &wide] {
            let state = State::from_json(text, &robot, &Defaults::default()).unwrap();
            let impact = Pipeline::new(&robot, options.clone()).impact(&state).unwrap();
            let mut lines = [Vec::new(), Vec::new()];
            Report::of_state(&robot, &state, &impact, detail).unwrap().append_json(detail, &mut lines[0]);
            let read: Report = serde_json::from_slice(&lines[0]).unwrap();
            read.append_json(detail, &mut lines[1]);
            assert_eq!(lines[0], lines[1]);
            assert_eq!(read.outcomes.as_deref(), Some(&*impact.analysis.unwrap().outcomes));
        }
    }
}
