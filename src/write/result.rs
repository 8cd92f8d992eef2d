//! The JSON contract: these structs are what is written, field by field and in this order.
//!
//! Fields that do not apply are absent; fields that apply but have no value (the index on a border, the condition of a
//! singular matrix) are null. Numbers are written with every digit.

use super::Detail;
use super::holds::{Counterexample, Holds};
use super::outcome::{Outcome, OutcomeInBrief};
#[cfg(feature = "schema")]
use super::schema::Id;
use super::touchdown::{CarriedFields, Touchdown};
use crate::impact::{Analysis, Explanation, ImpulseRegion, Verdict, outcome};
use crate::law::Mode;
use crate::pipeline::{Impact, Matrices};
use crate::planar::{Pair, Vector};
use crate::read::Problem;
use crate::state::State;
use crate::{Error, Result, Robot, contact, description, pipeline};
use serde::Serialize;
use serde_json::Value;
use std::borrow::Cow;

/// The result of a state or of a contact problem.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Report<'a> {
    /// What the user calls it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Id>"))]
    pub id: Option<&'a Value>,
    /// Where the state was found; of a touchdown in a recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub touchdown: Option<Touchdown<'a>>,
    /// The answer in one word; absent beside an `error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// Every combination is decided by an error bound: the list is complete and right; absent beside an `error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proven: Option<bool>,
    /// Whether every state of the box has the same outcomes, as lists of modes: true, false or "unknown"; of an uncertain
    /// state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holds: Option<Holds>,
    /// A state of the box with other outcomes; where `holds` is false.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counterexample: Option<Counterexample<'a>>,
    /// The closed contacts, in the order of all lists per contact.
    pub contacts: Vec<Contact<'a>>,
    /// Every outcome; absent beside an `error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outcomes: Option<Vec<Outcome<'a>>>,
    /// Every other combination, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rejected: Option<Vec<Rejected<'a>>>,
    /// Kinetic energy before the impact \[J\]; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kinetic_energy: Option<f64>,
    /// Whether some outcome has no sliding contact; null where that is undecided, absent beside an `error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-may-be-null" = true)))]
    pub no_slip_consistent: Option<Option<bool>>,
    /// The paper's section 4 for each contact, if asked for; null for a singular Delassus matrix.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-may-be-null" = true)))]
    pub explain: Option<Option<Explained<'a>>>,
    /// Sum of the outcomes' indices; null where one of them has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-may-be-null" = true)))]
    pub index_sum: Option<Option<i32>>,
    /// Condition number of the Delassus matrix scaled to a unit diagonal; null where it is singular.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-may-be-null" = true)))]
    pub condition: Option<Option<f64>>,
    /// Rank of the Delassus matrix.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
    /// What of the robot's file and of the scene does not enter the analysis; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<Vec<LeftOut<'a>>>,
    /// What a reader should know, in whole sentences.
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    pub notes: Cow<'a, [String]>,
    /// Names of the kept coordinates in the order of q, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<&'a [String]>,
    /// M, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_matrix: Option<&'a [Vec<f64>]>,
    /// J, rows tangential and normal per contact, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_jacobian: Option<&'a [Vec<f64>]>,
    /// G = J M^-1 J^T, without what the loops do not let move; if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delassus: Option<Cow<'a, [Vec<f64>]>>,
    /// Fields of the table that the state comes from and that mean nothing here, as they stand there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub carried: Option<CarriedFields<'a>>,
    /// Why there are no outcomes although the matrices are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorObject<'a>>,
}

/// A closed contact.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Contact<'a> {
    /// The URDF link that carries the shape; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub link: Option<&'a str>,
    /// Its name, which is its link's, or link/0, link/1 ... where a link has several.
    pub name: &'a str,
    /// The contact point in the world \[m\]; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub point: Option<Vector<f64>>,
    /// Unit normal of the ground, toward the robot; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<Vector<f64>>,
    /// Height above the ground along the normal \[m\]; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap: Option<f64>,
    /// Its velocity before the impact, [tangential, normal] \[m/s\].
    pub velocity_before: Pair<f64>,
}

/// Something of the robot's file or of the scene that does not enter the analysis.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeftOut<'a> {
    /// What, as in `joint "left_ankle"`.
    pub what: Cow<'a, str>,
    /// Why, as in `fixed: welded into left_shank`.
    pub why: &'a str,
}

impl<'a> LeftOut<'a> {
    /// All that was left out of `robot`, and of every robot.
    pub fn all(robot: &'a Robot) -> Vec<Self> {
        let what = Cow::Borrowed("gravity, Coriolis forces, joint limits");
        let never = Self { what, why: "do not enter an impact" };
        let of_robot = robot.left_out.iter().map(|left| Self { what: Cow::Borrowed(&left.what), why: &left.why });
        of_robot.chain([never]).collect()
    }

    /// All that was left out of this impact, and then of its `robot`.
    pub fn of_impact(robot: &'a Robot, impact: &Impact) -> Vec<Self> {
        let contacts = |of: &[usize]| of.iter().map(|&at| &*impact.contacts[at].name).collect::<Vec<_>>().join(", ");
        let shapes = |count: usize| if count == 1 { "1 shape".to_owned() } else { format!("{count} shapes") };
        let of_scene = impact.left_out.iter().map(|left| {
            let (what, why) = match left {
                pipeline::LeftOut::Column(joint) => {
                    (description::joint_place(&robot.joints[*joint].name), "held: it keeps its rate and has no column")
                }
                pipeline::LeftOut::OutOfReach(count) => {
                    (format!("{} out of reach", shapes(*count)), "too high to reach the ground")
                }
                pipeline::LeftOut::NotAsked(count) => {
                    (format!("{} of the file", shapes(*count)), "contacts are named by hand")
                }
                pipeline::LeftOut::Tangential(of) => (format!("tangential impulse of {}", contacts(of)), "friction 0"),
                pipeline::LeftOut::Cone(of) => (format!("friction cone of {}", contacts(of)), "infinite friction"),
            };
            Self { what: Cow::Owned(what), why }
        });
        of_scene.chain(Self::all(robot)).collect()
    }
}

/// A combination of modes that is not an outcome.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rejected<'a> {
    /// One mode per contact.
    pub modes: &'a [Mode],
    /// Why it is none, with the contact's name.
    pub because: String,
    /// The smallest slack, negative; null where the combination has no solution at all.
    pub margin: Option<f64>,
    /// The impulses that it would have needed \[N s\].
    pub impulse: Option<&'a [Pair<f64>]>,
    /// The contact velocities that it would have led to \[m/s\].
    pub velocity_after: Option<&'a [Pair<f64>]>,
}

/// The paper's section 4, one entry per contact.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Explained<'a> {
    /// Angle of the impulse of a pure slide \[rad\].
    pub beta: &'a [f64],
    /// Angle of the impulse that the contact takes over from the rest \[rad\].
    pub gamma: &'a [f64],
    /// What infinite friction does there.
    pub region: &'a [ImpulseRegion],
}

/// The result in brief.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Brief<'a> {
    /// What the user calls it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Id>"))]
    pub id: Option<&'a Value>,
    /// Where the state was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub touchdown: Option<Touchdown<'a>>,
    /// The answer in one word.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// Every combination is decided by an error bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proven: Option<bool>,
    /// Whether every state of the box has the same outcomes; of an uncertain state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holds: Option<Holds>,
    /// Every outcome.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outcomes: Option<Vec<OutcomeInBrief<'a>>>,
    /// Why there are no outcomes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorObject<'a>>,
}

/// What stands in place of the result of a refused input.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Refused<'a> {
    /// What the user calls it, where that can be read; of a long one the beginning and `... (cut)`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Id>"))]
    pub id: Option<Value>,
    /// The line on which the input begins, from 1.
    pub line: usize,
    /// Why it was refused.
    pub error: ErrorObject<'a>,
}

/// A refusal; it names no file, so that a file, a pipe and standard input give the same bytes.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ErrorObject<'a> {
    /// Why.
    pub message: String,
    /// Where inside the input, as in `position.joints.left_hip`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<&'a str>,
    /// What to do.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hint: Option<&'a str>,
}

impl<'a> Refused<'a> {
    /// The refusal of the input that begins on `line`.
    pub fn new(id: Option<Value>, line: usize, error: &'a Error) -> Self {
        Self { id: id.map(super::short_id), line, error: ErrorObject::new(error) }
    }
}

impl<'a> ErrorObject<'a> {
    /// The error without its file, line and column.
    pub fn new(error: &'a Error) -> Self {
        Self { message: error.reason().to_string(), place: error.place(), hint: error.remedy() }
    }
}

impl<'a> Report<'a> {
    /// The result of a state. Where the outcomes were refused it has an `error`, beside the matrices if they were asked for.
    ///
    /// # Errors
    /// The refusal of the outcomes, where there are no matrices that could stand beside it.
    pub fn of_state(robot: &'a Robot, state: &'a State, impact: &'a Impact, detail: Detail) -> Result<Self> {
        let analysis = match &impact.analysis {
            Err(error) if impact.matrices.is_none() => return Err(error.clone()),
            analysis => analysis.as_ref(),
        };
        let contacts = impact.contacts.iter().zip(&impact.velocity_before);
        let contacts = contacts.map(|(contact, velocity)| Contact::of_robot(robot, contact, *velocity)).collect();
        let mut report = Self {
            id: state.id.as_ref(),
            kinetic_energy: Some(impact.kinetic_energy),
            left_out: Some(LeftOut::of_impact(robot, impact)),
            holds: impact.holds.as_ref().map(Holds::from),
            counterexample: impact.holds.as_ref().and_then(|holds| Counterexample::of(robot, holds)),
            notes: Cow::Borrowed(&impact.notes),
            ..Self::of_analysis(contacts, analysis, detail)
        };
        for (outcome, velocity) in report.outcomes.iter_mut().flatten().zip(&impact.velocity_after) {
            outcome.set_velocity_after(robot, velocity);
        }
        for (outcome, impulse) in report.outcomes.iter_mut().flatten().zip(&impact.loop_impulse) {
            outcome.loop_impulse = (!impulse.is_empty()).then_some(impulse);
        }
        if let Some(Matrices { coordinates, mass_matrix, contact_jacobian, delassus }) = &impact.matrices {
            report.coordinates = Some(coordinates);
            report.mass_matrix = Some(mass_matrix);
            report.contact_jacobian = Some(contact_jacobian);
            report.delassus = Some(Cow::Borrowed(delassus));
        }
        Ok(report)
    }

    /// The result of a contact problem without a robot.
    pub fn of_problem(problem: &'a Problem, analysis: &'a Analysis, detail: Detail) -> Self {
        let contacts = problem.names.iter().zip(problem.contact.velocity_before());
        let contacts = contacts.map(|(name, velocity)| Contact::of_problem(name, *velocity)).collect();
        Self {
            id: problem.id.as_ref(),
            delassus: detail.matrices.then(|| Cow::Owned(super::problem::delassus(problem))),
            notes: super::problem::notes(problem, analysis),
            ..Self::of_analysis(contacts, Ok(analysis), detail)
        }
    }

    /// What robots and matrices have in common.
    fn of_analysis(
        contacts: Vec<Contact<'a>>,
        analysis: std::result::Result<&'a Analysis, &'a Error>,
        detail: Detail,
    ) -> Self {
        let known = analysis.ok();
        let explained = known.filter(|_| detail.explain);
        let rejected = explained.map(|analysis| {
            let names: Vec<String> = contacts.iter().map(|contact| contact.name.to_owned()).collect();
            analysis.rejected.iter().map(|rejection| Rejected::new(rejection, &names)).collect()
        });
        let outcomes = known.map(|analysis| {
            let name = |contact: usize| contacts[contact].name;
            analysis.outcomes.iter().map(|outcome| Outcome::new(outcome, name)).collect()
        });
        Self {
            id: None,
            touchdown: None,
            verdict: known.map(|analysis| analysis.verdict),
            proven: known.map(|analysis| analysis.proven),
            holds: None,
            counterexample: None,
            outcomes,
            rejected,
            kinetic_energy: None,
            no_slip_consistent: known.map(|analysis| analysis.no_slip_consistent),
            explain: explained.map(|analysis| analysis.explanation.as_ref().map(Explained::new)),
            index_sum: known.map(|analysis| analysis.index_sum),
            condition: known.map(|analysis| analysis.condition),
            rank: known.map(|analysis| analysis.rank),
            left_out: None,
            notes: Cow::Borrowed(&[]),
            coordinates: None,
            mass_matrix: None,
            contact_jacobian: None,
            delassus: None,
            carried: None,
            error: analysis.err().map(ErrorObject::new),
            contacts,
        }
    }

    /// The same in brief.
    pub fn brief(&self) -> Brief<'a> {
        Brief {
            id: self.id,
            touchdown: self.touchdown.clone(),
            verdict: self.verdict,
            proven: self.proven,
            holds: self.holds,
            outcomes: self.outcomes.as_ref().map(|outcomes| outcomes.iter().map(Outcome::brief).collect()),
            error: self.error.clone(),
        }
    }

    /// Appends the result to `out` as one line of JSON, whole or in brief.
    pub fn append_json(&self, detail: Detail, out: &mut Vec<u8>) {
        if detail.brief { super::append_line(out, &self.brief()) } else { super::append_line(out, self) }
    }
}

impl<'a> Contact<'a> {
    fn of_robot(robot: &'a Robot, contact: &'a contact::Contact, velocity_before: Pair<f64>) -> Self {
        Self {
            link: robot.links.get(contact.link).map(|link| link.name.as_str()),
            name: &contact.name,
            point: Some(contact.point),
            normal: Some(contact.normal()),
            gap: Some(contact.gap),
            velocity_before,
        }
    }

    fn of_problem(name: &'a str, velocity_before: Pair<f64>) -> Self {
        Self { link: None, name, point: None, normal: None, gap: None, velocity_before }
    }
}

impl<'a> Rejected<'a> {
    fn new(rejection: &'a outcome::Rejection, names: &[String]) -> Self {
        Self {
            modes: &rejection.modes,
            because: rejection.because.describe(names),
            margin: rejection.margin,
            impulse: rejection.motion.as_ref().map(|motion| motion.impulse.as_slice()),
            velocity_after: rejection.motion.as_ref().map(|motion| motion.velocity_after.as_slice()),
        }
    }
}

impl<'a> Explained<'a> {
    fn new(explanation: &'a Explanation) -> Self {
        Self { beta: &explanation.beta, gamma: &explanation.gamma, region: &explanation.region }
    }
}
