//! The loops of a state: whether they close, which of their rows count, and the velocity that keeps them closed.

use super::Pipeline;
use crate::contact::Contact;
use crate::dynamics::{
    Closed, Constraints, Loop, close, eliminate_loops, independent_rows, kinetic_energy, loop_impulse, orthogonalize,
    point_velocity, spent_energy,
};
use crate::error::{Error, Reason, Result};
use crate::planar::{Vector, difference, dot};
use crate::robot::Robot;
use crate::scalar::Real;
use crate::scene::NamedLoop;
use crate::state::State;

/// How far apart the points of a loop may lie, as part of the robot's size: recorded poses are rounded, and simulators keep
/// their loops closed by springs.
const OPEN: f64 = 1e-4;
/// The greatest part of the kinetic energy that may lie in a motion that opens the loops: a hundredth of the speed.
const OPENING: f64 = 1e-4;
/// Below this part of the kinetic energy a motion that opens the loops is rounding, and not worth a word.
const ROUNDING: f64 = 1e-20;
/// A row of K of which less is left than this part of its points' squared motions follows from others, but for rounding.
const DEPENDENT: f64 = 1e-22;
/// A pose that leaves a loop open tells directions no better than some multiple of the gap.
const PER_GAP: f64 = 16.0;

/// The loops of one state in f64.
#[derive(Debug, Clone, Default)]
pub struct Loops {
    /// Their points.
    pub points: Vec<Loop>,
    /// The rows of their constraints that count, in the order in which every number eliminates them.
    pub rows: Vec<usize>,
}

impl NamedLoop {
    /// The loop for the dynamics, in numbers of any kind.
    pub(super) fn points<T: Real>(&self, robot: &Robot) -> Loop<T> {
        let ends = [self.a, self.b];
        Loop {
            bodies: ends.map(|end| robot.links[end.link].body),
            points: ends.map(|end| robot.links[end.link].point(end.offset)),
        }
    }

    /// As messages name it, with its number in the list.
    fn name(&self, index: usize, robot: &Robot) -> String {
        let [a, b] = [self.a, self.b].map(|end| &robot.links[end.link].name);
        format!("loops[{index}] ({a} - {b})")
    }
}

impl Pipeline<'_> {
    /// Finds which rows of the loops count, and closes them in `velocity`; a `foot` that rests keeps resting.
    ///
    /// # Errors
    /// [`Reason::Inconsistent`] for a loop that the pose or the velocity leaves open, with the gap.
    pub(super) fn close_loops(
        &mut self,
        state: &State,
        foot: Option<&Contact>,
        velocity: &mut [f64],
        notes: &mut Vec<String>,
    ) -> Result<Loops> {
        let (robot, named) = (self.robot, &state.scene.loops);
        let points: Vec<Loop> = named.iter().map(|own| own.points(robot)).collect();
        let tolerance = self.refuse_gaps(&points, named)?;
        let Self { plan, workspace, .. } = self;
        let rows = independent_rows(plan, &points, (&self.kept, velocity.len()), tolerance, workspace);
        notes.extend(named.iter().enumerate().filter_map(|(index, own)| {
            let left: Vec<&str> =
                [0, 1].into_iter().filter(|axis| !rows.contains(&(2 * index + axis))).map(|axis| ["x", "z"][axis]).collect();
            let left = left.join(" and ");
            let name = own.name(index, robot);
            (!left.is_empty()).then(|| {
                format!("{name} is already closed along {left} by what else holds its points: that is left out, its impulse is 0")
            })
        }));

        let foot = foot.map(|foot| foot.point_of(state.scene.ground()));
        let still = vec![0.0; velocity.len()];
        orthogonalize(plan, &points, (Constraints { kept: &self.kept, rows: &rows }, foot), &still, workspace);
        let energy = kinetic_energy(plan, velocity, workspace);
        let openings: Vec<f64> = points.iter().map(|own| speed(own.opening(plan, velocity, workspace))).collect();
        let amplitudes = close(plan, &points, Closed::Velocity, velocity, workspace);
        if let Some(foot) = foot {
            let moving = point_velocity(plan, foot.body, foot.arm(workspace), velocity, workspace);
            for (own, moving) in velocity.iter_mut().zip(moving) {
                *own -= moving;
            }
        }
        let spent = spent_energy(&amplitudes, workspace);
        let worst = (0..points.len()).reduce(|worst, next| if openings[next] > openings[worst] { next } else { worst });
        let Some(worst) = worst else { return Ok(Loops { points, rows }) };
        let (name, opening) = (named[worst].name(worst, robot), openings[worst]);
        if spent > OPENING * energy {
            return Err(moves_apart(&name, opening, worst));
        }
        // What was left out must hold all the same.
        for (index, own) in points
            .iter()
            .enumerate()
            .filter(|(index, _)| !rows.contains(&(2 * index)) || !rows.contains(&(2 * index + 1)))
        {
            let [a, b] = own.velocities(plan, velocity, workspace);
            let left = speed(difference(a, b));
            if left * left > OPENING * (dot(a, a) + dot(b, b)) {
                return Err(moves_apart(&named[index].name(index, robot), left, index));
            }
        }
        if spent > ROUNDING * energy {
            notes.push(format!(
                "{name} opens at {opening:.1e} m/s before the impact: the velocities are taken as the nearest ones, by kinetic \
                 energy, that keep every loop closed"
            ));
        }
        Ok(Loops { points, rows })
    }

    /// Refuses a loop whose points are apart; tells how large a row must be to count.
    fn refuse_gaps(&self, points: &[Loop], named: &[NamedLoop]) -> Result<f64> {
        let size = self.feet.size();
        let mut widest = 0.0_f64;
        for (index, (own, named)) in points.iter().zip(named).enumerate() {
            let gap = speed(own.gap(&self.plan, &self.workspace));
            if gap.is_nan() || gap > OPEN * size {
                let name = named.name(index, self.robot);
                let reason = format!("the pose leaves {name} open: its points are {gap:.6} m apart");
                let hint =
                    format!("the position must close every loop to {OPEN} of the robot's size ({:.1e} m)", OPEN * size);
                return Err(Error::new(Reason::Inconsistent(reason)).at(format!("loops[{index}]")).hint(hint));
            }
            widest = widest.max(gap);
        }
        let known = PER_GAP * widest / size;
        Ok(if widest > 0.0 { DEPENDENT.max(known * known) } else { DEPENDENT })
    }

    /// Prepares the constraints of a state without loops: the joints that keep their rates although they have columns.
    pub(super) fn keep_rates(&mut self) {
        if self.kept.is_empty() {
            return;
        }
        let Self { plan, workspace, .. } = self;
        let still = vec![0.0; self.robot.dofs()];
        orthogonalize(plan, &[], (Constraints { kept: &self.kept, rows: &[] }, None), &still, workspace);
    }

    /// Whether something beside the contacts gives impulses.
    pub(super) fn is_constrained(&self, loops: &Loops) -> bool {
        !(loops.points.is_empty() && self.kept.is_empty())
    }

    /// G without what the loops and the joints that keep their rates do not let move.
    pub(super) fn eliminate_loops(&mut self, loops: &Loops) {
        if self.is_constrained(loops) {
            eliminate_loops(&self.plan, &mut self.workspace);
        }
    }

    /// Adds to a `change` of velocity by impulses what the loops answer; gives their impulses, per loop on its point a.
    pub(super) fn answer_of_loops(&self, loops: &Loops, change: &mut [f64]) -> Vec<Vector<f64>> {
        if !self.is_constrained(loops) {
            return Vec::new();
        }
        let amplitudes = close(&self.plan, &loops.points, Closed::Change, change, &self.workspace);
        loop_impulse(loops.points.len(), &amplitudes, &self.workspace)
    }
}

fn speed([x, z]: Vector<f64>) -> f64 {
    libm::hypot(x, z)
}

fn moves_apart(name: &str, opening: f64, index: usize) -> Error {
    let reason = format!("the velocities open {name} at {opening:.3e} m/s");
    Error::new(Reason::Inconsistent(reason))
        .at(format!("loops[{index}]"))
        .hint("give rates of all joints of the loop, such that both points move alike")
}
