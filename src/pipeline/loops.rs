//! The loops of a state: whether they close, which of their rows count, and the velocity that keeps them closed.

use super::Pipeline;
use super::assembly::Assembly;
use crate::contact::Contact;
use crate::dynamics::{ContactPoint, Loop, independent_rows, kinetic_energy, point_velocity, spent_energy};
use crate::error::{Error, Reason, Result};
use crate::robot::Robot;
use crate::scalar::Real;
use crate::state::NamedLoop;

/// How far apart the points of a loop may lie, as part of the robot's size: recorded poses are rounded, and simulators
/// keep their loops closed by springs.
const OPEN: f64 = 1e-4;
/// The greatest part of the kinetic energy that may lie in a motion that opens the loops: a hundredth of the speed.
const OPENING: f64 = 1e-4;
/// Below this part of the kinetic energy a motion that opens the loops is rounding, and not worth a word.
const ROUNDING: f64 = 1e-20;
/// A row of K is taken to follow from others if less than this part of its points' squared motions is left.
const DEPENDENT: f64 = 1e-22;
/// A pose that leaves a loop open gives directions only to this multiple of the gap.
const PER_GAP: f64 = 16.0;

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
    /// Finds which rows of the loops count, and closes them in `velocity`; a `foot` that rests keeps resting. A loop
    /// that the pose or the velocity leaves open is refused, with the gap.
    pub(super) fn close_loops(
        &mut self,
        named: &[NamedLoop],
        foot: Option<&Contact>,
        velocity: &mut [f64],
        notes: &mut Vec<String>,
    ) -> Result<()> {
        self.assembly.loops.clear();
        self.assembly.rows.clear();
        if named.is_empty() {
            self.assembly.constrain(None);
            return Ok(());
        }
        let robot = self.robot;
        self.assembly.loops.extend(named.iter().map(|own| own.points(robot)));
        let tolerance = self.refuse_gaps(named)?;
        let Assembly { plan, loops, kept, workspace, .. } = &self.assembly;
        self.assembly.rows = independent_rows(plan, loops, kept, tolerance, workspace);
        // What follows from others is left out.
        for (index, own) in named.iter().enumerate().filter(|(index, _)| !self.is_whole(*index)) {
            let left = [(2 * index, "x"), (2 * index + 1, "z")];
            let left = left.into_iter().filter(|(row, _)| !self.assembly.rows.contains(row));
            let left: Vec<&str> = left.map(|(_, axis)| axis).collect();
            notes.push(format!(
                "{} is already closed along {} by what else holds its points: that is left out, its impulse is 0",
                own.name(index, robot),
                left.join(" and ")
            ));
        }
        notes.extend(self.close_velocity(named, foot.map(Contact::point_of), velocity)?);
        Ok(())
    }

    /// Whether both rows of a loop count.
    fn is_whole(&self, index: usize) -> bool {
        [2 * index, 2 * index + 1].iter().all(|row| self.assembly.rows.contains(row))
    }

    /// Closes the loops in `velocity`; gives a note if that changes it by more than rounding.
    fn close_velocity(
        &mut self,
        named: &[NamedLoop],
        foot: Option<ContactPoint>,
        velocity: &mut [f64],
    ) -> Result<Option<String>> {
        let robot = self.robot;
        let Assembly { plan, workspace, loops, .. } = &self.assembly;
        let energy = kinetic_energy(plan, velocity, workspace);
        let openings = loops.iter().map(|own| own.opening(plan, velocity, workspace).length());
        let widest = openings.zip(named).enumerate().reduce(|most, next| if next.1.0 > most.1.0 { next } else { most });
        let Some((worst, (opening, own))) = widest else { return Ok(None) };
        self.assembly.constrain(foot);
        let amplitudes = self.assembly.close(velocity);
        let Assembly { plan, workspace, loops, .. } = &self.assembly;
        if let Some(foot) = foot {
            let moving = point_velocity(plan, foot.body, foot.arm(workspace), velocity, workspace);
            for (own, moving) in velocity.iter_mut().zip(moving.components()) {
                *own -= moving;
            }
        }
        let spent = spent_energy(&amplitudes, workspace);
        if spent > OPENING * energy {
            return Err(moves_apart(own, worst, opening, robot));
        }
        // What was left out must hold all the same.
        for (index, own) in loops.iter().enumerate().filter(|(index, _)| !self.is_whole(*index)) {
            let [a, b] = own.velocities(plan, velocity, workspace);
            let left = (a - b).length();
            if left * left > OPENING * (a.dot(a) + b.dot(b)) {
                return Err(moves_apart(&named[index], index, left, robot));
            }
        }
        Ok((spent > ROUNDING * energy).then(|| {
            format!(
                "{} opens at {opening:.1e} m/s before the impact: the velocities are taken as the nearest ones, by kinetic \
                 energy, that keep every loop closed",
                own.name(worst, robot)
            )
        }))
    }

    /// Refuses a loop whose points are apart; gives how large a row must be to count.
    fn refuse_gaps(&self, named: &[NamedLoop]) -> Result<f64> {
        let size = self.feet.size();
        let mut widest = 0.0_f64;
        for (index, (own, named)) in self.assembly.loops.iter().zip(named).enumerate() {
            let gap = own.gap(&self.assembly.plan, &self.assembly.workspace).length();
            if gap.is_nan() || gap > OPEN * size {
                let name = named.name(index, self.robot);
                let reason = format!("the pose leaves {name} open: its points are {gap:.4e} m apart");
                let hint =
                    format!("the position must close every loop to {OPEN} of the robot's size ({:.1e} m)", OPEN * size);
                return Err(Error::new(Reason::Inconsistent(reason)).at(format!("loops[{index}]")).hint(hint));
            }
            widest = widest.max(gap);
        }
        let known = PER_GAP * widest / size;
        Ok(if widest > 0.0 { DEPENDENT.max(known * known) } else { DEPENDENT })
    }
}

fn moves_apart(own: &NamedLoop, index: usize, opening: f64, robot: &Robot) -> Error {
    let reason = format!("the velocities open {} at {opening:.3e} m/s", own.name(index, robot));
    Error::new(Reason::Inconsistent(reason))
        .at(format!("loops[{index}]"))
        .hint("give rates of all joints of the loop, such that both points move alike")
}
