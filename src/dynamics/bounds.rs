//! Error bounds of G and c in f64 against those of the exact state: the first layer of every proof.
//!
//! Let u be the unit roundoff, D the depth of the tree, nb its bodies, nv its columns. Higham 2002 is his *Accuracy and
//! Stability of Numerical Algorithms*.
//!
//! 1. *Kinematics.* Cosines and sines have errors of at most 4 u (see [`Ball`](crate::scalar::Ball)), and each product
//!    of rotations adds 3 u. After D joints the error of a rotation is at most 7 D u, and that of an arm is 7 D u times
//!    its length.
//! 2. *M and J.* Each entry is a sum of products of masses and arms over at most D levels and nb bodies. Let K_i be the
//!    inertia that column i would move if all arms were stretched: the entry with every term replaced by its magnitude.
//!    By Cauchy and Schwarz, |dM_ij| <= eta sqrt(K_i K_j) and |dJ_ri| <= eta A_ri, where A_ri is the stretched arm from
//!    joint i to the contact and eta = [`ENTRY`] (D + nb) u.
//! 3. *M = L^T D L* is the factorization of a matrix that differs from M by a further gamma sqrt(K_i K_j), with gamma =
//!    2 (nv + 2) u (Higham 2002, theorem 10.3). In the energy norm both errors of M together are eps = nv (eta + gamma)
//!    tau, where tau = sum K_i (M^-1)_ii bounds |S M^-1 S| for S = diag(sqrt K_i). So |dG_rs| <= eps / (1 - eps)
//!    sqrt(G_rr G_ss).
//! 4. *J*: in the energy norm a row has the length sqrt(G_rr). The error of J adds eta a_r with a_r = sum A_ri
//!    sqrt((M^-1)_ii), and the triangular solves add gamma sqrt(nv tau) sqrt(G_rr) (Higham 2002, theorem 8.5).
//! 5. A *mimic joint* rotates by up to three angles instead of one, and its displacement has further roundings: it
//!    counts as three levels. Its motion is multiplied by its rate. If a column moves several joints b, the triangle
//!    inequality of the energy norm gives sqrt(K_i) = sum |rate_b| sqrt(K_b), and A_ri is a sum of the same form.
//! 6. *Accelerations* a = M^-1 h, with loads h known to within dh. The computed a^ solves a system with a matrix that
//!    differs by at most 3 gamma sqrt(K_i K_j) (Higham 2002, theorem 10.4). So M (a^ - a) = r exactly, with |r_i| <=
//!    dh_i + (eta + 3 gamma) sqrt(K_i) sum sqrt(K_j) |a^_j|, and |J M^-1 r| <= sqrt(G_rr) sum |r_i| sqrt((M^-1)_ii) by
//!    the energy norm. J and sigma add eta times the magnitude of their terms ([`Magnitude`]). dh_i is eta times the
//!    magnitude of h_i, because no result takes more successive operations than an entry of M.
//! 7. (M^-1)_ii is itself computed by a triangular solve, so it may be too small by a factor (1 - gamma sqrt(nv
//!    tau))^2.
//!
//! 8. (M^-1)_ii = 1 / min v.M v over the v with v_i = 1, where v.M v is twice the kinetic energy. Without other bodies
//!    there is less of it, so two bodies that only a joint connects give an upper bound that holds in every pose.
//!    (M^-1)_ii is computed where that bound is too coarse.
//!
//! All bounds are doubled to cover the terms of second order. These are small, because a bound above one tenth counts
//! as unknown. The constants are generous. If a bound does not decide a sign, balls do.

use super::balance::{Balance, central_moment};
use super::jacobian::ContactPoint;
use super::ltl::LtlFactor;
use super::stretch::{Arm, LIKELY, SMALL, Stretched, UNIT_ROUNDOFF, stretch};
use super::workspace::Workspace;
use crate::dynamics::plan::{Configuration, JointMotion, Plan, PlanBody};
use crate::planar::{Inertia, Pair, Rotation, Vector};
use crate::scalar::{Magnitude, UNDERFLOW};

/// Roundings in an entry of M or J, per level and body. This is twice the number of step 2.
const ENTRY: f64 = 96.0;
/// The bound of G above which that of every pose gives way to that of the pose.
const COARSE: f64 = 1e-8;

/// Bounds on the motion of one end of a loop relative to the other, with every arm stretched.
#[derive(Debug, Clone, Default)]
pub struct Reach {
    /// Largest speed for a unit rate of each column \[m/s\].
    pub columns: Vec<f64>,
    /// Shortest arm about which a joint rotates the end \[m\]; infinite if no joint does.
    pub shortest: f64,
    /// The longest arm \[m\].
    pub longest: f64,
}

/// Error bounds of one state. The memory is reused.
#[derive(Debug, Clone, Default)]
pub struct RoundingBounds {
    /// Bound of an entry G_ij relative to sqrt(G_ii G_jj); infinite if unknown.
    pub delassus: f64,
    /// Bound of c, per contact \[m/s\].
    pub velocity: Vec<Pair<f64>>,
    /// Bound of the base velocity \[m/s\] if it is computed from a stance; else zero.
    pub base: f64,
    /// Fractions of the bounds of G and of c that the errors are likely to reach; see `LIKELY`.
    pub likely: [f64; 2],
    bodies: Vec<Stretched>,
    /// Largest number of roundings in an entry of M or J, relative to its stretched magnitude.
    roundings: f64,
    /// sqrt(K_i) per column.
    roots: Vec<f64>,
    contacts: Vec<Arm>,
    /// Upper bound on the sum of the magnitudes of the terms of J v per contact, including those of a stance's foot
    /// \[m/s\].
    terms: Vec<f64>,
    /// Upper bound on sqrt((M^-1)_ii) per column: of this state, and in every pose.
    ease: Vec<f64>,
    pub(super) greatest_ease: Vec<f64>,
    scratch: Vec<f64>,
    balance: Balance,
}

impl RoundingBounds {
    /// Computes the bounds of a configuration and of its contacts, which the other methods use. Every call on one value
    /// must have the same plan.
    pub fn stretch(&mut self, plan: &Plan, configuration: &Configuration, contacts: impl Iterator<Item = Arm>) {
        self.contacts.clear();
        self.contacts.extend(contacts);
        // Rotations change no length.
        if !self.bodies.is_empty() && !plan.has_slides {
            return;
        }
        stretch(plan, configuration, &mut self.bodies);
        self.measure_moments(plan);
        self.measure_greatest_ease(plan);
        let depth = self.bodies.iter().map(|body| body.depth).max().unwrap_or(0) + 1;
        // If columns are shared, an entry may have one term for every pair of a body and a level.
        let terms = if plan.has_mimics { (depth + 1) * (self.bodies.len() + 1) } else { depth + self.bodies.len() };
        self.roundings = ENTRY * terms as f64;
    }

    /// Bounds c = J v. With a `stance`, that foot determines the base velocity. Contacts that `rests` picks are still.
    pub fn velocities(&mut self, plan: &Plan, velocity: &[f64], stance: Option<Arm>, rests: impl Fn(usize) -> bool) {
        let roundings = self.roundings;
        let eta = roundings * UNIT_ROUNDOFF;
        // The bound of G counts every column, and it is doubled twice.
        self.likely = [LIKELY / (4.0 * plan.columns().max(1) as f64 * roundings), LIKELY / roundings];
        let base = stance.map_or(0.0, |foot| 2.0 * self.speed(plan, foot, velocity));
        self.base = eta * base;
        let mut terms = std::mem::take(&mut self.terms);
        terms.clear();
        terms.extend(self.contacts.iter().map(|&contact| self.speed(plan, contact, velocity) + base));
        self.velocity.clear();
        let bound = |(index, terms): (usize, &f64)| [if rests(index) { 0.0 } else { eta * terms }; 2];
        self.velocity.extend(terms.iter().enumerate().map(bound));
        self.terms = terms;
    }

    /// Returns the sum of the magnitudes of the terms of a contact's speed, plus twice that of a stance's foot \[m/s\].
    pub fn terms(&self, contact: usize) -> f64 {
        self.terms[contact]
    }

    /// Bounds an `acceleration` a by coordinate without contact forces, and c' = J a + sigma of the contacts. `loads`
    /// and `whole` are the magnitudes of h by column and of c'; h has `more` terms than that of a robot alone. The
    /// bounds are infinite unless [`RoundingBounds::delassus`] has bounded G for this state.
    pub fn accelerations(
        &self,
        plan: &Plan,
        acceleration: &[f64],
        workspace: &Workspace,
        (loads, more): (&[Magnitude], usize),
        whole: &[Pair<Magnitude>],
    ) -> (Vec<f64>, Vec<Pair<f64>>) {
        let eta = (self.roundings + 2.0 * more as f64) * UNIT_ROUNDOFF;
        let gamma = 2.0 * (plan.columns() + 2) as f64 * UNIT_ROUNDOFF;
        let columns = plan.coordinates.iter().zip(&self.roots);
        let pushed = columns.fold(0.0, |sum, (&coordinate, root)| sum + root * acceleration[coordinate].abs());
        let residuals = loads.iter().zip(self.roots.iter().zip(&self.ease));
        let energy = residuals.fold(0.0, |sum, (load, (root, ease))| {
            sum + ease * (eta * load.0 + (eta + 3.0 * gamma) * root * pushed + UNDERFLOW)
        });
        let rows = 2 * whole.len();
        let is_known = self.delassus.is_finite() && self.ease.len() == plan.columns();
        // A bound that is not finite bounds nothing.
        let doubled = |bound: f64| if is_known && bound.is_finite() { 2.0 * bound } else { f64::INFINITY };
        let of_row = |row: usize, Magnitude(terms): Magnitude| {
            doubled(workspace.delassus[row * rows + row].max(0.0).sqrt() * energy + eta * terms)
        };
        let mut by_coordinate = vec![if is_known { 0.0 } else { f64::INFINITY }; acceleration.len()];
        for (&coordinate, ease) in plan.coordinates.iter().zip(&self.ease) {
            by_coordinate[coordinate] = doubled(ease * energy);
        }
        let of_contact = |index: usize| [0, 1].map(|axis| of_row(2 * index + axis, whole[index][axis]));
        (by_coordinate, (0..whole.len()).map(of_contact).collect())
    }

    /// Sets the poses of `workspace` with every arm stretched, for computations of magnitudes.
    pub fn stretched_poses(&self, plan: &Plan<Magnitude>, workspace: &mut Workspace<Magnitude>) {
        let turned = Rotation { cos: Magnitude(1.0), sin: Magnitude(1.0) };
        let Workspace { rotation, arm, direction, .. } = workspace;
        rotation.clear();
        rotation.resize(plan.bodies.len(), turned);
        arm.clear();
        arm.extend(self.bodies.iter().map(|body| Vector::new(body.arm, body.arm).map(Magnitude)));
        direction.clear();
        direction.extend(plan.bodies.iter().map(|body| match body.motion {
            JointMotion::Prismatic { rate, .. } => turned.apply(rate),
            _ => Vector::zero(),
        }));
    }

    /// Returns the contacts as points with their arms stretched.
    pub fn stretched_points(&self) -> impl Iterator<Item = ContactPoint<Magnitude>> {
        let turned = Rotation { cos: Magnitude(1.0), sin: Magnitude(1.0) };
        self.contacts.iter().map(move |&Arm { body, length }| {
            let center = Vector::new(length, length).map(Magnitude);
            ContactPoint { body, center, radius: Magnitude(0.0), ground: turned }
        })
    }

    /// Returns the sum of the magnitudes of the terms of a contact's speed J v \[m/s\].
    pub fn speed(&self, plan: &Plan, contact: Arm, velocity: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.walk(plan, contact, |_, coordinate, arm| {
            if velocity[coordinate] != 0.0 {
                // A product that underflows has at most this error.
                sum += arm * velocity[coordinate].abs() + UNDERFLOW;
            }
        });
        sum
    }

    /// Returns the motion of `end` relative to body `other`: its columns are those of joints on the path from `end` to
    /// the root that are not on the path from `other`.
    pub fn reach(&self, plan: &Plan, end: Arm, other: usize) -> Reach {
        let mut reach = Reach { columns: vec![0.0; plan.columns()], shortest: f64::INFINITY, longest: end.length };
        for (index, body) in plan.way_beyond(end.body, other) {
            match (body.motion, body.column) {
                (JointMotion::Revolute { rate, .. }, Some(column)) => {
                    reach.columns[column] += reach.longest * rate.abs();
                    if reach.longest > 0.0 {
                        reach.shortest = reach.shortest.min(reach.longest);
                    }
                }
                (JointMotion::Prismatic { rate, .. }, Some(column)) => reach.columns[column] += rate.length(),
                _ => {}
            }
            reach.longest += self.bodies[index].arm;
        }
        reach
    }

    /// Computes sqrt(K) of each column from the stretched bodies.
    fn measure_moments(&mut self, plan: &Plan) {
        self.roots.clear();
        self.roots.resize(plan.columns(), 0.0);
        for (body, stretched) in plan.bodies.iter().zip(&self.bodies) {
            let Some(column) = body.column else { continue };
            let moment = match body.motion {
                JointMotion::Root => {
                    self.roots[..2].fill(stretched.mass.sqrt());
                    stretched.second
                }
                JointMotion::Revolute { rate, .. } => stretched.second * (rate * rate) + body.rotor,
                JointMotion::Prismatic { rate, .. } => stretched.mass * rate.dot(rate) + body.rotor,
                JointMotion::Fixed => continue,
            };
            self.roots[column] += moment.sqrt();
        }
    }

    /// Computes the upper bound on sqrt((M^-1)_ii) that holds in every pose; infinite for a prismatic joint without a
    /// rotor.
    fn measure_greatest_ease(&mut self, plan: &Plan) {
        // The least kinetic energy for a unit rate of each column, times two.
        let mut least = vec![0.0; plan.columns()];
        let central = |body: &PlanBody<f64>| central_moment(body).max(0.0);
        for body in &plan.bodies {
            let (own, Some(column)) = (central(body), body.column) else { continue };
            let twice = match body.motion {
                JointMotion::Root => {
                    let Inertia { mass, first, .. } = body.inertia;
                    let linear = mass * (own / (own + first.dot(first * (1.0 / mass))));
                    least[..2].fill(if linear > 0.0 { linear } else { 0.0 });
                    own
                }
                JointMotion::Revolute { rate, .. } => {
                    let parent = body.parent.map(|parent| &plan.bodies[parent]);
                    let parent = parent.filter(|parent| plan.floating || parent.parent.is_some());
                    // The two bodies turn about a common axis in opposite directions, as masses on a spring move.
                    let pair = parent.map_or(own, |parent| own * (central(parent) / (own + central(parent))));
                    if pair > 0.0 { pair * (rate * rate) + body.rotor } else { body.rotor }
                }
                JointMotion::Prismatic { .. } | JointMotion::Fixed => body.rotor,
            };
            least[column] = f64::max(least[column], twice);
        }
        self.greatest_ease.clear();
        self.greatest_ease.extend(least.into_iter().map(|least| (1.0 / least).sqrt()));
    }

    /// Bounds G. Requires the factorized mass matrix and the Delassus matrix.
    pub fn delassus(&mut self, plan: &Plan, workspace: &Workspace) {
        self.delassus = f64::INFINITY;
        self.ease.clone_from(&self.greatest_ease);
        if self.ease.iter().all(|ease| ease.is_finite()) {
            self.delassus = self.of_delassus(plan, workspace);
        }
        if self.delassus > COARSE {
            let Self { ease, scratch, .. } = self;
            scratch.resize(plan.columns(), 0.0);
            let columns = ease.iter_mut().enumerate();
            columns.for_each(|(column, ease)| *ease = squared_ease(plan, &workspace.factor, column, scratch).sqrt());
            self.delassus = self.of_delassus(plan, workspace);
        }
    }

    /// Returns the bound of G that follows from the current bounds on (M^-1)_ii.
    fn of_delassus(&self, plan: &Plan, workspace: &Workspace) -> f64 {
        let nv = plan.columns();
        let (eta, gamma) = (self.roundings * UNIT_ROUNDOFF, 2.0 * (nv + 2) as f64 * UNIT_ROUNDOFF);
        let tau = self.roots.iter().zip(&self.ease).fold(0.0, |tau, (root, ease)| tau + (root * ease) * (root * ease));
        let solve = gamma * (nv as f64 * tau).sqrt();
        let short = 1.0 - solve;
        let eps = nv as f64 * (eta + gamma) * tau / (short * short);
        let rows = 2 * self.contacts.len();
        let mut jacobian = 0.0_f64;
        for (index, &contact) in self.contacts.iter().enumerate() {
            let mut length = 0.0;
            self.walk(plan, contact, |column, _, arm| {
                if let Some(column) = column {
                    length += arm * self.ease[column];
                }
            });
            for row in [2 * index, 2 * index + 1] {
                let diagonal = workspace.delassus[row * rows + row];
                if length > 0.0 {
                    // If a row of G vanishes although its contact can move, there is no relative error bound.
                    jacobian = jacobian.max(eta * length / (short * diagonal.sqrt()));
                }
            }
        }
        let sum = eps + jacobian + solve + gamma;
        if sum < SMALL { 2.0 * (2.0 * eps + 2.0 * jacobian + 4.0 * solve + 2.0 * gamma) } else { f64::INFINITY }
    }

    /// Bounds G computed by articulated bodies. `points` are its contacts.
    pub fn articulated_delassus(&mut self, plan: &Plan, points: &[ContactPoint], workspace: &Workspace) {
        let [bound, likely] = self.balance.errors(plan, &self.bodies, (points, &self.contacts), workspace);
        self.delassus = bound;
        // This bound does not extend to accelerations.
        self.ease.clear();
        if bound > 0.0 && bound.is_finite() {
            self.likely[0] = likely / bound;
        }
    }

    /// Walks from a contact to the root. Reports each joint's column, coordinate, and stretched arm (1 for a prismatic
    /// joint) times the multiplier of a mimic joint.
    fn walk(&self, plan: &Plan, contact: Arm, mut visit: impl FnMut(Option<usize>, usize, f64)) {
        let mut arm = contact.length;
        for (index, body) in plan.way_to_root(contact.body) {
            match body.motion {
                JointMotion::Root => break,
                JointMotion::Revolute { rate, .. } => visit(body.column, body.coordinate, arm * rate.abs()),
                JointMotion::Prismatic { .. } => {
                    visit(body.column, body.coordinate, body.mimic.map_or(1.0, |mimic| mimic.multiplier.abs()));
                }
                JointMotion::Fixed => {}
            }
            arm += self.bodies[index].arm;
        }
        if plan.floating {
            for (coordinate, arm) in [1.0, 1.0, arm].into_iter().enumerate() {
                visit(Some(coordinate), coordinate, arm);
            }
        }
    }
}

/// Returns (M^-1)_ii of one column as |D^-1/2 L^-T e_i|^2. `y` is scratch with one entry per column.
fn squared_ease(plan: &Plan, factor: &LtlFactor, column: usize, y: &mut [f64]) -> f64 {
    // Entries outside of the branch of the column are zero. In `y` they are stale, and are not read.
    let (y, row) = (&mut y[..column], factor.row(column));
    plan.for_ancestors(column, |j| y[j] = -row[j]);
    let mut sum = 1.0 / factor.pivot(column);
    plan.for_ancestors(column, |i| {
        let (entry, y, row) = (y[i], &mut y[..i], factor.row(i));
        plan.for_ancestors(i, |j| y[j] -= row[j] * entry);
        sum += entry * entry / factor.pivot(i);
    });
    sum
}
