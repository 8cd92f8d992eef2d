//! The points of a robot that can touch the ground, and their places.

use super::Touching;
use crate::contact::{Circle, Feet, HalfPlane, Placement, Point, points};
use crate::dynamics::plan::{Configuration, Plan};
use crate::dynamics::{ContactPoint, Workspace, kinematics, point_velocity};
use crate::planar::{Rotation, Vector};
use crate::robot::{Base, Robot};
use crate::state::{NamedContact, State};
use std::cmp::Ordering;

/// Up to this slope, ground and soles count as level.
const SLOPE: f64 = 0.15;

/// All points of a robot's feet in the order of its links, with memory for their places.
#[derive(Debug)]
pub(super) struct Points<'r> {
    robot: &'r Robot,
    plan: Plan,
    configuration: Configuration,
    workspace: Workspace,
    feet: Feet,
    points: Vec<(usize, Point)>,
}

impl<'r> Points<'r> {
    pub fn new(robot: &'r Robot, feet: &[NamedContact]) -> Self {
        let mut all: Vec<(usize, Point)> = Vec::new();
        let feet = Feet::new(robot, feet);
        for (link, point) in feet.iter().flat_map(|foot| points(foot).map(|point| (foot.link, point))) {
            // Shapes of a link may share a corner, which is one point.
            if !all.contains(&(link, point)) {
                all.push((link, point));
            }
        }
        let plan = Plan::new(robot, &[], &[]);
        let (configuration, workspace) = Default::default();
        Self { robot, plan, configuration, workspace, feet, points: all }
    }

    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Returns the places `[x, z]` of the points in the world \[m\], in the configuration `position` (q).
    pub fn at(&mut self, position: &[f64]) -> Vec<Vector<f64>> {
        let placement = self.placement(position);
        self.points.iter().map(|&(_, point)| HalfPlane::LEVEL.lowest(&placement, point)).collect()
    }

    fn placement(&mut self, position: &[f64]) -> Placement {
        self.configuration.set(&self.plan, position);
        kinematics(&self.plan, &self.configuration, &mut self.workspace);
        let base =
            if self.robot.base == Base::Floating { Vector::new(position[0], position[1]) } else { Vector::zero() };
        Placement::new(&self.plan, &self.workspace, base)
    }

    /// Returns whether a point touches before all others of its body, on some ground between the slopes ±[`SLOPE`], or
    /// with them up to `together` \[m\]. All points are at `places`.
    pub fn is_free(&self, point: usize, places: &[Vector<f64>], together: f64) -> bool {
        let Vector { x, z } = places[point];
        // Above ground of slope m, the height of a point is z - m x.
        let (mut least, mut most) = (-SLOPE, SLOPE);
        for other in self.of_body(self.body(point)) {
            let [across, above] = [x - places[other].x, z - places[other].z - together];
            if across > 0.0 {
                least = least.max(above / across);
            } else if across < 0.0 {
                most = most.min(above / across);
            } else if above > 0.0 {
                return false;
            }
        }
        least <= most
    }

    /// Shifts `state` along z so that the point `striking` is at z = 0, and names its contacts, with the points `also`
    /// that strike with it and, with true heights, points of any body that stand or go down up to `level` \[m\].
    /// Returns the shift \[m\] and the name of the striking contact. `together` is that of [`Points::is_free`].
    pub fn touch(
        &mut self,
        state: &mut State,
        (striking, also): (usize, &[usize]),
        touching: Touching,
        (together, level): (f64, Option<f64>),
    ) -> (f64, String) {
        let placement = self.placement(&state.position);
        let places: Vec<_> = self.points.iter().map(|&(_, point)| HalfPlane::LEVEL.lowest(&placement, point)).collect();
        let above = |point: usize| (places[point].z - places[striking].z).abs();
        let mut closed = vec![striking];
        closed.extend(also);
        match touching {
            Touching::Strike => {}
            Touching::Slow { speed, height } => {
                let moving = |point: usize| self.velocity(point, &placement, &state.velocity);
                let mut feet = self.lowest_of_other_bodies(&closed, &places);
                feet.retain(|&point| above(point) <= height && moving(point).length() < speed);
                closed.append(&mut feet);
                if let Some(level) = level {
                    // Only the outer two of each body, as for a sole. Points may be deep in soft ground.
                    let is_down = |point: usize| {
                        let moving = moving(point);
                        (-height..=level).contains(&places[point].z) && (moving.length() < speed || moving.z < 0.0)
                    };
                    let on_it = |&point: &usize| closed.contains(&point) || is_down(point);
                    let ground: Vec<usize> = (0..places.len()).filter(on_it).collect();
                    let is_outer = |point: usize| {
                        let others = ground.iter().filter(|&&other| self.body(other) == self.body(point));
                        let mut ways = others.map(|&other| places[other].x.total_cmp(&places[point].x));
                        ways.clone().all(Ordering::is_le) || ways.all(Ordering::is_ge)
                    };
                    let is_new = |&point: &usize| !closed.contains(&point) && is_outer(point);
                    let mut outer: Vec<usize> = ground.iter().copied().filter(is_new).collect();
                    closed.append(&mut outer);
                }
            }
            Touching::Near { height } => {
                let free = |point: &usize| above(*point) <= height && self.is_free(*point, &places, together);
                let near = |point: &usize| *point != striking && !also.contains(point) && free(point);
                closed.extend((0..places.len()).filter(near));
            }
        }
        // The order is that of detected contacts: by link, and within a link along x.
        let link = |point: usize| self.points[point].0;
        closed.sort_by(|&a, &b| link(a).cmp(&link(b)).then(places[a].x.total_cmp(&places[b].x)));
        state.scene.contacts = Some(closed.iter().map(|&point| self.named(point, &placement)).collect());

        let name = self.robot.links[link(striking)].name.clone();
        let mut of_link = closed.iter().filter(|&&point| link(point) == link(striking));
        let at = of_link.clone().position(|&point| point == striking).unwrap_or(0);
        let name = if of_link.nth(1).is_some() { self.feet.numbered(&name, at) } else { name };
        if self.robot.base == Base::Fixed {
            return (0.0, name);
        }
        let shift = -places[striking].z;
        state.position[1] += shift;
        (shift, name)
    }

    /// Returns the lowest point of every body without a striking point.
    fn lowest_of_other_bodies(&self, strikers: &[usize], places: &[Vector<f64>]) -> Vec<usize> {
        let striking: Vec<usize> = strikers.iter().map(|&point| self.body(point)).collect();
        let others = (0..self.robot.bodies.len()).filter(|body| !striking.contains(body));
        let height = |point: &usize| places[*point].z;
        let lowest = |body| self.of_body(body).min_by(|a, b| height(a).total_cmp(&height(b)));
        others.filter_map(lowest).collect()
    }

    fn body(&self, point: usize) -> usize {
        self.points[point].1.body
    }

    fn of_body(&self, body: usize) -> impl Iterator<Item = usize> {
        (0..self.points.len()).filter(move |&point| self.body(point) == body)
    }

    /// Returns the vertical velocity of a point, positive upward \[m/s\].
    pub fn rate(&mut self, point: usize, state: &State) -> f64 {
        let placement = self.placement(&state.position);
        self.velocity(point, &placement, &state.velocity).z
    }

    /// Returns the velocity of a point \[m/s\]. Requires `placement`.
    fn velocity(&self, point: usize, placement: &Placement, velocity: &[f64]) -> Vector<f64> {
        let Circle { body, center, radius, .. } = HalfPlane::LEVEL.circle(placement, self.points[point].1);
        let arm = ContactPoint { body, center, radius, ground: Rotation::identity() }.arm(&self.workspace);
        point_velocity(&self.plan, body, arm, velocity, &self.workspace)
    }

    fn named(&self, point: usize, placement: &Placement) -> NamedContact {
        let (link, point) = self.points[point];
        let Circle { center, radius, .. } = HalfPlane::LEVEL.circle(placement, point);
        NamedContact { link, offset: self.robot.links[link].offset(center), radius }
    }
}
