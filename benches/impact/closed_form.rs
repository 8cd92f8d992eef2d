//! RAMone's impact with both feet, written by hand for this robot alone: M, J and G, then the signs of all 16
//! combinations. General code takes longer; [`super::ratios`] prints by how much.
//!
//! All masses and feet lie on the vertical axes of their bodies. With u the body's turn `(sin, cos)`, a point at -l is
//! -l u from the origin, and a positive rate moves it by -l (cos, -sin). Joints turn the other way.

use heelstrike::ContactProblem;
use std::array::from_fn;

const TORSO: (f64, f64) = (7.9026, 0.08);
const THIGH: Link = Link { mass: 0.7887, moment: 0.00221, com: 0.019399, length: 0.2 };
const SHANK: Link = Link { mass: 0.51, moment: 0.00652, com: 0.165235, length: 0.2385 };
const HIP: f64 = 0.137675;
const RADIUS: f64 = 0.02815;

/// Numbers below this have no sign, relative to the scale of their row: a bound by hand, not a proof.
const ROUNDING: f64 = 1e-11;

struct Link {
    mass: f64,
    moment: f64,
    com: f64,
    length: f64,
}

type Matrix<const N: usize> = [[f64; N]; N];

/// The matrices of one leg, in the columns x, z, pitch, hip, knee.
#[derive(Default, Clone, Copy)]
pub struct Leg {
    /// The leg's part of the lower triangle of M.
    pub mass: Matrix<5>,
    /// J of its foot, tangential and normal.
    pub jacobian: [[f64; 5]; 2],
}

#[derive(Default)]
pub struct Impact {
    pub legs: [Leg; 2],
    pub delassus: Matrix<4>,
    /// c- \[m/s\].
    pub velocity: [f64; 4],
    /// The outcomes, by modes: bit 4 a + b is set for the modes a and b in the order of `Mode::ALL`.
    pub outcomes: u32,
    /// Number of combinations that have a sign within [`ROUNDING`].
    pub undecided: u32,
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn sum(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

impl Leg {
    fn of(torso: [f64; 2], pitch: f64, hip: f64, knee: f64) -> Self {
        let along = |[sin, cos]: [f64; 2], length: f64| [-length * sin, -length * cos];
        let turn = |angle: f64| <[f64; 2]>::from(libm::sincos(angle));
        let (thigh, shank) = (turn(pitch - hip), turn(pitch - hip - knee));
        let to_hip = along(torso, HIP);
        let to_knee = along(thigh, THIGH.length);
        let leg = THIGH.mass + SHANK.mass;
        // First and second moments of the shank about the knee, and of the leg about the hip.
        let first = along(shank, SHANK.mass * SHANK.com);
        let second = SHANK.moment + SHANK.mass * SHANK.com * SHANK.com;
        let bent = dot(to_knee, first);
        let whole_first = sum(along(thigh, THIGH.mass * THIGH.com + SHANK.mass * THIGH.length), first);
        let straight =
            THIGH.moment + THIGH.mass * THIGH.com * THIGH.com + SHANK.mass * THIGH.length * THIGH.length + second;
        let whole_second = straight + 2.0 * bent;
        let swung = dot(to_hip, whole_first);
        let all_first = sum(whole_first, to_hip.map(|entry| leg * entry));
        let foot = sum(along(shank, SHANK.length), [0.0, -RADIUS]);
        let arms = [foot, sum(foot, to_knee), sum(sum(foot, to_knee), to_hip)];
        Self {
            mass: [
                [leg, 0.0, 0.0, 0.0, 0.0],
                [0.0, leg, 0.0, 0.0, 0.0],
                [all_first[1], -all_first[0], whole_second + 2.0 * swung + leg * HIP * HIP, 0.0, 0.0],
                [-whole_first[1], whole_first[0], -(whole_second + swung), whole_second, 0.0],
                [-first[1], first[0], -(second + bent + dot(to_hip, first)), second + bent, second],
            ],
            jacobian: [
                [1.0, 0.0, arms[2][1], -arms[1][1], -arms[0][1]],
                [0.0, 1.0, -arms[2][0], arms[1][0], arms[0][0]],
            ],
        }
    }
}

/// Eliminates the last columns of M = L^T D L down to `least`, in M and in the rows of J.
fn eliminate<const N: usize, const R: usize>(mass: &mut Matrix<N>, rows: &mut [[f64; N]; R], least: usize) {
    for k in (least..N).rev() {
        for i in (0..k).rev() {
            let factor = mass[k][i] / mass[k][k];
            (0..=i).for_each(|j| mass[i][j] -= factor * mass[k][j]);
            for row in &mut *rows {
                row[i] -= factor * row[k];
            }
        }
    }
}

impl Impact {
    /// Computes M, J, G and c- from q and v in the order x, z, pitch, left hip and knee, right hip and knee.
    pub fn assemble(&mut self, q: &[f64; 7], v: &[f64; 7]) {
        let torso = <[f64; 2]>::from(libm::sincos(q[2]));
        self.legs = from_fn(|leg| Leg::of(torso, q[2], q[3 + 2 * leg], q[4 + 2 * leg]));
        let mut base = [[TORSO.0, 0.0, 0.0], [0.0, TORSO.0, 0.0], [0.0, 0.0, TORSO.1]];
        let mut rows = [[0.0; 3]; 4];
        for (foot, Leg { mut mass, jacobian }) in self.legs.into_iter().enumerate() {
            let own = [v[0], v[1], v[2], v[3 + 2 * foot], v[4 + 2 * foot]];
            let mut half = jacobian;
            eliminate(&mut mass, &mut half, 3);
            for i in 0..3 {
                for j in 0..=i {
                    base[i][j] += mass[i][j];
                }
            }
            for (at, row) in half.iter().enumerate() {
                let along: f64 = from_fn::<f64, 5, _>(|k| jacobian[at][k] * own[k]).into_iter().sum();
                self.velocity[2 * foot + at] = along;
                rows[2 * foot + at].copy_from_slice(&row[..3]);
                for (with, other) in half[..=at].iter().enumerate() {
                    self.delassus[2 * foot + at][2 * foot + with] =
                        row[3] * other[3] / mass[3][3] + row[4] * other[4] / mass[4][4];
                }
            }
        }
        eliminate(&mut base, &mut rows, 0);
        let by_d = rows.map(|row| from_fn::<f64, 3, _>(|k| row[k] / base[k][k]));
        for (i, row) in rows.iter().enumerate() {
            for (j, by_d) in by_d[..=i].iter().enumerate() {
                let own = if i / 2 == j / 2 { self.delassus[i][j] } else { 0.0 };
                let entry = own + row[0] * by_d[0] + row[1] * by_d[1] + row[2] * by_d[2];
                (self.delassus[i][j], self.delassus[j][i]) = (entry, entry);
            }
        }
    }

    /// Takes G and c of a problem.
    pub fn take(&mut self, problem: &ContactProblem) {
        self.delassus = from_fn(|row| from_fn(|column| problem.delassus(row, column)));
        self.velocity = from_fn(|row| problem.velocity_before()[row / 2][row % 2]);
    }

    /// Computes the outcomes with friction `mu`. The second contact's signs come first, since most combinations fail
    /// there.
    pub fn solve(&mut self, mu: f64) {
        let (g, c) = (self.delassus, self.velocity);
        let block = |row: usize, column: usize| [0, 1].map(|i| [0, 1].map(|j| g[2 * row + i][2 * column + j]));
        let root: [f64; 4] = from_fn(|row| g[row][row].sqrt());
        let speed = (0..4).fold(0.0, |most: f64, row| most.max(c[row].abs() / root[row]));
        let law = |contact: usize| {
            let root = [root[2 * contact], root[2 * contact + 1]];
            let [velocity, impulse] =
                [root.map(|root| ROUNDING * speed * root), root.map(|root| ROUNDING * speed / root)];
            Law { mu, velocity, impulse }
        };
        let laws = [law(0), law(1)];
        let (c_0, c_1) = ([c[0], c[1]], [c[2], c[3]]);
        let across = block(1, 0);
        (self.outcomes, self.undecided) = (0, 0);
        for first in 0..4 {
            let answer = laws[0].answer(block(0, 0), first);
            let carried = product(across, answer);
            let both = product(carried, block(0, 1));
            let rest = from_fn(|i| from_fn(|j| block(1, 1)[i][j] - both[i][j]));
            let free = from_fn(|i| c_1[i] - dot(carried[i], c_0));
            for second in 0..4 {
                let l_1 = laws[1].answer(rest, second).map(|row| -dot(row, free));
                let least = laws[1].least(second, l_1, sum(free, rest.map(|row| dot(row, l_1))));
                if least < -1.0 {
                    continue;
                }
                let pushed = sum(c_0, block(0, 1).map(|row| dot(row, l_1)));
                let l_0 = answer.map(|row| -dot(row, pushed));
                let after = sum(pushed, block(0, 0).map(|row| dot(row, l_0)));
                let least = least.min(laws[0].least(first, l_0, after));
                self.undecided += u32::from(least.abs() <= 1.0);
                self.outcomes |= u32::from(least > 1.0) << (4 * first + second);
            }
        }
    }
}

fn product(a: Matrix<2>, b: Matrix<2>) -> Matrix<2> {
    from_fn(|i| from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

/// One contact's friction, and the bounds of rounding of its velocities and impulses.
struct Law {
    mu: f64,
    velocity: [f64; 2],
    impulse: [f64; 2],
}

impl Law {
    /// K with L = -K c for the velocity c without this contact's impulse: separate, stick, slide+, slide-.
    fn answer(&self, g: Matrix<2>, mode: usize) -> Matrix<2> {
        match mode {
            0 => [[0.0; 2]; 2],
            1 => {
                let by = 1.0 / (g[0][0] * g[1][1] - g[0][1] * g[1][0]);
                [[g[1][1] * by, -g[0][1] * by], [-g[1][0] * by, g[0][0] * by]]
            }
            _ => {
                let along = if mode == 2 { -self.mu } else { self.mu };
                let by = 1.0 / (g[1][0] * along + g[1][1]);
                [[0.0, along * by], [0.0, by]]
            }
        }
    }

    /// The smallest of a mode's inequalities, in units of its rounding.
    fn least(&self, mode: usize, [l_t, l_n]: [f64; 2], [c_t, c_n]: [f64; 2]) -> f64 {
        let pressed = l_n / self.impulse[1];
        match mode {
            0 => c_n / self.velocity[1],
            1 => pressed.min((self.mu * l_n - l_t.abs()) / (self.impulse[0] + self.mu * self.impulse[1])),
            2 => pressed.min(c_t / self.velocity[0]),
            _ => pressed.min(-c_t / self.velocity[0]),
        }
    }
}
