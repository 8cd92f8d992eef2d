//! The types of an analysis's answer: outcomes, rejections and the verdict.

use crate::law::{Inequality, Mode};
use crate::planar::{Pair, Vector};
use crate::state::Named;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::LazyLock;

/// The answer in one word; [`Analysis`] has an example.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Verdict {
    /// Exactly one outcome.
    Unique,
    /// Several outcomes are equally valid.
    Ambiguous,
    /// No outcome is consistent; impossible for a regular Delassus matrix (paper, the index theorem).
    None,
    /// Some combination's signs may be zero in every precision, or the budget of work was spent before they were known.
    Undecided,
    /// The only outcome has zero impulse.
    NoImpact,
    /// Nothing touches the ground.
    NoContact,
}

impl Verdict {
    /// All verdicts, in their order.
    pub const ALL: [Self; 6] =
        [Self::Unique, Self::Ambiguous, Self::None, Self::Undecided, Self::NoImpact, Self::NoContact];

    /// The name in results, such as `no_impact`.
    pub fn name(self) -> &'static str {
        static NAMES: LazyLock<[String; 6]> = LazyLock::new(|| Verdict::ALL.map(|verdict| verdict.to_string()));
        &NAMES[self as usize]
    }
}

impl fmt::Display for Verdict {
    /// Writes the name in results.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// A consistent combination of modes, written as a JSON object with these fields; [`Analysis`] has an example.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Outcome {
    /// One mode per contact.
    pub modes: Vec<Mode>,
    /// Contact impulses, [tangential, normal] per contact \[N s\].
    pub impulse: Vec<Pair<f64>>,
    /// Contact velocities after the impact, [tangential, normal] per contact \[m/s\].
    pub velocity_after: Vec<Pair<f64>>,
    /// Velocity of the base after the impact \[m/s, rad/s\]; absent without a floating base.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_velocity_after: Option<Named>,
    /// Rates of the joints after the impact, braked ones included \[rad/s, m/s\]; absent without a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_velocity_after: Option<Named>,
    /// Impulse on point a of each loop, [x, z] in the world \[N s\]; the opposite acts on b. Absent without loops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loop_impulse: Option<Vec<Vector>>,
    /// Kinetic energy that the contacts dissipate, -1/2 L.(c- + c+) \[J\]; negative if Newton's restitution with
    /// friction adds energy. For forces the power that they dissipate \[W\].
    pub energy_loss: f64,
    /// False if other admissible impulses give the same velocity; `impulse` then has the least sum of squares.
    pub impulse_unique: bool,
    /// Least and greatest value of every entry of `impulse`, null without a bound; present if `impulse` is not unique.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impulse_range: Option<Vec<Pair<Range>>>,
    /// |L_t| / L_n of each sticking contact that is pressed on the ground; null for others. If `impulse` is not unique:
    /// the least friction that holds all contacts that share the impulse, such as those of one foot, or, if their
    /// frictions differ, the least admissible ratio of each contact.
    pub friction_needed: Vec<Option<f64>>,
    /// Sign of det A (paper, section 2); null if it is not defined, as on a border.
    pub index: Option<i8>,
    /// The smallest slack of the outcome's inequalities, free of units; null if there is no inequality.
    pub margin: Option<f64>,
    /// The impulse inequalities that are exactly zero, and the modes beyond; present on a border.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub border: Option<Border>,
    /// Whether the outcome is a corner of a [`Family`]; absent if not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub family: bool,
    /// Whether error bounds show every sign, and every number of this outcome is right to 1e-10 of its scale.
    pub proven: bool,
    /// The forces just after the impact, if requested; absent without a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<Next>,
    /// False if the combination is neither shown nor excluded, because no precision settled a sign or the budget of
    /// work was spent; absent if true.
    #[serde(default = "yes", skip_serializing_if = "Clone::clone")]
    pub decided: bool,
}

/// The forces just after an outcome, in the same pose and at the velocities after it: contacts whose normal velocity is
/// zero then take part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Next {
    /// The verdict on the forces.
    pub verdict: Verdict,
    /// Whether error bounds show every sign, for the velocities as printed and with the outcome's modes.
    pub proven: bool,
    /// The modes of every set of forces, one per contact of the impact; null for a contact that has left the ground.
    pub modes: Vec<Vec<Option<Mode>>>,
}

/// A bounded convex set of velocities with the same modes, all of which are outcomes.
///
/// Faces on which only an impulse inequality is zero belong to the set. Velocities on its other faces have other modes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Family {
    /// One mode per contact.
    pub modes: Vec<Mode>,
    /// 1 for a segment, 2 for an area, and so on.
    pub dimension: usize,
    /// Indices into `outcomes` of the corners of its closure; each corner has the modes of its own velocity.
    pub corners: Vec<usize>,
}

/// The least and the greatest value; `None` for an end without bound.
pub type Range = [Option<f64>; 2];

/// Where an outcome turns into others: impulse inequalities that are zero for every admissible impulse.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Border {
    /// The impulse inequalities that are exactly zero.
    pub at_zero: Vec<AtZero>,
    /// The lists of modes beyond the border, each different in one contact. If several inequalities are zero,
    /// combinations of these are neighbors, too.
    pub neighbours: Vec<Vec<Mode>>,
}

/// An impulse inequality that is zero.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AtZero {
    /// The contact's name.
    pub contact: String,
    /// The inequality that is zero.
    #[cfg_attr(feature = "schema", schemars(with = "ZeroImpulse"))]
    pub inequality: Inequality,
}

/// The schema of an [`AtZero`] inequality: only those of impulses, since a velocity of zero belongs to another outcome.
#[cfg(feature = "schema")]
struct ZeroImpulse;

#[cfg(feature = "schema")]
impl schemars::JsonSchema for ZeroImpulse {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Zero".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let all = Inequality::json_schema(generator);
        let named = |inequality| {
            let wanted = serde_json::json!(inequality);
            all.get("oneOf")?.as_array()?.iter().find(|known| known["const"] == wanted).cloned()
        };
        let known: Vec<serde_json::Value> = Inequality::OF_IMPULSES.into_iter().filter_map(named).collect();
        schemars::json_schema!({"description": "An inequality of impulses or forces that is zero.", "oneOf": known})
    }
}

fn yes() -> bool {
    true
}

impl Outcome {
    /// v after the impact, in the order of q \[m/s, rad/s\]; empty without a robot.
    pub fn velocity(&self) -> impl Iterator<Item = f64> {
        let parts = [&self.base_velocity_after, &self.joint_velocity_after];
        parts.into_iter().flatten().flat_map(|part| part.values().iter().copied())
    }
}

/// Impulses and velocities of a combination, [tangential, normal] per contact.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Motion {
    /// Contact impulses \[N s\].
    pub impulse: Vec<Pair<f64>>,
    /// Contact velocities after the impact \[m/s\].
    pub velocity_after: Vec<Pair<f64>>,
}

impl Motion {
    /// Replaces negative zeros by positive ones, since a printed "-0" would be unexpected.
    pub(super) fn unsigned(mut self) -> Self {
        let entries = self.impulse.iter_mut().chain(&mut self.velocity_after).flatten();
        // -0 + 0 is +0.
        entries.for_each(|entry| *entry += 0.0);
        self
    }

    /// Whether every number is finite.
    pub(super) fn is_finite(&self) -> bool {
        self.impulse.iter().chain(&self.velocity_after).flatten().all(|entry| entry.is_finite())
    }
}

/// A combination of modes that is not an outcome, with its reason; [`Analysis`] has an example.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Rejection {
    /// One mode per contact.
    pub modes: Vec<Mode>,
    /// Why the combination is not an outcome.
    pub because: RejectionReason,
    /// The smallest slack, free of units: negative, or zero on a border. `None` if no solution gives one.
    pub margin: Option<f64>,
    /// The impulses that the combination would need, with the velocities that they cause; `None` if there is no
    /// solution.
    pub motion: Option<Motion>,
}

impl Rejection {
    /// A rejection without margin and motion.
    pub(super) fn of(modes: &[Mode], because: RejectionReason) -> Self {
        Self { modes: modes.to_vec(), because, margin: None, motion: None }
    }

    /// Marks the reason as provisional: more digits may find another one. A NaN margin is the mark.
    pub(super) fn provisional(self) -> Self {
        Self { margin: Some(f64::NAN), ..self }
    }
}

/// The number of combinations that an undecided problem leaves open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "Open")]
#[non_exhaustive]
pub struct OpenCombinations {
    /// How many combinations of modes there are: 4^n for n contacts.
    pub combinations: u64,
    /// How many of these are neither shown nor excluded. Up to 100 of them are listed, with `decided` false.
    pub undecided: u64,
    /// Whether the budget of work was spent: a greater one may decide more.
    pub beyond_budget: bool,
}

/// Why a combination is not an outcome; `contact` counts from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
#[non_exhaustive]
pub enum RejectionReason {
    /// The inequality that is violated most clearly.
    Violated { contact: usize, inequality: Inequality },
    /// A frictionless contact would stick although it moves along the ground: no impulse can hold it.
    NothingHolds { contact: usize },
    /// The equations of the modes contradict each other (det A = 0).
    NoSolution,
    /// The velocity belongs to another combination, because contacts depend on each other (det A = 0).
    RedundantTwin,
    /// The velocity belongs to another combination: it is on the border between both.
    OnBorder,
}

impl RejectionReason {
    /// The reason as a clause, in which contacts have these names, such as `left_foot is pulled toward the ground`.
    pub fn describe(&self, names: &[String]) -> String {
        match *self {
            Self::Violated { contact, inequality } => inequality.violated_by(&names[contact]),
            Self::NothingHolds { contact } => format!("{} slides and has no friction to stop it", names[contact]),
            Self::NoSolution => "no solution".to_owned(),
            Self::RedundantTwin => "covered by a redundant twin".to_owned(),
            Self::OnBorder => "has the velocity of other modes, on their border".to_owned(),
        }
    }
}

/// beta, gamma and region of each contact while all others stick (paper, section 4).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Explained"))]
#[non_exhaustive]
pub struct Explanation {
    /// Angle of the impulse that a purely tangential velocity change needs, atan(M_nt / M_tt) \[rad\].
    pub beta: Vec<f64>,
    /// Angle of the reversed impulse that would stop the contact, atan2(X_n, X_t) \[rad\].
    pub gamma: Vec<f64>,
    /// The effect of infinite friction.
    pub region: Vec<ImpulseRegion>,
}

/// The paper's regions of the plane of gamma and beta, for infinite friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Region"))]
#[non_exhaustive]
pub enum ImpulseRegion {
    /// Lift-off.
    A,
    /// Slides, whatever the friction.
    B,
    /// Stays.
    C,
    /// Three outcomes are valid.
    E,
}

/// How many combinations each kind of numbers decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Effort {
    /// Decided in f64 with an error bound, or left undecided.
    pub bound: u64,
    /// Decided in balls around f64.
    pub ball: u64,
    /// Decided in balls around pairs of f64.
    pub double_double: u64,
    /// Decided with more digits than that.
    pub precise: u64,
}

impl Effort {
    /// The number of all combinations that were visited.
    pub fn combinations(self) -> u64 {
        self.bound + self.ball + self.double_double + self.precise
    }
}

/// The answer to a contact problem: its outcomes and what is known about it.
///
/// ```
/// use heelstrike::{ContactProblem, Friction, Mode, Verdict, analyze, impact::ListedRejections};
///
/// let delassus = vec![2.0, 1.0, 1.0, 2.0];
/// let problem = ContactProblem::new(delassus, vec![[0.5, -1.0]], vec![Friction::from(0.8)], vec![0.0])?;
/// let analysis = analyze(&problem, ListedRejections::Everything)?;
/// assert!(analysis.verdict == Verdict::Unique && analysis.proven);
/// assert!(analysis.outcomes[0].impulse[0][1] > 0.0 && analysis.outcomes[0].energy_loss > 0.0);
/// assert!(analysis.rejected.iter().any(|rejection| rejection.modes == [Mode::Separate]));
/// # Ok::<(), heelstrike::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Analysis {
    /// The answer in one word.
    pub verdict: Verdict,
    /// True if error bounds show the signs of every combination and the digits of every outcome.
    pub proven: bool,
    /// Every outcome; with [`Verdict::Undecided`] also up to 100 of the combinations that are not excluded.
    pub outcomes: Vec<Outcome>,
    /// How many combinations are open; only with [`Verdict::Undecided`].
    pub open: Option<OpenCombinations>,
    /// The families: combinations with more than one velocity, all of which are outcomes. `outcomes` has their corners.
    pub families: Vec<Family>,
    /// The rejected combinations, if requested. For many contacts, only those that a search does not exclude.
    pub rejected: Vec<Rejection>,
    /// The number of rejected combinations that were requested but are not listed.
    pub unlisted: u64,
    /// The sum of the outcomes' indices; `None` if an outcome has no index.
    pub index_sum: Option<i32>,
    /// The rank of the Delassus matrix; `None` if it was not requested or if no precision within the budget shows it.
    pub rank: Option<usize>,
    /// The condition number of the Delassus matrix scaled to a unit diagonal; `None` if it is singular or not known.
    pub condition: Option<f64>,
    /// Whether some outcome has no sliding contact; `None` if that depends on an undecided combination.
    pub no_slip_consistent: Option<bool>,
    /// How many combinations each kind of numbers decided.
    pub effort: Effort,
    /// beta, gamma and region of each contact, if requested; `None` if the Delassus matrix is singular.
    pub explanation: Option<Explanation>,
}

impl Analysis {
    /// The combinations of all decided outcomes and all families, sorted and without duplicates.
    pub fn modes(&self) -> Vec<Vec<Mode>> {
        let decided = self.outcomes.iter().filter(|outcome| outcome.decided).map(|outcome| &outcome.modes);
        let mut modes: Vec<_> = decided.chain(self.families.iter().map(|family| &family.modes)).cloned().collect();
        modes.sort();
        modes.dedup();
        modes
    }

    /// Renames the inequalities to those of forces and accelerations, for sustained contact.
    pub(crate) fn of_forces(mut self) -> Self {
        let borders = self.outcomes.iter_mut().flat_map(|outcome| &mut outcome.border);
        for zero in borders.flat_map(|border| &mut border.at_zero) {
            zero.inequality = zero.inequality.of_forces();
        }
        for rejection in &mut self.rejected {
            if let RejectionReason::Violated { inequality, .. } = &mut rejection.because {
                *inequality = inequality.of_forces();
            }
        }
        self.explanation = None;
        // In sustained contact, an outcome without forces is an outcome like any other.
        if self.verdict == Verdict::NoImpact {
            self.verdict = Verdict::Unique;
        }
        self
    }

    /// A note if not all of the requested rejected combinations are listed.
    pub(crate) fn unlisted_note(&self) -> Option<String> {
        let (listed, others) = (self.rejected.len(), self.unlisted);
        (others > 0).then(|| {
            format!(
                "{listed} rejected combinations are listed; of {others} others a search shows that nothing leads there"
            )
        })
    }

    /// A note if an outcome gains energy, which Newton's restitution with Coulomb friction can cause.
    pub(super) fn energy_note(&self) -> Option<String> {
        let gains = self.outcomes.iter().filter(|outcome| outcome.energy_loss < 0.0).count();
        let total = self.outcomes.len();
        (gains > 0).then(|| {
            format!(
                "in {gains} of {total} outcomes the contacts add energy: Newton's restitution with Coulomb friction may, \
                 and a contact that works with an applied impulse"
            )
        })
    }
}
