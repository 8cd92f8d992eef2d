//! One state end to end: the only place where all stages meet.
//!
//! ```text
//!     State --> posture --> kinematics --> stance, loops, contacts --> M, J, G --> ContactProblem --> Analysis --> Impact
//! ```

mod before;
mod left_out;
mod loops;
mod strike;
pub mod robust;

use self::before::Before;
pub use self::before::Unsolved;
pub use self::left_out::LeftOut;
use self::loops::Loops;
use self::robust::Robustness;
use self::strike::Strike;
use crate::contact::{Contact, Feet, Placement};
use crate::dynamics::plan::{Configuration, Plan};
use crate::dynamics::{
    Bounds, Constraints, ContactPoint, Workspace, add_articulated_impulse, add_impulse, articulated_inertias,
    contact_jacobian, delassus, factorize, kinematics, mass_matrix,
};
use crate::error::{Error, Reason, Result, finite};
use crate::impact::{Analysis, AnalysisOptions, ContactProblem, Errors, ListedRejections, Scratch};
use crate::law::{Friction, Mode};
use crate::planar::{Pair, Rotation, Vector};
use crate::reductions::Reductions;
use crate::robot::Robot;
use crate::state::State;
use crate::state::{NamedContact, Scene};

/// What the pipeline is asked for beside the outcomes.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// How far from the ground a foot may be and still touch \[m\]; by default [`CONTACT_TOLERANCE`] times the robot's size.
    pub contact_tolerance: Option<f64>,
    /// Contacts slower than this are taken as exactly at rest \[m/s\]; 0 snaps nothing.
    pub resting_speed: f64,
    /// Feet beside the robot's shapes, detected by their height like them.
    pub feet: Vec<NamedContact>,
    /// Up to how many contacts to list every rejected combination, and beta, gamma and the region of each contact.
    pub explain_up_to: usize,
    /// Keep the matrices.
    pub matrices: bool,
    /// Do without bounds of the rounding in M, J and c: faster, and nothing is proven.
    pub no_proof: bool,
    /// What of the computation is left out where a scene does not need it.
    pub reductions: Reductions,
}

/// The default contact tolerance, as part of the robot's size (see [`Feet::size`]).
pub const CONTACT_TOLERANCE: f64 = 1e-6;

/// The answer for one state.
#[derive(Debug, Clone)]
pub struct Impact {
    /// Where the bodies are.
    pub placement: Placement,
    /// The closed contacts, in the order of all lists per contact.
    pub contacts: Vec<Contact>,
    /// Contact velocities before the impact, [tangential, normal] \[m/s\].
    pub velocity_before: Vec<Pair<f64>>,
    /// Kinetic energy before the impact \[J\].
    pub kinetic_energy: f64,
    /// Every outcome and the verdict, or why the outcomes cannot be told.
    pub analysis: Result<Analysis>,
    /// v after each outcome of the analysis, in the order of q \[m/s, rad/s\].
    pub velocity_after: Vec<Vec<f64>>,
    /// Impulse on point a of each loop, in the world's axes, for each outcome of the analysis \[N s\]; on b the opposite acts.
    pub loop_impulse: Vec<Vec<Vector<f64>>>,
    /// Whether the outcomes are the same on the box of the state's uncertainty; none where it has none.
    pub holds: Option<Robustness>,
    /// The matrices, if asked for.
    pub matrices: Option<Matrices>,
    /// What of the scene does not enter the analysis.
    pub left_out: Vec<LeftOut>,
    /// What a reader should know, in whole sentences.
    pub notes: Vec<String>,
}

/// The answer for one state, and what of its contacts was taken as given.
struct Answer {
    impact: Impact,
    /// The foot of the stance.
    foot: Option<Contact>,
    /// Its place among the contacts.
    stance: Option<usize>,
    /// Contacts that were taken as exactly at rest.
    resting: Vec<bool>,
}

/// The matrices behind an answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrices {
    /// Names of the moving coordinates in the order of q: rows and columns of M, columns of J (held joints have none).
    pub coordinates: Vec<String>,
    /// M, one row per coordinate.
    pub mass_matrix: Vec<Vec<f64>>,
    /// J, two rows (tangential, normal) per contact, one column per coordinate.
    pub contact_jacobian: Vec<Vec<f64>>,
    /// G = J M^-1 J^T, two rows and columns per contact.
    pub delassus: Vec<Vec<f64>>,
}

/// Answers states of one robot, one after the other, in memory that it keeps.
#[derive(Debug)]
pub struct Pipeline<'r> {
    robot: &'r Robot,
    options: Options,
    feet: Feet,
    /// The plan of the last state, and what it was compiled for.
    plan: Plan,
    held: Vec<usize>,
    rotor_inertia: Vec<f64>,
    /// Coordinates of held joints that have a column all the same.
    kept: Vec<usize>,
    posture: Configuration,
    workspace: Workspace,
    bounds: Bounds,
    scratch: Scratch,
    points: Vec<ContactPoint>,
    column: Vec<f64>,
    motions: Vec<(f64, Vector<f64>)>,
}

impl<'r> Pipeline<'r> {
    /// A pipeline for states of `robot`.
    pub fn new(robot: &'r Robot, options: Options) -> Self {
        let feet = Feet::new(robot, &options.feet);
        Self {
            robot,
            feet: if options.reductions.reach { feet } else { feet.reaching_everywhere() },
            options,
            plan: Plan::new(robot, &[], &[]),
            held: Vec::new(),
            rotor_inertia: Vec::new(),
            kept: Vec::new(),
            posture: Configuration::default(),
            workspace: Workspace::default(),
            bounds: Bounds::default(),
            scratch: Scratch::default(),
            points: Vec::new(),
            column: Vec::new(),
            motions: Vec::new(),
        }
    }

    /// Every outcome of one state.
    ///
    /// # Errors
    /// [`Reason::Singular`] for a coordinate without inertia, [`Reason::Penetration`] for a foot deep in the ground,
    /// [`Reason::Inconsistent`] for a loop that the pose or the velocity leaves open,
    /// [`Reason::Missing`] for a contact without friction or a stance without a foot, [`Reason::MatricesTooLarge`] for
    /// hundreds of contacts, [`Reason::NotFinite`] for numbers whose products leave the range of f64.
    pub fn impact(&mut self, state: &State) -> Result<Impact> {
        let mut answer = self.answer(state, None)?;
        if let Some(uncertainty) = &state.uncertainty {
            answer.impact.holds = Some(self.robustness(state, uncertainty, &answer));
        }
        Ok(answer.impact)
    }

    /// As [`Pipeline::impact`], whatever the state's uncertainty is; of all rejected combinations those with `chosen` modes
    /// are listed.
    ///
    /// # Errors
    /// As [`Pipeline::impact`].
    pub fn impact_explaining(&mut self, state: &State, chosen: &[Vec<Mode>]) -> Result<Impact> {
        self.answer(state, Some(chosen)).map(|answer| answer.impact)
    }

    /// As [`Pipeline::impact`], whatever the state's uncertainty is; with `chosen` modes of rejected combinations, if they are.
    fn answer(&mut self, state: &State, chosen: Option<&[Vec<Mode>]>) -> Result<Answer> {
        let scene = &state.scene;
        let Before {
            placement,
            velocity,
            foot,
            loops,
            contacts,
            out_of_reach,
            stance,
            resting,
            kinetic_energy,
            change,
            applied,
            problem,
            mut notes,
        } = self.before(state)?;
        let free: Vec<f64> = velocity.iter().zip(&change).map(|(before, change)| before + change).collect();
        for &entry in &free {
            finite(entry, || "a velocity after the applied impulses".into())?;
        }
        let kept = self.kept.clone();
        let source = Strike {
            robot: self.robot,
            scene,
            position: &state.position,
            velocity: &velocity,
            foot: foot.as_ref(),
            stance,
            contacts: &contacts,
            resting: &resting,
            constraints: Constraints { kept: &kept, rows: &loops.rows },
            laws: problem.laws(),
            restitution: problem.restitution(),
            errors: Errors { delassus: self.bounds.delassus, velocity: Some(&self.bounds.velocity) },
        };
        let explain = contacts.len() <= self.options.explain_up_to && !contacts.is_empty();
        let Options { no_proof, reductions, .. } = self.options;
        let rejections = chosen.map_or(explain.into(), ListedRejections::Only);
        let asked = AnalysisOptions { rejections, prove: !no_proof, reductions };
        let analysis = self.scratch.analyse(&problem, &source, asked);
        let outcomes = analysis.as_ref().map_or(&[][..], |analysis| &analysis.outcomes);
        if !self.plan.has_mimics && outcomes.iter().any(|outcome| !outcome.impulse.is_empty()) {
            articulated_inertias(&self.plan, &mut self.workspace);
        }
        let (velocity_after, loop_impulse) = outcomes
            .iter()
            .map(|outcome| match self.is_constrained(&loops) {
                false => (self.struck(&free, &outcome.impulse), Vec::new()),
                true => {
                    let mut change = self.struck(&applied, &outcome.impulse);
                    let impulse = self.answer_of_loops(&loops, &mut change);
                    (velocity.iter().zip(&change).map(|(before, change)| before + change).collect(), impulse)
                }
            })
            .unzip();
        notes.extend(analysis.as_ref().ok().and_then(Analysis::energy_note));
        let impact = Impact {
            velocity_before: problem.velocity_before().to_vec(),
            kinetic_energy,
            velocity_after,
            loop_impulse,
            matrices: self.options.matrices.then(|| self.matrices()),
            holds: None,
            left_out: self.left_out(scene, &contacts, problem.laws(), out_of_reach),
            analysis,
            placement,
            contacts,
            notes,
        };
        Ok(Answer { impact, foot, stance, resting })
    }

    /// The contact problem of contacts given by hand, at a posture whose cosines and sines the caller knows better than
    /// their angle tells; `velocity` is dq/dt by coordinate. Level ground, restitution and friction per contact.
    ///
    /// # Errors
    /// [`Reason::Singular`] for a coordinate without inertia, and lengths that do not fit.
    pub fn contact_problem(
        &mut self,
        posture: &Configuration,
        velocity: &[f64],
        contacts: &[NamedContact],
        friction: Vec<Friction>,
        restitution: Vec<f64>,
    ) -> Result<ContactProblem> {
        let dofs = self.robot.dofs();
        let places = dofs + self.robot.mimic_joints.len();
        let lengths = [posture.cos.len(), posture.sin.len(), posture.displacement.len()].map(|length| (length, places));
        for (length, wanted) in lengths.into_iter().chain([(velocity.len(), dofs)]) {
            if length != wanted {
                let reason =
                    Reason::Inconsistent(format!("the robot has {dofs} coordinates, but {length} values are given"));
                let hint = "velocity has an entry per coordinate of q, posture these and one per follower";
                return Err(Error::new(reason).hint(hint));
            }
        }
        self.compile(&Scene::default());
        kinematics(&self.plan, posture, &mut self.workspace);
        mass_matrix(&self.plan, &mut self.workspace);
        factorize(&self.plan, &mut self.workspace);
        self.check_inertia(false)?;
        self.points.clear();
        self.points.extend(contacts.iter().map(|contact| {
            let link = &self.robot.links[contact.link];
            ContactPoint {
                body: link.body,
                centre: link.point(contact.offset),
                radius: contact.radius,
                ground: Rotation::identity(),
            }
        }));
        contact_jacobian(&self.plan, &self.points, velocity, None, &mut self.workspace);
        delassus(&self.plan, &mut self.workspace);
        let before = self.workspace.contact_velocity.clone();
        ContactProblem::new(self.workspace.delassus.clone(), before, friction, restitution)
    }

    /// The velocity by coordinate after contact impulses, from the one without them: by articulated bodies, which keep
    /// thirteen digits and more in chains where M = L^T D L leaves eight, unless joints follow others.
    fn struck(&mut self, free: &[f64], impulse: &[Pair<f64>]) -> Vec<f64> {
        let mut after = free.to_vec();
        let Self { plan, workspace, points, column, motions, .. } = self;
        for (point, &[tangential, normal]) in points.iter().zip(impulse) {
            let axes = point.axes();
            let vector = axes[0] * tangential + axes[1] * normal;
            let at = (point.body, point.arm(workspace));
            if plan.has_mimics {
                add_impulse(plan, workspace, at, vector, column, &mut after);
            } else {
                add_articulated_impulse(plan, workspace, at, vector, (&mut *column, &mut *motions), &mut after);
            }
        }
        after
    }

    fn matrices(&self) -> Matrices {
        let nv = self.plan.columns();
        // Columns of the plan run outward from the root, the user's coordinates in the file's order.
        let mut order: Vec<usize> = (0..nv).collect();
        order.sort_by_key(|&column| self.plan.coordinates()[column]);
        let names: Vec<&str> = self.robot.coordinates().collect();
        let mass = &self.workspace.mass_matrix;
        let entry = |i: usize, j: usize| mass[i.max(j) * nv + i.min(j)];
        let rows = self.workspace.contact_velocity.len() * 2;
        Matrices {
            coordinates: order.iter().map(|&column| names[self.plan.coordinates()[column]].to_owned()).collect(),
            mass_matrix: order.iter().map(|&i| order.iter().map(|&j| entry(i, j)).collect()).collect(),
            contact_jacobian: (0..rows)
                .map(|row| order.iter().map(|&column| self.workspace.contact_jacobian[row * nv + column]).collect())
                .collect(),
            delassus: (0..rows).map(|row| self.workspace.delassus[row * rows..(row + 1) * rows].to_vec()).collect(),
        }
    }
}
