//! From a state to its contact problem in f64: what goes between the steps of the
//! [`Assembly`](super::assembly::Assembly).
//!
//! ```text
//!     State --plan, place, factorize--> stance, loops: v --contact--> points --> J, c, G --> bounds of their rounding
//!                                                              applied impulses --> c_free     --> ContactProblem
//! ```

use super::assembly::Assembly;
use super::exact::ExactState;
use super::{CONTACT_TOLERANCE, Pipeline};
use crate::contact::{Contact, Footing, Placement, Surface};
use crate::dynamics::plan::Plan;
use crate::dynamics::{Arm, Constraints, Workspace, kinetic_energy};
use crate::error::{Error, Reason, Result, finite};
use crate::impact::problem::check_matrix_size;
use crate::impact::{ContactProblem, Errors};
use crate::planar::{Pair, Vector};
use crate::robot::Robot;
use crate::state::{Ground, Scene, State, check_length};

/// A state's contact problem, not yet analysed.
#[derive(Debug, Clone)]
pub struct Unsolved {
    pub contacts: Vec<Contact>,
    pub problem: ContactProblem,
    /// How far each foot is from the ground \[m\]; empty if the state names its contacts.
    pub clearance: Vec<f64>,
}

/// A state that is ready to be analysed.
pub struct Prepared {
    pub placement: Placement,
    /// v just before the impact, with the stance and the loops kept \[m/s, rad/s\].
    pub velocity: Vec<f64>,
    /// The foot of the stance.
    pub foot: Option<Contact>,
    pub contacts: Vec<Contact>,
    /// Shapes that were too far from the ground to be asked.
    pub out_of_reach: usize,
    /// The place of the stance's foot among the contacts.
    pub stance: Option<usize>,
    /// Contacts that were taken as exactly at rest.
    pub resting: Vec<bool>,
    pub kinetic_energy: f64,
    /// What the applied impulses change in v, without and with what the loops answer.
    pub applied: Vec<f64>,
    pub change: Vec<f64>,
    pub problem: ContactProblem,
    pub notes: Vec<String>,
}

impl Prepared {
    /// The `state` that was prepared in this `assembly`, for numbers of any kind.
    pub fn exact<'a>(
        &'a self,
        robot: &'a Robot,
        state: &'a State,
        assembly: &'a Assembly,
        errors: Errors<'a>,
    ) -> ExactState<'a> {
        ExactState {
            robot,
            scene: &state.scene,
            position: &state.position,
            velocity: &self.velocity,
            foot: self.foot.as_ref(),
            stance: self.stance,
            contacts: &self.contacts,
            resting: &self.resting,
            constraints: Constraints { kept: &assembly.kept, rows: &assembly.rows },
            laws: self.problem.laws(),
            restitution: self.problem.restitution(),
            errors,
        }
    }
}

impl Pipeline<'_> {
    /// The `state` that was just `prepared`, for numbers of any kind.
    #[cfg(feature = "accuracy")]
    pub(crate) fn exact<'a>(&'a self, state: &'a State, prepared: &'a Prepared) -> ExactState<'a> {
        prepared.exact(self.robot, state, &self.assembly, Errors::UNKNOWN)
    }

    /// The contact problem of a state as f64 has it, without its analysis.
    ///
    /// # Errors
    /// As [`Pipeline::impact`].
    pub fn unsolved(&mut self, state: &State) -> Result<Unsolved> {
        let Prepared { placement, contacts, problem, .. } = self.prepare(state)?;
        let clearance = match state.scene.contacts {
            Some(_) => Vec::new(),
            None => {
                let surface = Surface::new(&state.scene.ground);
                self.feet.iter().map(|foot| surface.clearance(foot, &placement)).collect()
            }
        };
        Ok(Unsolved { contacts, problem, clearance })
    }

    /// Everything up to the contact problem.
    pub(crate) fn prepare(&mut self, state: &State) -> Result<Prepared> {
        let scene = &state.scene;
        self.check_lengths(state)?;
        self.compile(scene);
        self.assembly.configuration.set(&self.assembly.plan, &state.position);
        self.assembly.place();
        self.assembly.factorize();
        self.check_inertia(!scene.loops.is_empty())?;

        let mut notes = Vec::new();
        let surface = Surface::new(&scene.ground);
        let (base, mut velocity, foot) = self.stand(state, &surface)?;
        self.close_loops(&scene.loops, foot.as_ref(), &mut velocity, &mut notes)?;
        let placement = Placement::new(&self.assembly.plan, &self.assembly.workspace, base);
        let (contacts, out_of_reach) = self.contacts(scene, &self.footing(scene, &placement, &surface), &mut notes)?;
        check_matrix_size(contacts.len())?;
        let stance = foot.as_ref().and_then(|foot| place_of(foot, &contacts));
        self.assembly.points.clear();
        self.assembly.points.extend(contacts.iter().map(Contact::point_of));
        self.assembly.contact_jacobian(&velocity, stance);
        let resting = self.snap(&contacts, &mut notes);
        self.assembly.delassus();
        let kinetic_energy = self.energy_in_range(&state.velocity, &velocity)?;
        self.bound(&contacts, &velocity, foot.as_ref(), |contact| resting[contact] || stance == Some(contact));
        self.note_slow(&contacts, &mut notes);
        if !scene.impulses.is_empty() || (self.assembly.is_constrained() && !self.options.no_proof) {
            // They go through M^-1, whose rounding these bounds do not follow.
            self.bounds.delassus = f64::INFINITY;
            self.bounds.velocity.fill([f64::INFINITY; 2]);
        }

        let applied = self.assembly.applied(self.robot, scene, self.robot.dofs());
        let mut change = applied.clone();
        self.assembly.answer(&mut change);
        let problem = self.problem(scene, &contacts, &change)?;
        Ok(Prepared {
            placement,
            velocity,
            foot,
            contacts,
            out_of_reach,
            stance,
            resting,
            kinetic_energy,
            applied,
            change,
            problem,
            notes,
        })
    }

    /// Refuses a state whose lists are not as long as its robot has coordinates.
    fn check_lengths(&self, state: &State) -> Result<()> {
        let coordinates = self.robot.dofs();
        check_length("position", state.position.len(), coordinates)?;
        check_length("velocity", state.velocity.len(), coordinates)?;
        let joints = self.robot.joints.len() + self.robot.mimic_joints.len();
        check_length("rotor_inertia", joints.max(state.scene.rotor_inertia.len()), joints)
    }

    /// Compiles the plan, unless the last one was for the same held joints and rotors.
    pub(super) fn compile(&mut self, scene: &Scene) {
        if self.held != scene.held || self.rotor_inertia != scene.rotor_inertia {
            let (without, kept) = match self.options.reductions.held {
                true => (&scene.held[..], &[][..]),
                false => (&[][..], &scene.held[..]),
            };
            self.assembly.plan = Plan::new(self.robot, without, &scene.rotor_inertia);
            self.assembly.kept.clear();
            self.assembly.kept.extend(kept.iter().map(|joint| self.robot.base_dofs() + joint));
            self.held.clone_from(&scene.held);
            self.rotor_inertia.clone_from(&scene.rotor_inertia);
        }
    }

    /// Refuses a coordinate whose inertia is zero to rounding once all that it carries may move.
    pub(super) fn check_inertia(&self, has_loops: bool) -> Result<()> {
        let nv = self.assembly.plan.columns();
        for column in (0..nv).rev() {
            let Workspace { mass_matrix, factor, .. } = &self.assembly.workspace;
            let (whole, rest) = (mass_matrix[column * nv + column], factor.pivot(column));
            // Each of up to nv eliminations loses at most a few units in the last place of the whole.
            finite(whole, || "the mass matrix".into())?;
            if rest.is_nan() || rest <= 4.0 * nv as f64 * f64::EPSILON * whole {
                let coordinate = self.assembly.plan.coordinates()[column];
                let name = self.robot.coordinates().nth(coordinate).unwrap_or_default().to_owned();
                let is_joint = coordinate >= self.robot.base_dofs();
                let what = if is_joint { format!("joint \"{name}\"") } else { format!("the base along {name}") };
                return Err(Error::new(Reason::Singular(what)).hint(match (is_joint, has_loops) {
                    (true, false) => "name the joint in `held`, or give it a `rotor_inertia`",
                    (true, true) => {
                        "it needs inertia of its own, whatever the loops hold: give its links a mass or it a \
                         `rotor_inertia`, however small, or name it in `held`"
                    }
                    (false, _) => {
                        "in this pose the joints can follow it without moving any mass: bend or hold (`held`) one of \
                         them, or give it a `rotor_inertia`"
                    }
                }));
            }
        }
        Ok(())
    }

    /// The kinetic energy \[J\]; it and the Delassus matrix must be numbers, or no sign means anything. The refusal
    /// names the greatest of the velocities that were `given`.
    fn energy_in_range(&self, given: &[f64], velocity: &[f64]) -> Result<f64> {
        let too_large =
            |error: Error| error.hint("positions and velocities are too large for f64: are they in SI units?");
        for &entry in &self.assembly.workspace.delassus {
            finite(entry, || "an entry of the Delassus matrix".into()).map_err(too_large)?;
        }
        let energy = kinetic_energy(&self.assembly.plan, velocity, &self.assembly.workspace);
        finite(energy, || "the kinetic energy".into()).map_err(|error| {
            let named = self.robot.coordinates().zip(given).enumerate();
            let greatest = named.max_by(|(_, (_, a)), (_, (_, b))| a.abs().total_cmp(&b.abs()));
            let part = |at| if at < self.robot.base_dofs() { "base" } else { "joints" };
            let place = greatest.map(|(at, (name, _))| format!("velocity.{}.{name}", part(at)));
            place.into_iter().fold(too_large(error), Error::at)
        })
    }

    /// How far from the ground a foot may be and still touch \[m\].
    pub fn tolerance(&self) -> f64 {
        self.options.contact_tolerance.unwrap_or(CONTACT_TOLERANCE * self.feet.size())
    }

    /// The root's origin and the velocity by coordinate, with a stance such that its foot stands, and that foot.
    fn stand(&self, state: &State, surface: &Surface) -> Result<(Vector<f64>, Vec<f64>, Option<Contact>)> {
        let mut velocity = state.velocity.clone();
        if !self.assembly.plan.floating {
            return Ok((Vector::zero(), velocity, None));
        }
        let Some(link) = state.scene.stance else {
            return Ok((Vector::new(state.position[0], state.position[1]), velocity, None));
        };
        let placement = &Placement::new(&self.assembly.plan, &self.assembly.workspace, Vector::zero());
        let footing = self.footing(&state.scene, placement, surface);
        // A side is flat by the rounding of its corners, whatever the contact tolerance is.
        let stance = footing.stance(link, CONTACT_TOLERANCE * self.feet.size())?;
        self.assembly.rest(&stance.foot.point_of(), &mut velocity);
        Ok((stance.base, velocity, Some(stance.foot)))
    }

    fn footing<'a>(&'a self, scene: &'a Scene, placement: &'a Placement, surface: &'a Surface) -> Footing<'a> {
        Footing { robot: self.robot, feet: &self.feet, named: scene.contacts.as_deref(), placement, surface }
    }

    /// The closed contacts, and how many shapes were too far from the ground to be asked.
    fn contacts(&self, scene: &Scene, footing: &Footing, notes: &mut Vec<String>) -> Result<(Vec<Contact>, usize)> {
        let tolerance = self.tolerance();
        let contacts = footing.contacts(tolerance)?;
        for contact in &contacts {
            finite(contact.gap, || format!("the height of {}", contact.name))?;
        }
        if contacts.is_empty() && footing.named.is_none() {
            notes.push(match (footing.nearest(), &scene.ground) {
                (Some((link, height)), Ground::Slope(_)) => {
                    format!("nothing touches the ground: the lowest foot, {link}, is {height:?} m above it")
                }
                (Some((link, distance)), Ground::Profile(_)) => {
                    format!("nothing touches the ground: the nearest foot, {link}, is {distance:?} m away from it")
                }
                (None, _) => {
                    "the robot has no feet: name contact points by `contacts` in the state or by `feet`".into()
                }
            });
        }
        let mut out_of_reach = 0;
        if footing.named.is_none() {
            out_of_reach = footing.out_of_reach(tolerance);
            notes.extend(footing.left_behind(tolerance).into_iter().map(|(link, end)| {
                format!("{link} reaches beyond the end of the ground's profile at x = {end:?} m: there is no ground")
            }));
        }
        Ok((contacts, out_of_reach))
    }

    /// Takes contacts below the resting speed as exactly at rest; gives which.
    fn snap(&mut self, contacts: &[Contact], notes: &mut Vec<String>) -> Vec<bool> {
        let limit = self.options.resting_speed;
        let snapped = |(speed, Contact { name, .. }): (&mut Pair<f64>, &Contact)| {
            let slow = libm::hypot(speed[0], speed[1]);
            // A speed that is zero to rounding is one of them.
            let snapped = limit > 0.0 && slow < limit;
            if snapped && slow > 0.0 {
                *speed = [0.0; 2];
                notes.push(format!(
                    "{name} moves at {slow:.1e} m/s and is taken as exactly at rest (resting speed {limit} m/s); the \
                     velocities of base and joints are not changed for it"
                ));
            }
            snapped
        };
        self.assembly.workspace.contact_velocity.iter_mut().zip(contacts).map(snapped).collect()
    }

    /// Bounds the rounding of G and c; without proofs that of G is taken for what was measured.
    fn bound(&mut self, contacts: &[Contact], velocity: &[f64], foot: Option<&Contact>, rests: impl Fn(usize) -> bool) {
        let Self { robot, assembly: Assembly { plan, configuration, workspace, .. }, bounds, .. } = self;
        let arm = |contact: &Contact| Arm { body: contact.body, length: contact.stretch(robot) + contact.radius };
        bounds.stretch(plan, configuration, contacts.iter().map(arm));
        bounds.velocities(plan, velocity, foot.map(arm), rests);
        if self.options.no_proof {
            bounds.delassus = DYNAMICS_ROUNDING;
        } else {
            bounds.delassus(plan, workspace);
        }
    }

    /// Notes speeds that are no more than rounding.
    fn note_slow(&self, contacts: &[Contact], notes: &mut Vec<String>) {
        let speeds = self.assembly.workspace.contact_velocity.iter().zip(&self.bounds.velocity);
        for (Contact { name, .. }, (speed, noise)) in contacts.iter().zip(speeds) {
            let [slow, bound] = [speed, noise].map(|pair| libm::hypot(pair[0], pair[1]));
            if bound > 0.0 && slow <= bound {
                notes.push(format!(
                    "{name} moves at {slow:.1e} m/s, which is within the rounding of its velocity: if it is at rest, \
                     say so by `stance` or `resting_speed`"
                ));
            }
        }
    }

    fn problem(&self, scene: &Scene, contacts: &[Contact], change: &[f64]) -> Result<ContactProblem> {
        let friction = contacts.iter().map(|contact| {
            scene.friction.of(contact.link).ok_or_else(|| {
                let name = &self.robot.links[contact.link].name;
                Error::new(Reason::Missing(format!("the friction of link \"{name}\", which touches the ground,")))
                    .at("friction")
                    .hint("add \"friction\": 0.8 (or \"infinite\") to the state, or set `friction: 0.8` for all states")
            })
        });
        let friction = friction.collect::<Result<Vec<_>>>()?;
        let restitution = contacts.iter().map(|contact| scene.restitution.of(contact.link).unwrap_or(0.0)).collect();
        let before = self.assembly.workspace.contact_velocity.clone();
        let free = if scene.impulses.is_empty() { before.clone() } else { self.assembly.free(&before, change) };
        ContactProblem::checked(self.assembly.workspace.delassus.clone(), (before, free), (friction, restitution))
    }
}

/// What G of a robot loses to rounding, relative to its rows' own scale: measured below 3e-15 against 640 bits on
/// chains, straight legs and extreme mass ratios. It is no bound, and used only if none is asked for.
const DYNAMICS_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The contact of the foot that stands: the same circle with the same normal; a point rests whatever the normal is.
fn place_of(foot: &Contact, contacts: &[Contact]) -> Option<usize> {
    let same = |other: &Contact| {
        (foot.link, foot.body, foot.center, foot.radius) == (other.link, other.body, other.center, other.radius)
    };
    let at = |exactly: bool| {
        contacts.iter().position(|other| same(other) && (other.ground == foot.ground || !exactly && foot.radius == 0.0))
    };
    at(true).or_else(|| at(false))
}
