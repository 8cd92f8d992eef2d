//! The cells of a contact problem in exact arithmetic. A cell has all velocities of one combination of modes.
//!
//! The impulses of a combination form a polyhedron. The double description method (Motzkin and others 1953; Fukuda and
//! Prodon 1996) turns its inequalities into vertices, rays and lines, one inequality after the other. The cell is the
//! convex hull of the velocities of the vertices.

use super::enumeration::Problem;
use crate::support::rational::{dot, rank, ratio, times};
use dashu_ratio::RBig;
use heelstrike::impact::Mode;

/// All velocities of one combination of modes: a convex set.
#[derive(Debug)]
pub struct Cell {
    pub modes: Vec<Mode>,
    pub dimension: usize,
    /// The corners of its closure, c+ by rows.
    pub corners: Vec<Vec<RBig>>,
}

/// The cells that are not empty.
pub fn cells(problem: &Problem) -> Vec<Cell> {
    let contacts = problem.friction.len();
    let lists =
        (0..1_usize << (2 * contacts)).map(|number| (0..contacts).map(move |k| Mode::ALL[number >> (2 * k) & 3]));
    lists.filter_map(|modes| cell(problem, modes.collect())).collect()
}

fn cell(problem: &Problem, modes: Vec<Mode>) -> Option<Cell> {
    let impulses = Impulses::of(problem, &modes);
    let generators = impulses.generators(&[], false);
    let mut velocities: Vec<Vec<RBig>> = generators.vertices.iter().map(|l| impulses.velocity(l)).collect();
    let strict = |modes: &[Mode], velocity: &[RBig], k: usize| match modes[k] {
        Mode::Separate => gap_speed(problem, velocity, k) > RBig::ZERO,
        Mode::Stick => true,
        Mode::SlidePlus => velocity[2 * k] > RBig::ZERO,
        Mode::SlideMinus => velocity[2 * k] < RBig::ZERO,
    };
    // The mean of all vertices satisfies a strict inequality if at least one vertex does.
    let inside = (0..modes.len()).all(|k| velocities.iter().any(|velocity| strict(&modes, velocity, k)));
    if velocities.is_empty() || !inside {
        return None;
    }
    for ray in generators.rays.iter().chain(&generators.lines) {
        assert!(
            times(&problem.delassus, &impulses.of_unknowns(ray)).iter().all(RBig::is_zero),
            "an unbounded velocity"
        );
    }
    velocities.sort();
    velocities.dedup();
    let differences: Vec<Vec<RBig>> =
        velocities.iter().map(|v| v.iter().zip(&velocities[0]).map(|(a, b)| a - b).collect()).collect();
    Some(Cell { modes, dimension: rank(&differences), corners: extreme(velocities) })
}

/// xi_n = c_n+ + e min(c_n-, 0) of contact `k`.
fn gap_speed(problem: &Problem, velocity: &[RBig], k: usize) -> RBig {
    let before = &problem.velocity_before[2 * k + 1];
    &velocity[2 * k + 1] + &problem.restitution[k] * before.clone().min(RBig::ZERO)
}

/// The modes of a velocity.
pub fn modes_of(problem: &Problem, velocity: &[RBig]) -> Vec<Mode> {
    let mode = |k: usize| match &velocity[2 * k] {
        _ if gap_speed(problem, velocity, k) > RBig::ZERO => Mode::Separate,
        c_t if *c_t > RBig::ZERO => Mode::SlidePlus,
        c_t if *c_t < RBig::ZERO => Mode::SlideMinus,
        _ => Mode::Stick,
    };
    (0..problem.friction.len()).map(mode).collect()
}

/// Whether the equations of the modes have a solution, and whether a solution satisfies the inequalities, zero
/// included.
pub fn is_solvable(problem: &Problem, modes: &[Mode]) -> [bool; 2] {
    let impulses = Impulses::of(problem, modes);
    [true, false].map(|equations_alone| !impulses.generators(&[], equations_alone).vertices.is_empty())
}

/// Least and greatest value of each impulse entry with these modes and this velocity; `None` if there is no bound.
pub fn impulse_range(problem: &Problem, modes: &[Mode], velocity: &[RBig]) -> Vec<[Option<RBig>; 2]> {
    let impulses = Impulses::of(problem, modes);
    let generators = impulses.generators(velocity, false);
    let all = |list: &[Vec<RBig>]| list.iter().map(|unknowns| impulses.of_unknowns(unknowns)).collect::<Vec<_>>();
    let [vertices, rays, lines] = [&generators.vertices, &generators.rays, &generators.lines].map(|list| all(list));
    let entry = |row: usize| {
        let free = lines.iter().any(|line| !line[row].is_zero());
        let open = |sign: i64| free || rays.iter().any(|ray| &ray[row] * ratio(sign, 1) > RBig::ZERO);
        let entries = || vertices.iter().map(|vertex| vertex[row].clone());
        [(!open(-1)).then(|| entries().min()).flatten(), (!open(1)).then(|| entries().max()).flatten()]
    };
    (0..velocity.len()).map(entry).collect()
}

/// The impulses of a combination as functions of unknowns: two for a sticking contact, one for a sliding contact.
struct Impulses<'a> {
    problem: &'a Problem,
    modes: &'a [Mode],
    /// For each unknown, the rows of L that it enters, and its factors there.
    unknowns: Vec<Vec<(usize, RBig)>>,
}

impl<'a> Impulses<'a> {
    fn of(problem: &'a Problem, modes: &'a [Mode]) -> Self {
        let mut unknowns = Vec::new();
        for (k, (mode, friction)) in modes.iter().zip(&problem.friction).enumerate() {
            let (t, n) = (2 * k, 2 * k + 1);
            let against = if *mode == Mode::SlidePlus { ratio(-1, 1) } else { RBig::ONE };
            match (mode, friction) {
                (Mode::Separate, _) => {}
                (Mode::Stick, _) => unknowns.extend([vec![(t, RBig::ONE)], vec![(n, RBig::ONE)]]),
                (_, Some(mu)) => unknowns.push(vec![(t, against * mu), (n, RBig::ONE)]),
                (_, None) => unknowns.push(vec![(t, against)]),
            }
        }
        Self { problem, modes, unknowns }
    }

    fn of_unknowns(&self, values: &[RBig]) -> Vec<RBig> {
        let mut impulse = vec![RBig::ZERO; 2 * self.modes.len()];
        for (entries, value) in self.unknowns.iter().zip(values) {
            entries.iter().for_each(|(row, entry)| impulse[*row] += entry * value);
        }
        impulse
    }

    fn velocity(&self, values: &[RBig]) -> Vec<RBig> {
        let gained = times(&self.problem.delassus, &self.of_unknowns(values));
        self.problem.velocity_before.iter().zip(gained).map(|(before, gained)| before + gained).collect()
    }

    /// All impulses that the modes allow, with this velocity if it is not empty. Strict inequalities include zero;
    /// `equations_alone` leaves all inequalities out.
    fn generators(&self, velocity: &[RBig], equations_alone: bool) -> Generators {
        let Self { problem, modes, unknowns } = self;
        // A row of c+: the coefficients of the unknowns, then the constant.
        let row = |row: usize| -> Vec<RBig> {
            let along = |entries: &Vec<(usize, RBig)>| {
                entries.iter().fold(RBig::ZERO, |sum, (column, entry)| sum + entry * &problem.delassus[row][*column])
            };
            unknowns.iter().map(along).chain([problem.velocity_before[row].clone()]).collect()
        };
        let negative = |row: &[RBig]| row.iter().map(|entry| -entry).collect::<Vec<_>>();
        let mut cone = Cone::whole(unknowns.len() + 1);
        let unit = |at: usize| (0..=unknowns.len()).map(|i| if i == at { RBig::ONE } else { RBig::ZERO }).collect();
        let one: Vec<RBig> = unit(unknowns.len());
        cone.restrict(&one, false);
        let mut require = |row: &[RBig], to_zero: bool| {
            if to_zero || !equations_alone {
                cone.restrict(row, to_zero);
            }
        };
        for (index, after) in velocity.iter().enumerate() {
            let mut row = row(index);
            *row.last_mut().expect("a constant") -= after;
            require(&row, true);
        }
        let mut unknown = 0;
        for (k, (mode, friction)) in modes.iter().zip(&problem.friction).enumerate() {
            let (c_t, mut xi) = (row(2 * k), row(2 * k + 1));
            let before = &problem.velocity_before[2 * k + 1];
            *xi.last_mut().expect("a constant") += &problem.restitution[k] * before.clone().min(RBig::ZERO);
            require(&xi, *mode != Mode::Separate);
            let own: Vec<RBig> = unit(unknown);
            match mode {
                Mode::Separate => continue,
                Mode::Stick => {
                    require(&c_t, true);
                    let normal: Vec<RBig> = unit(unknown + 1);
                    require(&normal, false);
                    // Without friction L_t = 0 is an equation.
                    if friction == &Some(RBig::ZERO) {
                        require(&own, true);
                    }
                    for side in friction.iter().flat_map(|_| [own.clone(), negative(&own)]) {
                        let mu = friction.clone().expect("finite");
                        let cone_edge: Vec<RBig> = normal.iter().zip(&side).map(|(n, t)| n * &mu + t).collect();
                        require(&cone_edge, false);
                    }
                    unknown += 2;
                    continue;
                }
                Mode::SlidePlus => require(&c_t, false),
                Mode::SlideMinus => require(&negative(&c_t), false),
            }
            require(&own, false);
            unknown += 1;
        }
        cone.generators()
    }
}

/// A polyhedron: the convex hull of vertices, plus nonnegative multiples of rays, plus multiples of lines.
struct Generators {
    vertices: Vec<Vec<RBig>>,
    rays: Vec<Vec<RBig>>,
    lines: Vec<Vec<RBig>>,
}

/// All sums of multiples of lines and nonnegative multiples of rays; no generator is redundant.
struct Cone {
    lines: Vec<Vec<RBig>>,
    /// Each ray with the set of inequalities that are zero on it, a bit for each.
    rays: Vec<(Vec<RBig>, u128)>,
    inequalities: u32,
}

impl Cone {
    fn whole(dimension: usize) -> Self {
        let unit = |at: usize| (0..dimension).map(|i| if i == at { RBig::ONE } else { RBig::ZERO }).collect();
        Self { lines: (0..dimension).map(unit).collect(), rays: Vec::new(), inequalities: 0 }
    }

    /// Restricts the cone to points on which `row` is nonnegative, or zero if `to_zero`.
    fn restrict(&mut self, row: &[RBig], to_zero: bool) {
        let own = 1 << self.inequalities;
        self.inequalities += 1;
        if let Some(place) = self.lines.iter().position(|line| !dot(row, line).is_zero()) {
            let mut line = self.lines.swap_remove(place);
            let mut along = dot(row, &line);
            if along < RBig::ZERO {
                line.iter_mut().for_each(|entry| *entry = -std::mem::take(entry));
                along = -along;
            }
            let level = |point: &mut Vec<RBig>| {
                let factor = dot(row, point) / &along;
                point.iter_mut().zip(&line).for_each(|(entry, part)| *entry -= &factor * part);
            };
            self.lines.iter_mut().for_each(level);
            for (ray, zeros) in &mut self.rays {
                level(ray);
                *zeros |= own;
            }
            if !to_zero {
                self.rays.push((line, own - 1));
            }
            return;
        }
        let values: Vec<RBig> = self.rays.iter().map(|(ray, _)| dot(row, ray)).collect();
        let mut kept = Vec::new();
        for (one, (ray, zeros)) in self.rays.iter().enumerate() {
            if values[one].is_zero() {
                kept.push((ray.clone(), zeros | own));
            } else if values[one] > RBig::ZERO {
                if !to_zero {
                    kept.push((ray.clone(), *zeros));
                }
                for (other, (against, others)) in self.rays.iter().enumerate() {
                    let shared = zeros & others;
                    let between = |(at, (_, all)): (usize, &(Vec<RBig>, u128))| {
                        at != one && at != other && all & shared == shared
                    };
                    if values[other] < RBig::ZERO && !self.rays.iter().enumerate().any(between) {
                        let entry = |(a, b): (&RBig, &RBig)| b * &values[one] - a * &values[other];
                        kept.push((shortened(ray.iter().zip(against).map(entry).collect()), shared | own));
                    }
                }
            }
        }
        self.rays = kept;
    }

    /// The polyhedron of the points whose last entry is one.
    fn generators(self) -> Generators {
        let mut found = Generators { vertices: Vec::new(), rays: Vec::new(), lines: self.lines };
        for (mut ray, _) in self.rays {
            let last = ray.pop().expect("the constant's entry");
            if last.is_zero() {
                found.rays.push(ray);
            } else {
                found.vertices.push(ray.into_iter().map(|entry| entry / &last).collect());
            }
        }
        found
    }
}

/// The ray, scaled so that its first nonzero entry has the magnitude one.
fn shortened(ray: Vec<RBig>) -> Vec<RBig> {
    let Some(first) = ray.iter().find(|entry| !entry.is_zero()).cloned() else { return ray };
    let size = if first < RBig::ZERO { -first } else { first };
    ray.into_iter().map(|entry| entry / &size).collect()
}

/// The points that are no convex combination of the others.
fn extreme(points: Vec<Vec<RBig>>) -> Vec<Vec<RBig>> {
    // An extreme functional that is nonnegative on the points is a facet; lines are zero on all points.
    let lifted: Vec<Vec<RBig>> = points.iter().map(|point| [&point[..], &[RBig::ONE]].concat()).collect();
    let mut functionals = Cone::whole(lifted[0].len());
    lifted.iter().for_each(|point| functionals.restrict(point, false));
    let is_corner = |point: &Vec<RBig>| {
        let facets = functionals.rays.iter().map(|(facet, _)| facet).filter(|facet| dot(facet, point).is_zero());
        rank(&facets.chain(&functionals.lines).cloned().collect()) + 1 == point.len()
    };
    let corners: Vec<bool> = lifted.iter().map(is_corner).collect();
    points.into_iter().zip(corners).filter_map(|(point, corner)| corner.then_some(point)).collect()
}
