//! The loops of a state: whether they close, which rows are independent, and a velocity that keeps them closed.

use super::Pipeline;
use super::assembly::{Assembly, Loads};
use crate::contact::Contact;
use crate::dynamics::plan::Plan;
use crate::dynamics::{
    Arm, Constraints, ContactPoint, Loop, Reach, follow_exactly, independent_rows, kinetic_energy, point_velocity,
    spent_energy,
};
use crate::error::{Error, Reason, Result, rounded};
use crate::planar::Vector;
use crate::robot::Robot;
use crate::scalar::{Ball, Certified, Magnitude, Real};
use crate::state::NamedLoop;

/// The greatest gap of a closed loop, as a fraction of the robot's size: poses are rounded, and springs may close
/// loops.
const OPEN: f64 = 1e-4;
/// The greatest fraction of the kinetic energy in the part of the velocity that opens the loops: 1 % of the speed.
const OPENING: f64 = 1e-4;
/// The greatest relative acceleration of a loop's points, as a fraction of the sum of the terms of their accelerations.
const PARTING: f64 = 1e-9;
/// Below this fraction of the kinetic energy, the part that opens the loops is rounding and gets no note.
const ROUNDING: f64 = 1e-20;
/// A row of K counts as dependent on others if less than this fraction of its squared reach is left.
const DEPENDENT: f64 = 1e-22;
/// The directions of a loop with a gap are off by up to this multiple of the gap, relative to a length of the robot.
const PER_GAP: f64 = 16.0;
/// Near a pose with gaps up to g lies a pose that closes the loops, and K has the same rank there, if more than this
/// multiple of g over the loops' shortest arm is left of each row, as a fraction of its squared reach: next to a
/// singular pose g amounts to angles of sqrt(g). Source: the theorem of Newton and Kantorovich, whose constant is 2.
const CERTAIN: f64 = 4.0;

impl NamedLoop {
    /// The loop for the dynamics, in numbers of any kind.
    pub(super) fn points<T: Real>(&self, robot: &Robot) -> Loop<T> {
        let ends = [self.a, self.b];
        Loop {
            bodies: ends.map(|end| robot.links[end.link].body),
            points: ends.map(|end| robot.links[end.link].point(end.offset)),
        }
    }

    /// The bodies of both ends, and bounds of the lengths of their arms.
    fn arms(&self, robot: &Robot) -> [Arm; 2] {
        [self.a, self.b].map(|end| {
            let link = &robot.links[end.link];
            Arm { body: link.body, length: link.stretch(end.offset) }
        })
    }

    /// The loop's name in messages, with its index in the list.
    fn name(&self, index: usize, robot: &Robot) -> String {
        let [a, b] = [self.a, self.b].map(|end| &robot.links[end.link].name);
        format!("loops[{index}] ({a} - {b})")
    }
}

impl Pipeline<'_> {
    /// Finds the independent rows of the loops at `position`, and closes the loops in `velocity`; a resting `foot`
    /// stays at rest. Returns whether this changes the velocity by rounding alone. Refuses a loop that the pose or the
    /// velocity leaves open, and names the gap.
    pub(super) fn close_loops(
        &mut self,
        named: &[NamedLoop],
        position: &[f64],
        foot: Option<&Contact>,
        velocity: &mut [f64],
        notes: &mut Vec<String>,
    ) -> Result<bool> {
        self.assembly.loops.clear();
        self.assembly.rows.clear();
        self.assembly.is_rank_certain = true;
        if named.is_empty() {
            self.assembly.constrain(None);
            return Ok(true);
        }
        let robot = self.robot;
        self.assembly.loops.extend(named.iter().map(|named| named.points(robot)));
        let gap = self.refuse_gaps(named)?;
        self.bounds.stretch(&self.assembly.plan, &self.assembly.configuration, std::iter::empty());
        let reaches: Vec<[Reach; 2]> = named.iter().map(|named| self.reaches(named.arms(robot))).collect();
        let known = PER_GAP * gap / self.feet.size();
        let tolerance = if gap > 0.0 { DEPENDENT.max(known * known) } else { DEPENDENT };
        let Assembly { plan, loops, kept, workspace, .. } = &self.assembly;
        let rows = independent_rows(plan, loops, kept, &reaches, tolerance, workspace);
        self.assembly.rows = rows.iter().map(|&(row, _)| row).collect();
        let all = reaches.as_flattened().iter();
        let shortest = all.clone().map(|reach| reach.shortest).fold(f64::INFINITY, f64::min);
        let longest = all.map(|reach| reach.longest).fold(0.0, f64::max);
        let doubtful = CERTAIN * (gap + f64::EPSILON * longest) / shortest;
        let all_count = rows.len() == 2 * named.len();
        if rows.iter().any(|&(_, share)| share <= doubtful)
            || !(all_count || self.others_follow_exactly(named, position))
        {
            self.assembly.is_rank_certain = false;
            notes.push(format!(
                "how much the loops hold depends on digits that the pose does not have (gap {gap:.1e} m): they are taken to \
                 hold {} of {} directions, and nothing is proven; a pose that closes them to more digits, or one \
                 farther from a singular pose, decides it",
                rows.len(),
                2 * named.len()
            ));
        }
        // Rows that follow from others are left out.
        for (index, named) in named.iter().enumerate().filter(|(index, _)| !self.is_whole(*index)) {
            let left = [(2 * index, "x"), (2 * index + 1, "z")];
            let left = left.into_iter().filter(|(row, _)| !self.assembly.rows.contains(row));
            let left: Vec<&str> = left.map(|(_, axis)| axis).collect();
            notes.push(format!(
                "{} is already closed along {} by what else holds its points: that is left out, its impulse is 0",
                named.name(index, robot),
                left.join(" and ")
            ));
        }
        let opened = self.close_velocity(named, foot.map(Contact::point_of), velocity)?;
        let is_rounding = opened.is_none();
        notes.extend(opened);
        Ok(is_rounding)
    }

    fn reaches(&self, [a, b]: [Arm; 2]) -> [Reach; 2] {
        [(a, b), (b, a)].map(|(end, other)| self.bounds.reach(&self.assembly.plan, end, other.body))
    }

    /// Returns whether the loops are exactly closed and the rows left out follow exactly from the others.
    fn others_follow_exactly(&self, named: &[NamedLoop], position: &[f64]) -> bool {
        let Assembly { kept, rows, .. } = &self.assembly;
        let braked = if kept.is_empty() { &self.braked[..] } else { &[] };
        let mut exact: Assembly<Certified<Ball>> = Assembly::new(Plan::new(self.robot, braked, &self.rotor_inertia));
        exact.configuration.set(&exact.plan, position);
        exact.place();
        let loops: Vec<_> = named.iter().map(|named| named.points(self.robot)).collect();
        follow_exactly(&exact.plan, &loops, Constraints { kept, rows }, &exact.workspace)
    }

    /// Returns whether both rows of a loop are independent.
    fn is_whole(&self, index: usize) -> bool {
        [2 * index, 2 * index + 1].iter().all(|row| self.assembly.rows.contains(row))
    }

    /// Closes the loops in `velocity`. Returns a note if that changes it by more than rounding.
    fn close_velocity(
        &mut self,
        named: &[NamedLoop],
        foot: Option<ContactPoint>,
        velocity: &mut [f64],
    ) -> Result<Option<String>> {
        let robot = self.robot;
        let Assembly { plan, workspace, loops, .. } = &self.assembly;
        let energy = kinetic_energy(plan, velocity, workspace, &mut Vec::new());
        let openings = loops.iter().map(|pair| pair.opening(plan, velocity, workspace).length());
        let widest = openings.zip(named).enumerate().reduce(|most, next| if next.1.0 > most.1.0 { next } else { most });
        let Some((worst, (opening, opened))) = widest else { return Ok(None) };
        self.assembly.constrain(foot);
        let given = velocity.to_vec();
        let amplitudes = self.assembly.close(velocity);
        let Assembly { plan, workspace, loops, .. } = &self.assembly;
        if let Some(foot) = foot {
            let moving = point_velocity(plan, foot.body, foot.arm(workspace), velocity, workspace);
            for (rate, moving) in velocity.iter_mut().zip(moving.components()) {
                *rate -= moving;
            }
        }
        let spent = spent_energy(&amplitudes, workspace);
        let resting = self.options.resting_speed.unwrap_or(0.0);
        if spent > OPENING * energy && opening > resting {
            return Err(moves_apart(opened, worst, opening, robot));
        }
        // The rows left out must hold, too, up to a fraction of the given speeds of their points, which may be at rest
        // now. Points that were at rest before may move by the rounding of other loops' closing.
        let speeds = |named: &NamedLoop| named.arms(robot).map(|end| self.bounds.speed(plan, end, &given));
        let squared = |named: &NamedLoop| speeds(named).iter().map(|speed| speed * speed).sum::<f64>();
        let fastest = named.iter().map(squared).fold(0.0, f64::max);
        for (index, pair) in loops.iter().enumerate().filter(|(index, _)| !self.is_whole(*index)) {
            let left = pair.opening(plan, velocity, workspace).length();
            if left * left > OPENING * squared(&named[index]) + ROUNDING * fastest && left > resting {
                return Err(moves_apart(&named[index], index, left, robot));
            }
        }
        Ok((spent > ROUNDING * energy).then(|| {
            format!(
                "{} opens at {opening:.1e} m/s before the impact: the velocities are taken as the nearest ones, by kinetic \
                 energy, that keep every loop closed",
                opened.name(worst, robot)
            )
        }))
    }

    /// Refuses the acceleration `free` by coordinate if it opens a loop along a row that was left out. At a dead point
    /// no velocity opens the loop, but the motion's own acceleration may move its points apart. `drifts` is kappa of
    /// each loop, and `unclosed` is the acceleration without the loops' response.
    pub(super) fn refuse_parting(
        &mut self,
        named: &[NamedLoop],
        [velocity, unclosed, free]: [&[f64]; 3],
        drifts: &[Vector],
        loads: Loads<'_>,
    ) -> Result<()> {
        if (0..named.len()).all(|index| self.is_whole(index)) {
            return Ok(());
        }
        let reaches = named.iter().flat_map(|named| self.reaches(named.arms(self.robot)));
        let shortest = reaches.map(|reach| reach.shortest).fold(f64::INFINITY, f64::min);
        let Self { robot, assembly: Assembly { plan, loops, workspace, rows, .. }, stretched, bounds, .. } = self;
        let gap = loops.iter().fold(0.0, |most: f64, pair| most.max(pair.gap(plan, workspace).length()));
        // Magnitudes of the terms of the accelerations.
        bounds.stretched_poses(&stretched.plan, &mut stretched.workspace);
        let magnitudes = |list: &[f64]| list.iter().map(|&entry| Magnitude::from_f64(entry)).collect::<Vec<_>>();
        stretched.load(&magnitudes(velocity), loads);
        let most = PARTING.max(PER_GAP * gap / shortest);
        for (index, (pair, &drift)) in loops.iter().zip(drifts).enumerate() {
            let opening = (pair.opening(plan, free, workspace) + drift).components();
            let pushed = [unclosed, free].map(|list| named[index].arms(robot).map(|end| bounds.speed(plan, end, list)));
            let turning = named[index].points::<Magnitude>(robot).drift(&stretched.workspace).components();
            let size = pushed.as_flattened().iter().chain(turning.iter().map(|Magnitude(number)| number)).sum::<f64>()
                + loads.scene.gravity().abs();
            let left = [0, 1].map(|axis| if rows.contains(&(2 * index + axis)) { 0.0 } else { opening[axis].abs() });
            if left[0].max(left[1]) > most * size {
                let name = named[index].name(index, robot);
                let apart = rounded(left[0].max(left[1]));
                let reason = format!("no acceleration keeps {name} closed: its points part at {apart} m/s^2");
                let hint = "it moves through a dead point, or is held at rates that it cannot keep: ask next to that pose, or \
                            hold fewer joints";
                return Err(Error::new(Reason::Inconsistent(reason)).at(format!("loops[{index}]")).hint(hint));
            }
        }
        Ok(())
    }

    /// Refuses a loop with a gap that is too wide. Returns the widest gap \[m\].
    fn refuse_gaps(&self, named: &[NamedLoop]) -> Result<f64> {
        let size = self.feet.size();
        let mut widest = 0.0_f64;
        for (index, (pair, named)) in self.assembly.loops.iter().zip(named).enumerate() {
            let gap = pair.gap(&self.assembly.plan, &self.assembly.workspace).length();
            if gap.is_nan() || gap > OPEN * size {
                let name = named.name(index, self.robot);
                let reason = format!("the pose leaves {name} open: its points are {} m apart", rounded(gap));
                let hint =
                    format!("the position must close every loop to {OPEN} of the robot's size ({:.1e} m)", OPEN * size);
                return Err(Error::new(Reason::Inconsistent(reason)).at(format!("loops[{index}]")).hint(hint));
            }
            widest = widest.max(gap);
        }
        Ok(widest)
    }
}

fn moves_apart(named: &NamedLoop, index: usize, opening: f64, robot: &Robot) -> Error {
    let reason = format!("the velocities open {} at {} m/s", named.name(index, robot), rounded(opening));
    Error::new(Reason::Inconsistent(reason)).at(format!("loops[{index}]")).hint(
        "give rates of all joints of the loop, such that both points move alike; what is noise, `resting_speed` covers",
    )
}
