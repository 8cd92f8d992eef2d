//! One state end to end: the only place where all stages meet.
//!
//! ```text
//!     State --> posture --> kinematics --> stance, loops, contacts --> M, J, G --> ContactProblem --> Analysis --> Impact
//! ```

mod left_out;
mod loops;
mod strike;
mod uncertain;

pub use self::left_out::LeftOut;
use self::loops::Loops;
use self::strike::Strike;
use crate::contact::{self, Contact, Feet, Placement, Surface};
use crate::dynamics::{
    Arm, Bounds, Constraints, ContactPoint, Workspace, add_articulated_impulse, add_impulse, articulated_inertias,
    contact_jacobian, delassus, factorize, kinematics, kinetic_energy, mass_matrix, point_velocity,
};
use crate::error::{Error, Reason, Result, finite};
use crate::impact::problem::check_matrix_size;
use crate::impact::{Analysis, Asked, ContactProblem, Errors, Explain, Friction, Mode, Scratch};
use crate::plan::{Plan, Posture};
use crate::planar::{Rotation, Vector, dot, scaled, sum};
use crate::reductions::Reductions;
use crate::robot::Robot;
use crate::scene::{Ground, NamedContact, Scene};
use crate::state::State;
use crate::uncertain::Holds;

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
    pub velocity_before: Vec<Vector<f64>>,
    /// Kinetic energy before the impact \[J\].
    pub kinetic_energy: f64,
    /// Every outcome and the verdict, or why the outcomes cannot be told.
    pub analysis: Result<Analysis>,
    /// v after each outcome of the analysis, in the order of q \[m/s, rad/s\].
    pub velocity_after: Vec<Vec<f64>>,
    /// Impulse on point a of each loop, in the world's axes, for each outcome of the analysis \[N s\]; on b the opposite acts.
    pub loop_impulse: Vec<Vec<Vector<f64>>>,
    /// Whether the outcomes are the same on the box of the state's uncertainty; none where it has none.
    pub holds: Option<Holds>,
    /// The matrices, if asked for.
    pub matrices: Option<Matrices>,
    /// What of the scene does not enter the analysis.
    pub left_out: Vec<LeftOut>,
    /// What a reader should know, in whole sentences.
    pub notes: Vec<String>,
}

/// A state's contact problem, not yet analysed.
#[derive(Debug, Clone)]
pub struct Unsolved {
    /// The closed contacts.
    pub contacts: Vec<Contact>,
    /// Their problem, in f64.
    pub problem: ContactProblem,
    /// How far each foot is from the ground \[m\]; empty where the state names its contacts.
    pub clearance: Vec<f64>,
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

/// A state and its contact problem, not yet analysed.
struct Before {
    /// Where the bodies are.
    placement: Placement,
    /// v just before the impact, with the stance and the loops kept \[m/s, rad/s\].
    velocity: Vec<f64>,
    /// The foot of the stance.
    foot: Option<Contact>,
    loops: Loops,
    contacts: Vec<Contact>,
    /// Shapes that were too far from the ground to be asked.
    out_of_reach: usize,
    /// The place of the stance's foot among the contacts.
    stance: Option<usize>,
    /// Contacts that were taken as exactly at rest.
    resting: Vec<bool>,
    kinetic_energy: f64,
    /// What the applied impulses change in v, with and without the loops' answer.
    change: Vec<f64>,
    applied: Vec<f64>,
    problem: ContactProblem,
    notes: Vec<String>,
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
    posture: Posture,
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
            posture: Posture::default(),
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
            answer.impact.holds = Some(self.holds(state, uncertainty, &answer));
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
            friction: problem.friction(),
            restitution: problem.restitution(),
            errors: Errors { delassus: self.bounds.delassus, velocity: Some(&self.bounds.velocity) },
        };
        let explain = contacts.len() <= self.options.explain_up_to && !contacts.is_empty();
        let Options { no_proof, reductions, .. } = self.options;
        let explain = chosen.map_or(explain.into(), Explain::Only);
        let asked = Asked { explain, prove: !no_proof, reductions };
        let analysis = self.scratch.analyse(&problem, &source, asked);
        let outcomes = analysis.as_ref().map_or(&[][..], |analysis| &analysis.outcomes);
        if !self.plan.tied && outcomes.iter().any(|outcome| !outcome.impulse.is_empty()) {
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
            left_out: self.left_out(scene, &contacts, problem.friction(), out_of_reach),
            analysis,
            placement,
            contacts,
            notes,
        };
        Ok(Answer { impact, foot, stance, resting })
    }

    /// The contact problem of a state as f64 has it, without its analysis.
    ///
    /// # Errors
    /// As [`Pipeline::impact`].
    pub fn unsolved(&mut self, state: &State) -> Result<Unsolved> {
        let Before { placement, contacts, problem, .. } = self.before(state)?;
        let clearance = match state.scene.contacts {
            Some(_) => Vec::new(),
            None => contact::clearances(&self.feet, &placement, &Surface::new(&state.scene.ground)),
        };
        Ok(Unsolved { contacts, problem, clearance })
    }

    /// Everything up to the contact problem.
    fn before(&mut self, state: &State) -> Result<Before> {
        let scene = &state.scene;
        self.compile(scene);
        self.posture.set(&self.plan, &state.position);
        kinematics(&self.plan, &self.posture, &mut self.workspace);
        mass_matrix(&self.plan, &mut self.workspace);
        factorize(&self.plan, &mut self.workspace);
        self.check_inertia(!scene.loops.is_empty())?;

        let mut notes = Vec::new();
        let surface = Surface::new(&scene.ground);
        let (base, mut velocity, foot) = self.stand(state, &surface)?;
        let loops = match scene.loops.is_empty() {
            true => {
                self.keep_rates();
                Loops::default()
            }
            false => self.close_loops(state, foot.as_ref(), &mut velocity, &mut notes)?,
        };
        let placement = Placement::new(&self.plan, &self.workspace, base);
        let (contacts, out_of_reach) = self.contacts(scene, &placement, &surface, &mut notes)?;
        check_matrix_size(contacts.len())?;
        let stance = foot.as_ref().and_then(|foot| place_of(foot, &contacts));
        self.points.clear();
        self.points.extend(contacts.iter().map(Contact::point_of));
        contact_jacobian(&self.plan, &self.points, &velocity, stance, &mut self.workspace);
        let resting = self.snap(&contacts, &mut notes);
        delassus(&self.plan, &mut self.workspace);
        self.eliminate_loops(&loops);
        let kinetic_energy = self.energy_in_range(&state.velocity, &velocity)?;
        self.bound(&contacts, &velocity, foot.as_ref(), |contact| resting[contact] || stance == Some(contact));
        self.tell_of_slow(&contacts, &mut notes);
        if !scene.impulses.is_empty() || (self.is_constrained(&loops) && !self.options.no_proof) {
            // They go through M^-1, whose rounding these bounds do not follow.
            self.bounds.delassus = f64::INFINITY;
            self.bounds.velocity.fill([f64::INFINITY; 2]);
        }

        let mut change = self.applied(scene);
        let applied = change.clone();
        self.answer_of_loops(&loops, &mut change);
        let problem = self.problem(scene, &contacts, &change)?;
        Ok(Before {
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
            notes,
        })
    }

    /// The contact problem of contacts given by hand, at a posture whose cosines and sines the caller knows better than
    /// their angle tells; `velocity` is dq/dt by coordinate. Level ground, restitution and friction per contact.
    ///
    /// # Errors
    /// [`Reason::Singular`] for a coordinate without inertia, and lengths that do not fit.
    pub fn contact_problem(
        &mut self,
        posture: &Posture,
        velocity: &[f64],
        contacts: &[NamedContact],
        friction: Vec<Friction>,
        restitution: Vec<f64>,
    ) -> Result<ContactProblem> {
        let dofs = self.robot.dofs();
        let places = dofs + self.robot.followers.len();
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

    /// Compiles the plan, unless the last one was for the same held joints and rotors.
    fn compile(&mut self, scene: &Scene) {
        if self.held != scene.held || self.rotor_inertia != scene.rotor_inertia {
            let (without, kept) = match self.options.reductions.held {
                true => (&scene.held[..], &[][..]),
                false => (&[][..], &scene.held[..]),
            };
            self.plan = Plan::new(self.robot, without, &scene.rotor_inertia);
            self.kept.clear();
            self.kept.extend(kept.iter().map(|joint| self.robot.base_dofs() + joint));
            self.held.clone_from(&scene.held);
            self.rotor_inertia.clone_from(&scene.rotor_inertia);
        }
    }

    /// Refuses a coordinate whose inertia, once all that hangs on it may move, is zero to rounding.
    fn check_inertia(&self, has_loops: bool) -> Result<()> {
        let nv = self.plan.columns();
        for column in (0..nv).rev() {
            let (whole, rest) =
                (self.workspace.mass_matrix[column * nv + column], self.workspace.factor[column * nv + column]);
            // Each of up to nv eliminations loses at most a few units in the last place of the whole.
            finite(whole, || "the mass matrix".into())?;
            if rest.is_nan() || rest <= 4.0 * nv as f64 * f64::EPSILON * whole {
                let coordinate = self.plan.coordinates()[column];
                let name = self.robot.coordinates().nth(coordinate).unwrap_or_default().to_owned();
                let joint = coordinate >= self.robot.base_dofs();
                let (what, remedy) = if joint {
                    let remedy = if has_loops {
                        "it needs inertia of its own, whatever the loops hold: give its links a mass or it a `rotor_inertia`, \
                         however small, or name it in `held`"
                    } else {
                        "name the joint in `held`, or give it a `rotor_inertia`"
                    };
                    (format!("joint \"{name}\""), remedy)
                } else {
                    let remedy = "in this pose the joints can follow it without moving any mass: bend or hold (`held`) one of \
                                  them, or give it a `rotor_inertia`";
                    (format!("the base along {name}"), remedy)
                };
                return Err(Error::new(Reason::Singular(what)).hint(remedy));
            }
        }
        Ok(())
    }

    /// The kinetic energy \[J\]; it and the Delassus matrix must be numbers, or no sign means anything. The refusal names the
    /// greatest of the velocities that were `given`.
    fn energy_in_range(&self, given: &[f64], velocity: &[f64]) -> Result<f64> {
        let too_large =
            |error: Error| error.hint("positions and velocities are too large for f64: are they in SI units?");
        for &entry in &self.workspace.delassus {
            finite(entry, || "an entry of the Delassus matrix".into()).map_err(too_large)?;
        }
        let energy = kinetic_energy(&self.plan, velocity, &self.workspace);
        let greatest = || {
            let named = self.robot.coordinates().zip(given).enumerate();
            let greatest = named.max_by(|(_, (_, a)), (_, (_, b))| a.abs().total_cmp(&b.abs()));
            greatest.map(|(at, (name, _))| {
                let part = if at < self.robot.base_dofs() { "base" } else { "joints" };
                format!("velocity.{part}.{name}")
            })
        };
        finite(energy, || "the kinetic energy".into()).map_err(|error| match greatest() {
            Some(place) => too_large(error).at(place),
            None => too_large(error),
        })
    }

    /// How far from the ground a foot may be and still touch \[m\].
    pub fn tolerance(&self) -> f64 {
        self.options.contact_tolerance.unwrap_or(CONTACT_TOLERANCE * self.feet.size())
    }

    /// The root's origin and the velocity by coordinate; with a stance both are such that its foot stands, and the foot.
    fn stand(&self, state: &State, surface: &Surface) -> Result<(Vector<f64>, Vec<f64>, Option<Contact>)> {
        let mut velocity = state.velocity.clone();
        if !self.plan.floating {
            return Ok(([0.0; 2], velocity, None));
        }
        let Some(link) = state.scene.stance else {
            return Ok(([state.position[0], state.position[1]], velocity, None));
        };
        let at_zero = Placement::new(&self.plan, &self.workspace, [0.0; 2]);
        let named = state.scene.contacts.as_deref();
        // A side is flat by the rounding of its corners, whatever the contact tolerance is.
        let flat = CONTACT_TOLERANCE * self.feet.size();
        let stance = contact::stance(self.robot, &self.feet, named, link, (&at_zero, surface), flat)?;
        velocity[..2].fill(0.0);
        let arm = stance.foot.point_of().arm(&self.workspace);
        let moving = point_velocity(&self.plan, stance.foot.body, arm, &velocity, &self.workspace);
        velocity[..2].copy_from_slice(&moving.map(|entry| -entry));
        Ok((stance.base, velocity, Some(stance.foot)))
    }

    /// The closed contacts, and how many shapes were too far from the ground to be asked.
    fn contacts(
        &self,
        scene: &Scene,
        placement: &Placement,
        surface: &Surface,
        notes: &mut Vec<String>,
    ) -> Result<(Vec<Contact>, usize)> {
        let (named, tolerance) = (scene.contacts.as_deref(), self.tolerance());
        let contacts = contact::detect(self.robot, &self.feet, named, (placement, surface), tolerance)?;
        for contact in &contacts {
            finite(contact.gap, || format!("the height of {}", contact.name))?;
        }
        if contacts.is_empty() && named.is_none() {
            notes.push(match (contact::nearest(self.robot, &self.feet, placement, surface), &scene.ground) {
                (Some((link, height)), Ground::Slope(_)) => {
                    format!("nothing touches the ground: the lowest foot, {link}, is {height:?} m above it")
                }
                (Some((link, distance)), Ground::Profile(_)) => {
                    format!("nothing touches the ground: the nearest foot, {link}, is {distance:?} m away from it")
                }
                (None, _) => {
                    "the robot has no feet: name contact points by `contacts` in the state or by --contact".into()
                }
            });
        }
        let mut out_of_reach = 0;
        if named.is_none() {
            out_of_reach = contact::out_of_reach(&self.feet, placement, surface, tolerance);
            let ends = contact::left_behind(self.robot, &self.feet, placement, surface, tolerance);
            notes.extend(ends.into_iter().map(|(link, end)| {
                format!("{link} reaches beyond the end of the ground's profile at x = {end:?} m: there is no ground")
            }));
        }
        Ok((contacts, out_of_reach))
    }

    /// Takes slow contacts as resting where asked to, and tells which.
    fn snap(&mut self, contacts: &[Contact], notes: &mut Vec<String>) -> Vec<bool> {
        let limit = self.options.resting_speed;
        let speeds = self.workspace.contact_velocity.iter_mut().zip(contacts);
        speeds
            .map(|(speed, contact)| {
                let slow = libm::hypot(speed[0], speed[1]);
                // A speed that is zero but for its rounding is one of them.
                let snapped = limit > 0.0 && slow < limit;
                if snapped && slow > 0.0 {
                    *speed = [0.0; 2];
                    notes.push(format!(
                        "{} moves at {slow:.1e} m/s and is taken as exactly at rest (resting speed {limit} m/s); the \
                         velocities of base and joints are not changed for it",
                        contact.name
                    ));
                }
                snapped
            })
            .collect()
    }

    /// Bounds the rounding of G and c; without proofs that of G is taken for what was measured.
    fn bound(&mut self, contacts: &[Contact], velocity: &[f64], foot: Option<&Contact>, rests: impl Fn(usize) -> bool) {
        let Self { robot, plan, posture, bounds, workspace, .. } = self;
        let arm = |contact: &Contact| Arm { body: contact.body, length: contact.stretch(robot) + contact.radius };
        bounds.stretch(plan, posture, contacts.iter().map(arm));
        bounds.velocities(plan, velocity, foot.map(arm), rests);
        if self.options.no_proof {
            bounds.delassus = DYNAMICS_ROUNDING;
        } else {
            bounds.delassus(plan, workspace);
        }
    }

    /// Tells of speeds that are no more than rounding.
    fn tell_of_slow(&self, contacts: &[Contact], notes: &mut Vec<String>) {
        let speeds = self.workspace.contact_velocity.iter().zip(&self.bounds.velocity);
        for (contact, (speed, noise)) in contacts.iter().zip(speeds) {
            let slow = libm::hypot(speed[0], speed[1]);
            let bound = libm::hypot(noise[0], noise[1]);
            if bound > 0.0 && slow <= bound {
                notes.push(format!(
                    "{} moves at {slow:.1e} m/s, which is within the rounding of its velocity: if it is at rest, say so by \
                     `stance` or --resting-speed",
                    contact.name
                ));
            }
        }
    }

    /// What the applied impulses change in the velocity by coordinate.
    fn applied(&mut self, scene: &Scene) -> Vec<f64> {
        let mut change = vec![0.0; self.robot.dofs()];
        for applied in &scene.impulses {
            let link = &self.robot.links[applied.link];
            let arm = self.workspace.rotation[link.body].apply(link.point(applied.offset));
            let Self { plan, workspace, column, .. } = self;
            add_impulse(plan, workspace, (link.body, arm), applied.vector, column, &mut change);
        }
        change
    }

    /// The velocity by coordinate after contact impulses, from the one without them: by articulated bodies, which keep
    /// thirteen digits and more in chains where M = L^T D L leaves eight, unless joints follow others.
    fn struck(&mut self, free: &[f64], impulse: &[Vector<f64>]) -> Vec<f64> {
        let mut after = free.to_vec();
        let Self { plan, workspace, points, column, motions, .. } = self;
        for (point, &[tangential, normal]) in points.iter().zip(impulse) {
            let axes = point.axes();
            let vector = sum(scaled(tangential, axes[0]), scaled(normal, axes[1]));
            let at = (point.body, point.arm(workspace));
            if plan.tied {
                add_impulse(plan, workspace, at, vector, column, &mut after);
            } else {
                add_articulated_impulse(plan, workspace, at, vector, (&mut *column, &mut *motions), &mut after);
            }
        }
        after
    }

    fn problem(&mut self, scene: &Scene, contacts: &[Contact], change: &[f64]) -> Result<ContactProblem> {
        let mut friction = Vec::with_capacity(contacts.len());
        for contact in contacts {
            friction.push(scene.friction.of(contact.link).ok_or_else(|| {
                let name = &self.robot.links[contact.link].name;
                Error::new(Reason::Missing(format!("the friction of link \"{name}\", which touches the ground,")))
                    .at("friction")
                    .hint("add \"friction\": 0.8 to the state, or --friction 0.8 (or infinite)")
            })?);
        }
        let restitution = contacts.iter().map(|contact| scene.restitution.of(contact.link).unwrap_or(0.0)).collect();
        let before = self.workspace.contact_velocity.clone();
        let mut unbraked = before.clone();
        if !scene.impulses.is_empty() {
            // Only the change goes through J, so that a contact at rest before stays exactly so without an impulse.
            for (point, speed) in self.points.iter().zip(&mut unbraked) {
                let more = point_velocity(&self.plan, point.body, point.arm(&self.workspace), change, &self.workspace);
                *speed = sum(*speed, point.axes().map(|axis| dot(axis, more)));
            }
        }
        ContactProblem::checked(self.workspace.delassus.clone(), (before, unbraked), (friction, restitution))
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

/// What G of a robot loses to rounding, relative to its rows' own scale: measured below 3e-15 against 640 bits on chains,
/// straight legs and extreme mass ratios. No bound; it serves where none is asked for.
const DYNAMICS_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The contact of the foot that stands: the same circle with the same normal; a point rests whatever the normal is.
fn place_of(foot: &Contact, contacts: &[Contact]) -> Option<usize> {
    let same = |other: &Contact| {
        (foot.link, foot.body, foot.centre, foot.radius) == (other.link, other.body, other.centre, other.radius)
    };
    let at = |exactly: bool| {
        contacts.iter().position(|other| same(other) && (other.ground == foot.ground || !exactly && foot.radius == 0.0))
    };
    at(true).or_else(|| at(false))
}
