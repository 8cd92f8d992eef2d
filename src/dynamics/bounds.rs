//! How far G and c in f64 may be from those of the exact state: the first layer of every proof.
//!
//! With u the unit roundoff, D the depth of the tree, nb its bodies, nv its columns:
//!
//! 1. *Kinematics.* Cosines and sines are off by 4 u each (see [`Ball`](crate::scalar::Ball)), each product of
//!    rotations adds 3 u; so after D joints a rotation is off by at most 7 D u, and an arm by that part of its length.
//! 2. *M and J.* Each entry is a sum of products of masses and arms, collected over at most D levels and nb bodies.
//!    Replacing every term by its magnitude gives K_i, the moment that column i would have to move if all arms were
//!    stretched, and by Cauchy and Schwarz |dM_ij| <= eta sqrt(K_i K_j), |dJ_ri| <= eta A_ri with A_ri the stretched
//!    arm from joint i to the contact, and eta = [`ENTRY`] (D + nb) u.
//! 3. *M = L^T D L* is the factorization of a matrix that differs from M by gamma sqrt(K_i K_j) more, with gamma = 2
//!    (nv + 2) u (Higham 2002, theorem 10.3). In the energy norm that is eps = nv (eta + gamma) tau with tau = sum K_i
//!    (M^-1)_ii, which bounds |S M^-1 S| for S = diag(sqrt K_i). So |dG_rs| <= eps / (1 - eps) sqrt(G_rr G_ss).
//! 4. *J* adds eta a_r with a_r = sum A_ri sqrt((M^-1)_ii) to the length sqrt(G_rr) of its row in the energy norm, and
//!    the triangular solves add gamma sqrt(nv tau) of it (Higham 2002, theorem 8.5).
//! 5. A *mimic joint* turns by up to three angles instead of one and brings further roundings to its displacement: it
//!    counts for three levels. Its motion is multiplied by its rate, and where a column moves several joints b, the
//!    triangle inequality of the energy norm gives sqrt(K_i) = sum |rate_b| sqrt(K_b), and A_ri is a sum of the same
//!    form.
//! 6. *Accelerations* a = M^-1 h of loads known to dh. The solve is exact for a matrix off by 3 gamma sqrt(K_i K_j) at
//!    most (Higham 2002, theorem 10.4), so that exactly M (a^ - a) = r with |r_i| <= dh_i + (eta + 3 gamma) sqrt(K_i) sum
//!    sqrt(K_j) |a^_j|. In the energy norm J M^-1 r is at most sqrt(G_rr) sum |r_i| sqrt((M^-1)_ii). J and sigma add eta
//!    times the magnitude of their terms ([`Magnitude`]), and dh_i is eta times that of h_i: no result takes more
//!    operations one on top of the other than an entry of M.
//! 7. (M^-1)_ii is itself computed by a triangular solve, so it may be short by a factor (1 - gamma sqrt(nv tau))^2.
//!
//! Everything is doubled for the terms of second order, which are small because the bound counts as unknown beyond a
//! tenth. The constants are generous: a sign that falls within them is settled by balls.

use super::balance::Balance;
use super::jacobian::ContactPoint;
use super::ltl::LtlFactor;
use super::stretch::{Arm, LIKELY, SMALL, Stretched, UNIT_ROUNDOFF, stretch};
use super::workspace::Workspace;
use crate::dynamics::plan::{Configuration, JointMotion, Plan};
use crate::planar::{Pair, Rotation, Vector};
use crate::scalar::{Magnitude, UNDERFLOW};

/// Roundings in an entry of M or J, per level and body: twice those of step 2.
const ENTRY: f64 = 96.0;
/// What moves one end of a loop against the other, with every arm stretched.
#[derive(Debug, Clone, Default)]
pub struct Reach {
    /// Speed for a unit rate of each column \[m/s\].
    pub columns: Vec<f64>,
    /// The shortest arm by which a joint turns it \[m\]; infinite if none does.
    pub shortest: f64,
    /// The longest arm \[m\].
    pub longest: f64,
}

/// Error bounds of one state, in memory that is reused.
#[derive(Debug, Clone, Default)]
pub struct RoundingBounds {
    /// Of an entry G_ij, relative to sqrt(G_ii G_jj); infinite where nothing is known.
    pub delassus: f64,
    /// Of c, per contact \[m/s\].
    pub velocity: Vec<Pair<f64>>,
    /// Of the base's velocity, if a stance gives it \[m/s\]; else zero.
    pub base: f64,
    /// What part of the bounds of G and of c the errors are likely to reach; see `LIKELY`.
    pub likely: [f64; 2],
    bodies: Vec<Stretched>,
    /// How many roundings an entry of M or J may have, against its stretched magnitude.
    roundings: f64,
    /// sqrt(K_i) per column.
    roots: Vec<f64>,
    contacts: Vec<Arm>,
    /// The speed of each contact, and of the foot of a stance, if no two terms of J v canceled each other \[m/s\].
    terms: Vec<f64>,
    /// sqrt((M^-1)_ii) per column.
    ease: Vec<f64>,
    scratch: Vec<f64>,
    balance: Balance,
}

impl RoundingBounds {
    /// Takes the lengths of a configuration and of its contacts; the others read them. All have the same plan.
    pub fn stretch(&mut self, plan: &Plan, configuration: &Configuration, contacts: impl Iterator<Item = Arm>) {
        self.contacts.clear();
        self.contacts.extend(contacts);
        // Turns change no length.
        if !self.bodies.is_empty() && !plan.has_slides {
            return;
        }
        stretch(plan, configuration, &mut self.bodies);
        self.measure_moments(plan);
        let depth = self.bodies.iter().map(|body| body.depth).max().unwrap_or(0) + 1;
        // Where columns are shared, an entry may have a term for every body and every level.
        let terms = if plan.has_mimics { (depth + 1) * (self.bodies.len() + 1) } else { depth + self.bodies.len() };
        self.roundings = ENTRY * terms as f64;
    }

    /// Bounds c = J v. The foot of a `stance` gives the base's velocity; the contacts that `rests` names are at rest.
    pub fn velocities(&mut self, plan: &Plan, velocity: &[f64], stance: Option<Arm>, rests: impl Fn(usize) -> bool) {
        let roundings = self.roundings;
        let eta = roundings * UNIT_ROUNDOFF;
        // The bound of G counts every column, and doubles twice.
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

    /// What the terms of the speed of a contact and twice those of a stance's foot add up to \[m/s\].
    pub fn terms(&self, contact: usize) -> f64 {
        self.terms[contact]
    }

    /// Bounds an `acceleration` a by coordinate without contact forces, and c' = J a + sigma of the contacts, after
    /// [`RoundingBounds::delassus`]; infinite without it. Of the loads h by column and of c' the magnitudes are given; h
    /// has `more` terms than a robot alone.
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
        // What is not a number bounds nothing.
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

    /// The poses of a plan with every arm stretched, for computations of magnitudes.
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

    /// The contacts as points with their arms stretched.
    pub fn stretched_points(&self) -> impl Iterator<Item = ContactPoint<Magnitude>> {
        let turned = Rotation { cos: Magnitude(1.0), sin: Magnitude(1.0) };
        self.contacts.iter().map(move |&Arm { body, length }| {
            let center = Vector::new(length, length).map(Magnitude);
            ContactPoint { body, center, radius: Magnitude(0.0), ground: turned }
        })
    }

    /// The speed that a contact would have if no two terms of J v canceled each other \[m/s\].
    pub fn speed(&self, plan: &Plan, contact: Arm, velocity: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.walk(plan, contact, |_, coordinate, arm| {
            if velocity[coordinate] != 0.0 {
                // A product may underflow, and is off by that at most.
                sum += arm * velocity[coordinate].abs() + UNDERFLOW;
            }
        });
        sum
    }

    /// What moves `end` against a point of the body `other`: joints on its way to the root that are not on the other's.
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

    /// Takes the moments K of the stretched bodies.
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

    /// Bounds G, from the factorized mass matrix and the Delassus matrix.
    pub fn delassus(&mut self, plan: &Plan, workspace: &Workspace) {
        let nv = plan.columns();
        let (eta, gamma) = (self.roundings * UNIT_ROUNDOFF, 2.0 * (nv + 2) as f64 * UNIT_ROUNDOFF);
        self.scratch.resize(nv, 0.0);
        self.ease.clear();
        let scratch = &mut self.scratch;
        self.ease.extend((0..nv).map(|column| squared_ease(plan, &workspace.factor, column, scratch).sqrt()));
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
                let own = workspace.delassus[row * rows + row];
                if length > 0.0 {
                    // A row of G that vanishes although its contact can move is known to no relative error.
                    jacobian = jacobian.max(eta * length / (short * own.sqrt()));
                }
            }
        }
        let sum = eps + jacobian + solve + gamma;
        self.delassus =
            if sum < SMALL { 2.0 * (2.0 * eps + 2.0 * jacobian + 4.0 * solve + 2.0 * gamma) } else { f64::INFINITY };
    }

    /// Bounds G by articulated bodies, whose contacts are the `points`.
    pub fn articulated_delassus(&mut self, plan: &Plan, points: &[ContactPoint], workspace: &Workspace) {
        let [bound, likely] = self.balance.errors(plan, &self.bodies, (points, &self.contacts), workspace);
        self.delassus = bound;
        // They bound no accelerations.
        self.ease.clear();
        if bound > 0.0 && bound.is_finite() {
            self.likely[0] = likely / bound;
        }
    }

    /// Walks from a contact to the root and reports each joint's column, coordinate and stretched arm (1 of a slide),
    /// times its rate if it follows another.
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

/// (M^-1)_ii of one column: |D^-1/2 L^-T e_i|^2; `y` has an entry for each column and is scratch.
fn squared_ease(plan: &Plan, factor: &LtlFactor, column: usize, y: &mut [f64]) -> f64 {
    // Entries off the branch of the column are zero; those of `y` are stale, and not read.
    let (y, row) = (&mut y[..column], factor.row(column));
    plan.for_ancestors(column, |j| y[j] = -row[j]);
    let mut sum = 1.0 / factor.pivot(column);
    plan.for_ancestors(column, |i| {
        let (own, y, row) = (y[i], &mut y[..i], factor.row(i));
        plan.for_ancestors(i, |j| y[j] -= row[j] * own);
        sum += own * own / factor.pivot(i);
    });
    sum
}
