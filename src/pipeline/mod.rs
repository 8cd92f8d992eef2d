//! The computation for one state from end to end: the only module in which all stages meet.
//!
//! ```text
//!     State --> configuration --> stance, loops, contacts --> M, J, G --> ContactProblem --> Analysis --> Impact
//! ```

mod still;
pub(crate) mod assembly;
pub(crate) mod exact;
mod loops;
mod resting;
mod prepared;
mod notes;
mod unsolved;
mod response;
mod springs;
mod forces;
pub mod robust;

use self::assembly::Assembly;
use self::exact::{Asked, ExactState};
pub use self::forces::Sustained;
pub use self::notes::beyond_size;
pub use self::prepared::NearestFoot;
pub(crate) use self::prepared::Prepared;
use self::response::FreeMotion;
pub(crate) use self::resting::AT_REST;
pub use self::springs::{Driven, SpringForce, Unrealized};
pub use self::unsolved::{Touching, Unsolved};
use crate::budget::{Budget, is_spent, within};
use crate::contact::{Contact, Feet, Merged, Placement};
use crate::dynamics::plan::Plan;
use crate::dynamics::{Closed, RoundingBounds};
use crate::error::{Error, Result, finite, from_zero};
use crate::impact::{
    Analysis, AnalysisOptions, ContactProblem, Errors, ListedRejections, RECYCLED, Scratch, Verdict, too_many_contacts,
};
use crate::law::{Friction, Law, Mode};
use crate::planar::Pair;
use crate::reductions::Reductions;
use crate::robot::Robot;
use crate::scalar::Magnitude;
use crate::state::{NamedContact, Scene, State, check_contacts};
use serde::{Deserialize, Serialize};
use std::mem::replace;
use std::sync::Arc;

/// What is asked about a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "snake_case")]
pub enum Aspect {
    /// The impact: [`Pipeline::impact`].
    #[default]
    Impact,
    /// Sustained contact: [`Pipeline::forces`].
    Forces,
}

impl Aspect {
    pub(crate) fn is_impact(&self) -> bool {
        *self == Self::Impact
    }
}

/// Settings of a [`Pipeline`], which has an example.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// The question that [`Pipeline::answer`] answers.
    pub aspect: Aspect,
    /// Greatest height above the ground at which a foot still counts as touching \[m\]; by default
    /// [`CONTACT_TOLERANCE`] times the robot's size.
    pub contact_tolerance: Option<f64>,
    /// Contacts slower than this are taken as exactly at rest \[m/s\]; 0 turns this off. The default differs by
    /// contact: it is the bound of the rounding in J v. If rates and angles have 6 to 15 significant digits and the
    /// terms of J v cancel to a ten-thousandth, it also covers half a unit in their last places. Without this option a
    /// state with an uncertainty is used as given.
    pub resting_speed: Option<f64>,
    /// Whether to refuse states with joints outside the limits of the robot's file; by default they get a note.
    pub strict_limits: bool,
    /// Feet in addition to the robot's shapes. They, too, are detected by their height.
    pub feet: Vec<NamedContact>,
    /// Up to this many contacts, every rejected combination is listed, and beta, gamma and the region of each contact.
    pub explain_up_to: usize,
    /// Whether to keep the matrices ([`Impact::matrices`]).
    pub matrices: bool,
    /// Whether to compute a brief result: without velocities of base and joints, rank and condition of G, borders, the
    /// nearest foot, notes on it and on contacts at rest, and [`Impact::left_out`].
    pub brief: bool,
    /// Whether to compute the forces just after each outcome of an impact.
    pub next: bool,
    /// Whether to compute [`Impact::friction_needed`].
    pub friction_needed: bool,
    /// Whether to skip the bounds of the rounding in M, J and c. This is faster, and nothing is proven.
    pub no_proof: bool,
    /// Parts of the computation that are skipped if a scene does not need them.
    pub reductions: Reductions,
    /// The time limit per state; what is open at its end is undecided. Without a limit, a state with many nearly
    /// dependent contacts may take hours.
    pub budget: Option<Budget>,
}

impl Options {
    /// Refuses numbers that are not finite or negative, and feet of links that the robot does not have.
    fn check(&self, robot: &Robot) -> Result<()> {
        let number = |value: Option<f64>, what| from_zero(value.unwrap_or_default(), what);
        number(self.contact_tolerance, "the tolerance").map_err(|error| error.at("contact_tolerance"))?;
        number(self.resting_speed, "the speed").map_err(|error| error.at("resting_speed"))?;
        check_contacts(robot, "feet", &self.feet)
    }
}

/// The default contact tolerance, as a fraction of the robot's size (see [`Feet::size`]).
pub const CONTACT_TOLERANCE: f64 = 1e-6;

/// The note for a box whose check does not finish within the budget.
const UNKNOWN_IN_TIME: &str =
    "whether the verdict holds on the box of the uncertainty is not known within the budget of work (`budget`)";

/// The answer for one state: its impact or, if [`Impact::sustained`] is set, its forces. [`Pipeline`] has an example.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Impact {
    /// Where the bodies are in the world.
    pub placement: Placement,
    /// The closed contacts. All lists per contact have this order.
    pub contacts: Vec<Contact>,
    /// The lowest foot that does not touch; `None` if every foot touches or the result is brief.
    pub nearest: Option<NearestFoot>,
    /// Contact velocities before the impact, [tangential, normal] \[m/s\].
    pub velocity_before: Vec<Pair<f64>>,
    /// Kinetic energy before the impact \[J\].
    pub kinetic_energy: f64,
    /// The contact problem, in f64.
    pub problem: ContactProblem,
    /// Whether each contact was taken as exactly at rest because it is slow.
    pub resting: Vec<bool>,
    /// Index of the contact of the stance's foot; `None` without a stance or if its foot does not touch.
    pub stance: Option<usize>,
    /// Every outcome and the verdict; `None` if there are more contacts than are enumerated (see [`Impact::analyzed`]).
    pub analysis: Option<Analysis>,
    /// The friction with which no contact has to slide, if requested and if some contact slides in every outcome: the
    /// greatest |L_t| / L_n of the sticking contacts, infinite if one sticks without a normal impulse. Among several
    /// outcomes without sliding, it is that of the one that needs least. `None` if infinite friction gives none.
    pub friction_needed: Option<f64>,
    /// Whether some contact slides in every outcome however great friction is: [`Impact::friction_needed`] was
    /// requested and does not exist.
    pub slides_regardless: bool,
    /// Data of sustained contact; `None` for an impact.
    pub sustained: Option<Sustained>,
    /// Whether the outcomes are the same on the box of the state's uncertainty; `None` if the state has no uncertainty.
    pub holds: Option<robust::Robustness>,
    /// The matrices, if requested.
    pub matrices: Option<Matrices>,
    /// The parts of the scene that do not enter the analysis.
    pub left_out: Vec<LeftOut>,
    /// Notes for the reader, in whole sentences.
    pub notes: Vec<String>,
}

impl Impact {
    /// Returns every outcome and the verdict.
    ///
    /// # Errors
    /// Returns [`TooManyContacts`](crate::Reason::TooManyContacts) if there are more contacts than are enumerated.
    pub fn analyzed(&self) -> Result<&Analysis> {
        self.analysis.as_ref().ok_or_else(|| unlisted(self.contacts.len()))
    }

    /// Returns whether this is the answer for an impact or for forces.
    pub fn aspect(&self) -> Aspect {
        if self.sustained.is_some() { Aspect::Forces } else { Aspect::Impact }
    }

    /// Returns [`Impact::analyzed`] by value, and drops the rest of the answer.
    ///
    /// # Errors
    /// Returns the errors of [`Impact::analyzed`].
    pub fn into_analysis(self) -> Result<Analysis> {
        self.analysis.ok_or_else(|| unlisted(self.contacts.len()))
    }
}

/// The error for a state with more contacts than are enumerated.
fn unlisted(contacts: usize) -> Error {
    too_many_contacts(contacts).hint("name only the contacts that matter (`contacts`), or lower the contact tolerance")
}

/// A part of the analysis that this scene does not need. [`Robot`] lists the skipped parts of the URDF.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LeftOut {
    /// The column of a braked joint, which keeps its rate (an index into [`Robot::joints`](crate::Robot)).
    Column(usize),
    /// The number of collision shapes that are too high to reach the ground.
    OutOfReach(usize),
    /// The number of collision shapes that are not used because the state names its contacts.
    NotAsked(usize),
    /// Contact points of one body that lie between two others and were merged into these.
    Merged(Merged),
    /// The tangential impulses of these contacts, which have no friction.
    Tangential(Vec<usize>),
    /// The friction cones of these contacts, whose friction is infinite.
    Cone(Vec<usize>),
}

/// The answer for one state, with what robustness checks need.
struct Answer {
    impact: Box<Impact>,
    /// The prepared state behind the answer. Its own `impact` was exchanged for spare memory.
    prepared: Box<Prepared>,
    /// The independent rows of the loops.
    rows: Vec<usize>,
}

/// The matrices behind an answer.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Matrices {
    /// Names of the moving coordinates in the order of q: the rows and columns of M and the columns of J. Braked joints
    /// have none.
    pub coordinates: Vec<String>,
    /// M, one row per coordinate.
    pub mass_matrix: Vec<Vec<f64>>,
    /// J, two rows (tangential, normal) per contact, one column per coordinate.
    pub contact_jacobian: Vec<Vec<f64>>,
    /// G = J M^-1 J^T, two rows and columns per contact.
    pub delassus: Vec<Vec<f64>>,
}

/// Answers the states of one robot one after the other, and reuses its memory.
///
/// ```
/// # let urdf = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/minimalistic.urdf"));
/// use heelstrike::{Defaults, Options, Pipeline, Robot, State, Verdict};
///
/// let robot = Robot::from_urdf(urdf)?;
/// let mut pipeline = Pipeline::new(&robot, Options { explain_up_to: 2, ..Options::default() });
/// let text = r#"{"position": {"base": {"pitch": -1.4}, "joints": {"hip": -2.8}}, "velocity": {"base": {"pitch": -1}},
///                "stance": "left_leg", "friction": "infinite"}"#;
/// let impact = pipeline.impact(&State::from_json(text, &robot, &Defaults::default())?)?;
/// assert_eq!(impact.analyzed()?.verdict, Verdict::Ambiguous);
/// assert_eq!((&*impact.contacts[0].name, impact.contacts.len()), ("left_leg", 2));
/// # Ok::<(), heelstrike::Error>(())
/// ```
#[derive(Debug)]
pub struct Pipeline<'r> {
    robot: &'r Robot,
    options: Options,
    /// The error of refused options, which every answer then returns.
    refused: Option<Error>,
    /// Whether the next state has already passed [`State::check`].
    is_checked: bool,
    feet: Feet,
    /// Names of the base's coordinates, and names of the joints.
    names: [Arc<[String]>; 2],
    assembly: Assembly,
    /// The braked joints and rotor inertias for which the current plan was compiled.
    braked: Vec<usize>,
    rotor_inertia: Vec<f64>,
    bounds: RoundingBounds,
    /// Sums of the magnitudes of all terms in a state's accelerations, for their rounding bounds.
    stretched: Assembly<Magnitude>,
    scratch: Scratch,
    /// Memory for the next state and for the next answers.
    spare: Option<Box<Prepared>>,
    #[expect(clippy::vec_box, reason = "an answer is large, and moved as a box")]
    recycled: Vec<Box<Impact>>,
}

impl<'r> Pipeline<'r> {
    /// Creates a pipeline for states of `robot`. If the options have a number that is negative or not finite, or a foot
    /// on a link that the robot does not have, every answer is an error that names the option.
    pub fn new(robot: &'r Robot, options: Options) -> Self {
        let refused = options.check(robot).err();
        let feet = Feet::new(robot, &options.feet);
        // A tolerance that the user gives is applied exactly, without the allowance for uneven mesh soles.
        let feet = if options.contact_tolerance.is_none() { feet.uneven() } else { feet };
        let mut names = robot.coordinates().map(str::to_owned);
        Self {
            robot,
            refused,
            is_checked: false,
            feet: if options.reductions.reach { feet } else { feet.reaching_everywhere() },
            options,
            names: [names.by_ref().take(robot.base_dofs()).collect(), names.collect()],
            assembly: Assembly::new(Plan::new(robot, &[], &[])),
            braked: Vec::new(),
            rotor_inertia: Vec::new(),
            bounds: RoundingBounds::default(),
            stretched: Assembly::new(Plan::new(robot, &[], &[])),
            scratch: Scratch::default(),
            spare: None,
            recycled: Vec::new(),
        }
    }

    /// Computes every outcome of one state. The answer is boxed because it is large.
    ///
    /// # Errors
    /// Returns an error with one of these [`Reason`](crate::Reason)s: `Singular` if a coordinate has no inertia,
    /// `Penetration` if a foot is deep in the ground, `Inconsistent` if a joint is outside strict limits or the pose or
    /// velocity leaves a loop open, `Missing` if a contact has no friction or a stance has no foot, `MatricesTooLarge`
    /// for hundreds of contacts, and `NotFinite` if products of the given numbers leave the range of f64. A state built
    /// in code is refused for what JSON is refused for: `OutOfRange` or `NotFinite` for a number, `Inconsistent` for a
    /// list of another length, an unknown index or a base that is placed twice. The error's place is that of the JSON
    /// field.
    pub fn impact(&mut self, state: &State) -> Result<Box<Impact>> {
        within(self.options.budget, || {
            let mut answer = self.analyze_impact(state, None)?;
            if let Some(uncertainty) = &state.uncertainty {
                let holds = self.robustness(state, uncertainty, &answer);
                let impact = &mut answer.impact;
                let is_closed = impact.analysis.as_ref().is_some_and(|analysis| analysis.open.is_none());
                if matches!(holds, robust::Robustness::Unknown) && is_spent() && is_closed {
                    impact.notes.push(UNKNOWN_IN_TIME.to_owned());
                }
                impact.holds = Some(holds);
            }
            Ok(self.finished(answer))
        })
    }

    /// Computes the impact or the forces of one state, as [`Options::aspect`] selects.
    ///
    /// # Errors
    /// Returns the errors of [`Pipeline::impact`] and [`Pipeline::forces`].
    pub fn answer(&mut self, state: &State) -> Result<Box<Impact>> {
        match self.options.aspect {
            Aspect::Impact => self.impact(state),
            Aspect::Forces => self.forces(state),
        }
    }

    /// The same as [`Pipeline::answer`] for a state that passes [`State::check`], as its reader knows.
    #[cfg(feature = "columnar")]
    pub(crate) fn answer_checked(&mut self, state: &State) -> Result<Box<Impact>> {
        self.is_checked = true;
        let answer = self.answer(state);
        self.is_checked = false;
        answer
    }

    /// The same as [`Pipeline::answer`], but ignores the state's uncertainty and omits [`Impact::friction_needed`]. Of
    /// all rejected combinations it lists only those with the `chosen` modes.
    ///
    /// # Errors
    /// Returns the errors of [`Pipeline::answer`].
    pub fn answer_explaining(&mut self, state: &State, chosen: &[Vec<Mode>]) -> Result<Box<Impact>> {
        within(self.options.budget, || match self.options.aspect {
            Aspect::Impact => self.analyze_impact(state, Some(chosen)).map(|answer| self.finished(answer)),
            Aspect::Forces => self.sustained(state, Some(chosen)),
        })
    }

    /// The same as [`Pipeline::answer_explaining`] without chosen modes, in brief.
    pub(crate) fn outcomes(&mut self, state: &State) -> Result<Box<Impact>> {
        let brief = replace(&mut self.options.brief, true);
        let answer = self.answer_explaining(state, &[]);
        self.options.brief = brief;
        answer
    }

    /// As [`Pipeline::impact`]. If modes are `chosen`, only the rejected combinations with these modes are listed.
    fn analyze_impact(&mut self, state: &State, chosen: Option<&[Vec<Mode>]>) -> Result<Answer> {
        let scene = &state.scene;
        let mut prepared = self.prepare(state)?;
        let Prepared { velocity, applied, free, impact, .. } = &*prepared;
        let Impact { contacts, problem, .. } = &**impact;
        for &entry in free {
            finite(entry, || "a velocity after the applied impulses".into())?;
        }
        let RoundingBounds { delassus, velocity: of_velocity, likely, .. } = &self.bounds;
        let errors = Errors { delassus: *delassus, velocity: Some(of_velocity), likely: *likely };
        let source = prepared.exact(self.robot, state, &self.assembly, errors);
        let Options { brief, next, .. } = self.options;
        let next = next && chosen.is_none();
        let options = self.analysis_options(contacts.len(), chosen);
        // The only error of `analyze` is that there are too many contacts.
        let mut analysis = self.scratch.analyze(problem, &source, options).ok();
        let slides = |analysis: &Analysis| {
            let is_decided = matches!(analysis.verdict, Verdict::Unique | Verdict::Ambiguous);
            is_decided && analysis.no_slip_consistent == Some(false)
        };
        let (mut friction_needed, mut slides_regardless) = (None, false);
        if self.options.friction_needed && chosen.is_none() && analysis.as_ref().is_some_and(slides) {
            let rough = problem.under(Law::Unbounded);
            let source = ExactState { laws: rough.laws(), ..source };
            let options = AnalysisOptions { rejections: ListedRejections::Nothing, ..options };
            let found = self.scratch.friction_without_slip(&rough, &source, options);
            (friction_needed, slides_regardless) = (found.flatten(), found == Some(None));
        }
        if let Some(analysis) = analysis.as_mut().filter(|_| !brief || next) {
            let unstruck = FreeMotion { before: velocity, applied, free, errors: &[], closed: Closed::Change };
            self.respond(&mut analysis.outcomes, (state, &prepared, Asked::Impact), unstruck);
            analysis.proven &= analysis.outcomes.iter().all(|outcome| outcome.proven);
        }
        let left_out = if brief { Vec::new() } else { self.left_out(scene, &prepared) };
        let Impact { notes, problem, contacts, .. } = &mut *prepared.impact;
        if let Some(analysis) = &analysis {
            notes.extend(analysis.notes(problem, || self.robot.mass()));
            notes.extend(if brief { None } else { self.nearly_one(contacts, &analysis.outcomes) });
        }
        let matrices = self.options.matrices.then(|| self.matrices());
        let followed = analysis.as_mut().filter(|_| next).map(|analysis| self.follow(state, &prepared, analysis));
        prepared.impact.notes.extend(followed.into_iter().flatten());
        let mut impact = self.unanswered(&mut prepared);
        (impact.analysis, impact.friction_needed) = (analysis, friction_needed);
        impact.slides_regardless = slides_regardless;
        (impact.left_out, impact.matrices) = (left_out, matrices);
        Ok(Answer { impact, prepared, rows: self.assembly.rows.clone() })
    }

    /// The options for an analysis with this number of contacts. If modes are `chosen`, only the rejected combinations
    /// with these modes are listed.
    fn analysis_options<'a>(&self, contacts: usize, chosen: Option<&'a [Vec<Mode>]>) -> AnalysisOptions<'a> {
        let Options { explain_up_to, no_proof, brief, reductions, .. } = self.options;
        let explain = contacts > 0 && contacts <= explain_up_to;
        let rejections = chosen.map_or(explain.into(), ListedRejections::Only);
        AnalysisOptions { rejections, prove: !no_proof, brief, reductions }
    }

    /// Returns the impact, and keeps the memory of the prepared state for the next one.
    fn finished(&mut self, Answer { impact, prepared, .. }: Answer) -> Box<Impact> {
        self.spare = Some(prepared);
        impact
    }

    /// Moves the impact, still without its analysis, out of `prepared`, and leaves recycled memory in its place.
    fn unanswered(&mut self, prepared: &mut Prepared) -> Box<Impact> {
        replace(&mut prepared.impact, self.recycled.pop().unwrap_or_default())
    }

    /// Takes back the memory of an answer that is no longer needed. A brief answer to a state with up to three contacts
    /// that f64 decides completely then allocates nothing.
    pub fn recycle(&mut self, mut impact: Box<Impact>) {
        self.scratch.recycle(impact.analysis.take().map_or(Vec::new(), |analysis| analysis.outcomes));
        if self.recycled.len() < RECYCLED {
            self.recycled.push(impact);
        }
    }

    /// Lists the parts of the scene that were left out.
    fn left_out(&self, scene: &Scene, prepared: &Prepared) -> Vec<LeftOut> {
        let (laws, out_of_reach) = (prepared.impact.problem.laws(), prepared.out_of_reach);
        let mut all = Vec::new();
        if self.options.reductions.held {
            all.extend(scene.braked.iter().map(|&joint| LeftOut::Column(joint)));
        }
        let shapes = self.feet.iter().count();
        match scene.contacts {
            Some(_) if shapes > 0 => all.push(LeftOut::NotAsked(shapes)),
            None if out_of_reach > 0 => all.push(LeftOut::OutOfReach(out_of_reach)),
            _ => {}
        }
        all.extend(prepared.merged.iter().cloned().map(LeftOut::Merged));
        let with = |wanted: Law| (0..laws.len()).filter(|&at| laws[at] == wanted).collect::<Vec<_>>();
        let [none, infinite] = [Friction::ZERO, Friction::Infinite].map(|friction| with(friction.into()));
        if self.options.reductions.frictionless && !none.is_empty() {
            all.push(LeftOut::Tangential(none));
        }
        if !infinite.is_empty() {
            all.push(LeftOut::Cone(infinite));
        }
        all
    }

    fn matrices(&mut self) -> Matrices {
        self.assembly.take_mass_matrix();
        let Assembly { plan, workspace, .. } = &self.assembly;
        let (nv, rows) = (plan.columns(), 2 * workspace.contact_velocity.len());
        // The plan's columns run outward from the root; the user's coordinates are in the file's order.
        let mut order: Vec<usize> = (0..nv).collect();
        order.sort_by_key(|&column| plan.coordinates[column]);
        let names: Vec<&str> = self.robot.coordinates().collect();
        let mass = |i: usize, j: usize| workspace.mass_matrix[i.max(j) * nv + i.min(j)];
        let entry = |row: usize, column: usize| workspace.contact_jacobian[row / 2 * nv + column][row % 2];
        let jacobian = |row: usize| order.iter().map(|&column| entry(row, column)).collect();
        Matrices {
            coordinates: order.iter().map(|&column| names[plan.coordinates[column]].to_owned()).collect(),
            mass_matrix: order.iter().map(|&i| order.iter().map(|&j| mass(i, j)).collect()).collect(),
            contact_jacobian: (0..rows).map(jacobian).collect(),
            delassus: (0..rows).map(|row| workspace.delassus[row * rows..(row + 1) * rows].to_vec()).collect(),
        }
    }
}
