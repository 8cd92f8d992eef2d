//! Loops (pairs of points that stay together), eliminated before the contact problem, and braked joints that have a
//! column.
//!
//! ```text
//!     K v = 0,   K = J_a - J_b            M (v+ - v-) = J^T L + K^T l            W = K M^-1 K^T
//!     l = -W^-1 K M^-1 J^T L              G' = G - X^T W^-1 X,  X = K M^-1 J^T
//! ```
//!
//! W is never formed. The rows of K become columns of L^-T K^T (see [delassus](mod@super::delassus)) and are
//! orthogonalized one by one (modified Gram-Schmidt) in the inner product a.b = a^T D^-1 b. This gives K = C Z with C
//! unit lower triangular. Every contact row then loses its component along Z. So G' = Y'^T D^-1 Y' is semidefinite by
//! construction, and no difference of large matrices is formed. Pivoting in f64 finds the rows that depend on others;
//! all other number types use the same rows in the same order. A joint that keeps its rate although it has a column
//! (see [`Reductions::held`](crate::reductions::Reductions)) adds a row of the identity, ahead of the loops. Source:
//! Featherstone 2008, sections 8.1 and 8.5 (loop joints of two constraints each, KKT form). Cost: O(m nv depth + (m^2 +
//! m n) nv) for m loops.

use super::bias::point_drift;
use super::bounds::Reach;
use super::delassus::from_half;
use super::jacobian::{ContactPoint, point_velocity, walk};
use super::workspace::{LoopRows, Workspace};
use crate::dynamics::plan::Plan;
use crate::planar::Vector;
use crate::scalar::{Ordered, Real, Sign, dot, subtract};
use std::ops::Add;

/// Two material points a and b that stay together. The impulse of the loop acts on a, and its opposite on b.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loop<T = f64> {
    /// The bodies of a and b.
    pub bodies: [usize; 2],
    /// The points a and b in the frames of their bodies \[m\].
    pub points: [Vector<T>; 2],
}

/// The constraints that impulses must respect.
#[derive(Debug, Clone, Copy, Default)]
pub struct Constraints<'a> {
    /// Coordinates that have a column and keep their rates.
    pub kept: &'a [usize],
    /// The independent rows of K, numbered 2 loop + axis.
    pub rows: &'a [usize],
}

/// The kind of vector that [`close`] corrects.
#[derive(Debug, Clone, Copy)]
pub enum Closed<'a, T> {
    /// The velocity before the impact. A foot at rest that the constraints contain stays at rest in it.
    Velocity,
    /// A change of velocity caused by impulses.
    Change,
    /// The acceleration. kappa of each loop is the relative acceleration of its points while no coordinate accelerates
    /// \[m/s^2\].
    Acceleration(&'a [Vector<T>]),
}

impl<T: Real> Loop<T> {
    /// Returns the vectors from the bodies' origins to both points, in the world's axes \[m\].
    fn arms(&self, workspace: &Workspace<T>) -> [Vector<T>; 2] {
        [0, 1].map(|end| workspace.rotation[self.bodies[end]].apply(self.points[end]))
    }

    /// Returns the vector from b to a, which is the gap that the pose leaves in the loop \[m\].
    pub fn gap(&self, plan: &Plan<T>, workspace: &Workspace<T>) -> Vector<T> {
        let arms_to_points = self.arms(workspace);
        let [a, b] = [0, 1].map(|end| {
            // The root has no arm.
            let arms = plan.way_to_root(self.bodies[end]).filter(|(_, body)| body.parent.is_some());
            arms.map(|(index, _)| workspace.arm[index]).fold(arms_to_points[end], Vector::add)
        });
        a - b
    }

    /// Returns the velocity of a relative to b, which is K v, including the rates of braked joints \[m/s\].
    pub fn opening(&self, plan: &Plan<T>, velocity: &[T], workspace: &Workspace<T>) -> Vector<T> {
        let arms = self.arms(workspace);
        let [a, b] = [0, 1].map(|end| point_velocity(plan, self.bodies[end], arms[end], velocity, workspace));
        a - b
    }

    /// Returns kappa, the acceleration of a relative to b while no coordinate accelerates \[m/s^2\]. Requires the
    /// results of [`bias`](super::bias()).
    pub fn drift(&self, workspace: &Workspace<T>) -> Vector<T> {
        let arms = self.arms(workspace);
        let [a, b] = [0, 1].map(|end| point_drift(self.bodies[end], arms[end], workspace));
        a - b
    }

    /// Returns one row of K (nv).
    fn row(&self, plan: &Plan<T>, axis: usize, workspace: &Workspace<T>) -> Vec<T> {
        let (arms, still) = (self.arms(workspace), still(plan));
        let mut row = vec![T::zero(); plan.columns()];
        for (end, arm) in arms.into_iter().enumerate() {
            walk(plan, self.bodies[end], arm, &still, workspace, |column, unit| {
                let part = unit.components()[axis];
                row[column] = if end == 0 { row[column] + part } else { row[column] - part };
            });
        }
        row
    }
}

/// Chooses the independent rows of K, the most independent first, and returns each with its share. The share is the
/// squared length of the row without its component along the rows chosen before it, divided by the square of its reach.
/// The other rows have a share of at most `tolerance`.
///
/// `reaches` holds the reach of both ends of each loop. Each column is scaled by the greatest motion that it could give
/// to an end of any loop. This makes the choice independent of units, and entries that are zero up to the rounding of
/// the pose stay small. Motions that both ends share do not count, nor do `kept` columns. Masses do not count either:
/// what a loop holds depends on the geometry alone, and a light link would hide it.
pub fn independent_rows(
    plan: &Plan,
    loops: &[Loop],
    kept: &[usize],
    reaches: &[[Reach; 2]],
    tolerance: f64,
    workspace: &Workspace,
) -> Vec<(usize, f64)> {
    let reach = |ends: &[Reach; 2], column: usize| ends[0].columns[column].max(ends[1].columns[column]);
    let greatest: Vec<f64> = (0..plan.columns())
        .map(|column| match kept.contains(&plan.coordinates[column]) {
            true => 0.0,
            false => reaches.iter().fold(0.0, |most, ends| f64::max(most, reach(ends, column))),
        })
        .collect();
    let scaled = |(column, entry): (usize, f64)| if greatest[column] > 0.0 { entry / greatest[column] } else { 0.0 };
    let square = |row: &[f64]| dot(row, row);
    let mut rest: Vec<(usize, f64, Vec<f64>)> = (0..2 * loops.len())
        .map(|row| {
            let (entries, reaches) = (loops[row / 2].row(plan, row % 2, workspace), &reaches[row / 2]);
            let reach: Vec<f64> = (0..entries.len()).map(|column| scaled((column, reach(reaches, column)))).collect();
            (row, square(&reach), entries.into_iter().enumerate().map(scaled).collect())
        })
        .collect();
    let mut chosen = Vec::new();
    loop {
        // Of equal shares the first row is taken, so that the result is deterministic.
        let share = |reach: f64, left: &[f64]| if reach > 0.0 { square(left) / reach } else { 0.0 };
        let shares = rest.iter().enumerate().map(|(place, (_, reach, left))| (share(*reach, left), place));
        let best = shares.reduce(|best, next| if next.0 > best.0 { next } else { best });
        let Some((share, place)) = best.filter(|(share, _)| *share > tolerance) else { return chosen };
        let (row, _, entries) = rest.remove(place);
        for (_, _, left) in &mut rest {
            subtract_along(left, &entries);
        }
        chosen.push((row, share));
    }
}

/// Returns whether the loops are closed exactly, and all rows of K not in `constraints` depend exactly on those.
pub fn follow_exactly<T: Ordered>(
    plan: &Plan<T>,
    loops: &[Loop<T>],
    constraints: Constraints,
    workspace: &Workspace<T>,
) -> bool {
    let is_zero = |entry: &T| entry.sign() == Sign::Zero;
    let Constraints { kept, rows } = constraints;
    let row = |row: usize| {
        let mut all = loops[row / 2].row(plan, row % 2, workspace);
        for (entry, _) in all.iter_mut().zip(&plan.coordinates).filter(|(_, coordinate)| kept.contains(coordinate)) {
            *entry = T::zero();
        }
        all
    };
    let mut basis: Vec<Vec<T>> = Vec::new();
    let rest = |basis: &[Vec<T>], mut left: Vec<T>| {
        basis.iter().for_each(|entries| subtract_along(&mut left, entries));
        left
    };
    for &index in rows {
        let left = rest(&basis, row(index));
        basis.push(left);
    }
    let mut others = (0..2 * loops.len()).filter(|index| !rows.contains(index));
    loops.iter().all(|pair| pair.gap(plan, workspace).components().iter().all(is_zero))
        && others.all(|index| rest(&basis, row(index)).iter().all(is_zero))
}

/// Orthogonalizes the rows of the constraints. The rows of a `foot` come last; [`close`] keeps it at rest in the
/// velocity before the impact. Requires the factorized mass matrix.
pub fn orthogonalize<T: Real>(
    plan: &Plan<T>,
    loops: &[Loop<T>],
    constraints: Constraints,
    foot: Option<ContactPoint<T>>,
    workspace: &mut Workspace<T>,
) {
    let mut prepared = std::mem::take(&mut workspace.loops);
    let LoopRows { kept: coordinates, rows: order, basis, basis_by_d, squares, coupling } = &mut prepared;
    let Constraints { kept, rows } = constraints;
    let nv = plan.columns();
    kept.clone_into(coordinates);
    rows.clone_into(order);
    let one_at = |coordinate| move |&other: &usize| if other == coordinate { T::one() } else { T::zero() };
    let unit_row = |&coordinate: &usize| plan.coordinates.iter().map(one_at(coordinate)).collect();
    let mut all: Vec<Vec<T>> = kept.iter().map(unit_row).collect();
    all.extend(rows.iter().map(|row| loops[row / 2].row(plan, row % 2, workspace)));
    all.extend(foot.into_iter().flat_map(|foot| {
        let (arm, still, workspace) = (foot.arm(workspace), still(plan), &*workspace);
        foot.axes().map(|axis| {
            let mut row = vec![T::zero(); nv];
            walk(plan, foot.body, arm, &still, workspace, |column, unit| plan.bring(&mut row[column], axis.dot(unit)));
            row
        })
    }));
    let count = all.len();
    for list in [&mut *basis, &mut *basis_by_d, &mut *squares] {
        list.clear();
    }
    coupling.clear();
    coupling.resize(count * count, T::zero());
    for (i, mut y) in all.into_iter().enumerate() {
        workspace.factor.half_solve(plan, (0..nv).rev(), y.as_chunks_mut::<1>().0);
        for k in 0..i {
            let along = dot(&y, &basis_by_d[k * nv..(k + 1) * nv]) / squares[k];
            subtract(&mut y, &basis[k * nv..(k + 1) * nv], along);
            coupling[i * count + k] = along;
        }
        let y_by_d: Vec<T> = workspace.factor.divided(&y).collect();
        squares.push(dot(&y, &y_by_d));
        basis.extend(y);
        basis_by_d.extend(y_by_d);
    }
    workspace.loops = prepared;
}

/// Removes from Y, D^-1 Y and G the motions that the constraints do not allow: G becomes G'.
pub fn eliminate_loops<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    let nv = plan.columns();
    let Workspace { factor, half, half_by_d, loops, .. } = &mut *workspace;
    for y in half.chunks_exact_mut(nv.max(1)) {
        for k in 0..loops.kept.len() + loops.rows.len() {
            let (z, by_d) = (&loops.basis[k * nv..][..nv], &loops.basis_by_d[k * nv..][..nv]);
            for row in 0..2 {
                let along = y.iter().zip(by_d).fold(T::zero(), |sum, (y, &by_d)| sum + y[row] * by_d);
                let along = along / loops.squares[k];
                y.iter_mut().zip(z).for_each(|(y, &z)| y[row] = y[row] - along * z);
            }
        }
    }
    for (at, (by_d, y)) in half_by_d.iter_mut().zip(half).enumerate() {
        *by_d = y.map(|entry| entry / factor.pivot(at % nv));
    }
    from_half(workspace.contact_velocity.len(), workspace, |_, _| 0..nv);
}

/// Corrects `velocity` (dq/dt by coordinate) by the impulses that close the loops: v := v - M^-1 K^T W^-1 K v. `closed`
/// states whether it is a velocity, a change of velocity or an acceleration. Returns the amplitude of each constraint,
/// for [`loop_impulse`] and [`spent_energy`].
pub fn close<T: Real>(
    plan: &Plan<T>,
    loops: &[Loop<T>],
    closed: Closed<'_, T>,
    velocity: &mut [T],
    workspace: &Workspace<T>,
) -> Vec<T> {
    let LoopRows { kept, rows, basis_by_d, squares, coupling, .. } = &workspace.loops;
    let (nv, all) = (plan.columns(), squares.len());
    let is_velocity = matches!(closed, Closed::Velocity);
    let mut openings: Vec<Vector<T>> = loops.iter().map(|pair| pair.opening(plan, velocity, workspace)).collect();
    if let Closed::Acceleration(drifts) = closed {
        openings.iter_mut().zip(drifts).for_each(|(opening, &drift)| *opening += drift);
    }
    // The velocity before the impact may have any rate at a kept coordinate. Only there a foot is kept at rest.
    let used = if is_velocity { all } else { kept.len() + rows.len() };
    if used == 0 {
        // Without constraints, M may have no factor.
        return Vec::new();
    }
    let rate = |i: usize| match (kept.get(i), i.checked_sub(kept.len()).and_then(|row| rows.get(row))) {
        (Some(&coordinate), _) if !is_velocity => velocity[coordinate],
        (None, Some(row)) => openings[row / 2].components()[row % 2],
        _ => T::zero(),
    };
    let mut along: Vec<T> = Vec::with_capacity(used);
    for i in 0..used {
        along.push((0..i).fold(rate(i), |left, k| left - coupling[i * all + k] * along[k]));
    }
    let amplitudes: Vec<T> = along.iter().zip(squares).map(|(&along, &square)| along / square).collect();
    let mut change = vec![T::zero(); nv];
    for (k, &amplitude) in amplitudes.iter().enumerate() {
        subtract(&mut change, &basis_by_d[k * nv..(k + 1) * nv], amplitude);
    }
    workspace.factor.other_half_solve(plan, &mut change);
    for (&coordinate, &change) in plan.coordinates.iter().zip(&change) {
        velocity[coordinate] = match (kept.contains(&coordinate), is_velocity) {
            (false, _) => velocity[coordinate] + change,
            // A kept rate stays without rounding.
            (true, true) => velocity[coordinate],
            (true, false) => T::zero(),
        };
    }
    amplitudes
}

/// Returns the impulse on a of each loop in the world's axes \[N s\], from the amplitudes that [`close`] returned. It
/// is zero along rows that depend on others.
pub fn loop_impulse<T: Real>(loops: usize, amplitudes: &[T], workspace: &Workspace<T>) -> Vec<Vector<T>> {
    let LoopRows { kept, rows, squares, coupling, .. } = &workspace.loops;
    let mut impulse = vec![[T::zero(); 2]; loops];
    // Solves K^T l = -Z a with K = C Z, from the last row to the first.
    let mut solved = vec![T::zero(); rows.len()];
    for (index, row) in rows.iter().enumerate().rev() {
        let at = kept.len() + index;
        let later = (index + 1..rows.len())
            .fold(T::zero(), |sum, other| sum + coupling[(kept.len() + other) * squares.len() + at] * solved[other]);
        solved[index] = -amplitudes[at] - later;
        impulse[row / 2][row % 2] = solved[index];
    }
    impulse.into_iter().map(Vector::from).collect()
}

/// Returns the kinetic energy \[J\] of the part of the velocity that [`close`] removed.
pub fn spent_energy(amplitudes: &[f64], workspace: &Workspace) -> f64 {
    let terms = amplitudes.iter().zip(&workspace.loops.squares);
    0.5 * terms.map(|(amplitude, square)| amplitude * amplitude * square).sum::<f64>()
}

/// Zero velocity, for walks that use only the motions.
fn still<T: Real>(plan: &Plan<T>) -> Vec<T> {
    vec![T::zero(); plan.places]
}

/// Removes from `left` its component along `direction`.
fn subtract_along<T: Real>(left: &mut [T], direction: &[T]) {
    subtract(left, direction, dot(left, direction) / dot(direction, direction));
}
