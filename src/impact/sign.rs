//! From numbers to signs: the slacks of a combination's inequalities and what they say.
//!
//! ```text
//!     separate  xi_n > 0      stick  L_n >= 0,  a L_n -+ b L_t >= 0      slide+-  +-c_t > 0,  lambda >= 0
//! ```
//!
//! A [`Sign`](crate::scalar::Sign) is told only where the number's error bound allows it.

use super::enumerate::Leaf;
use super::mode::{Friction, Mode};
use super::outcome::Because;
use super::problem::{ContactProblem, Errors};
use crate::planar::Vector;
use crate::scalar::{Ordered, Real};

/// What an inequality is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SlackKind {
    /// xi_n of a separating contact; must be positive.
    Separation,
    /// L_n of a closed contact.
    Pressure,
    /// a L_n - b |L_t| of a sticking contact, as two slacks.
    Cone,
    /// +-c_t of a sliding contact; must be positive.
    Slip,
    /// With infinite friction: -+L_t of a sliding contact.
    Drag,
}

/// One inequality of a combination: `number >= 0`, or `> 0` where it is strict.
#[derive(Debug, Clone, Copy)]
pub struct Slack<T> {
    /// The contact, from 0.
    pub contact: usize,
    /// What it is about.
    pub kind: SlackKind,
    /// Its value, with its unit.
    pub number: T,
}

impl SlackKind {
    /// Whether the strict modes exclude zero (a velocity of zero belongs to another list of modes).
    pub fn is_strict(self) -> bool {
        matches!(self, SlackKind::Separation | SlackKind::Slip)
    }

    /// What a negative slack means.
    pub fn violation(self, contact: usize) -> Because {
        match self {
            SlackKind::Separation => Because::Penetrates { contact },
            SlackKind::Pressure => Because::Pulled { contact },
            SlackKind::Cone => Because::NeedsFriction { contact },
            SlackKind::Slip => Because::SlidesBackward { contact },
            SlackKind::Drag => Because::FrictionPushes { contact },
        }
    }
}

/// Calls `visitor` with every slack of the combination `modes` (frictionless contacts have their own mode here, not the
/// leaf's common one). A frictionless contact that sticks has the equality c_t = 0, which is no slack.
pub fn slacks<T: Real>(leaf: &Leaf<'_, T>, modes: &[Mode], friction: &[Friction], mut visitor: impl FnMut(Slack<T>)) {
    for (contact, (&mode, &friction)) in modes.iter().zip(friction).enumerate() {
        let [first, second] = leaf.numbers(contact);
        let mut tell = |kind, number| visitor(Slack { contact, kind, number });
        match mode {
            Mode::Separate => tell(SlackKind::Separation, second),
            Mode::Stick => {
                tell(SlackKind::Pressure, second);
                if let Friction::Finite(mu) = friction
                    && mu > 0.0
                {
                    let reach = T::from_f64(mu) * second;
                    tell(SlackKind::Cone, reach - first);
                    tell(SlackKind::Cone, reach + first);
                }
            }
            Mode::SlidePlus | Mode::SlideMinus => {
                let kind = if friction == Friction::Infinite { SlackKind::Drag } else { SlackKind::Pressure };
                tell(kind, second);
                tell(SlackKind::Slip, if mode == Mode::SlidePlus { first } else { -first });
            }
        }
    }
}

/// The problem's own magnitudes, which make slacks free of units.
///
/// With S = max |c_free| / sqrt(G_ii) \[sqrt J\]: a velocity counts c_i / (S sqrt(G_ii)), an impulse L_i sqrt(G_ii) / S, a
/// cone (a L_n - b |L_t|) / (S sqrt(a^2 / G_nn + b^2 / G_tt)).
#[derive(Debug, Clone, Default)]
pub struct Scale {
    /// S \[sqrt J\]; 1 where nothing moves.
    pub speed: f64,
    /// sqrt(G_ii) of every row \[1/sqrt(kg)\]; of a row that nothing moves the largest of the others.
    pub mobility: Vec<f64>,
    /// What the scaled velocities of the f64 problem may be off by.
    pub noise: f64,
}

impl Scale {
    /// Takes the magnitudes of a problem, reusing the memory; `errors` are those of its numbers.
    pub fn measure(&mut self, problem: &ContactProblem, errors: Errors<'_>) {
        let rows = 2 * problem.contacts();
        self.mobility.clear();
        self.mobility.extend((0..rows).map(|row| problem.delassus(row, row).max(0.0).sqrt()));
        let largest = self.mobility.iter().copied().fold(0.0, f64::max);
        let fallback = if largest > 0.0 { largest } else { 1.0 };
        for mobility in &mut self.mobility {
            if *mobility <= 0.0 {
                *mobility = fallback;
            }
        }
        let entries = problem.velocity_free().iter().flatten().zip(&self.mobility);
        self.speed = entries.map(|(c, mobility)| c.abs() / mobility).fold(0.0, f64::max);
        let bounces = (0..problem.contacts()).map(|i| problem.bounce(i).abs() / self.mobility[2 * i + 1]);
        if self.speed == 0.0 {
            // An applied impulse may cancel c- exactly and leave the bounce alone.
            self.speed = bounces.fold(0.0, f64::max);
        }
        if self.speed == 0.0 {
            // Speeds that vanish in the division are no rest: so small a scale leaves them to other numbers than f64.
            let at_rest = problem.velocity_free().iter().flatten().all(|&c| c == 0.0);
            self.speed = if at_rest { 1.0 } else { f64::MIN_POSITIVE };
        }
        let noise = errors.velocity.unwrap_or_default().iter().flatten().zip(&self.mobility);
        self.noise = noise.map(|(noise, mobility)| noise / (mobility * self.speed)).fold(0.0, f64::max);
        if (0..problem.contacts()).any(|contact| problem.bounce(contact) != 0.0) {
            // The bounce and its sum with c_n, each at most S sqrt(G_nn), are rounded.
            self.noise += 4.0 * f64::EPSILON;
        }
    }

    /// What a slack of this kind, divided by S, is multiplied by to be free of units.
    pub fn factor(&self, kind: SlackKind, contact: usize, friction: Friction) -> f64 {
        let (d_t, d_n) = (self.mobility[2 * contact], self.mobility[2 * contact + 1]);
        match kind {
            SlackKind::Separation => 1.0 / d_n,
            SlackKind::Slip => 1.0 / d_t,
            SlackKind::Pressure => d_n,
            SlackKind::Drag => d_t,
            SlackKind::Cone => {
                let (a, b) = friction.pair();
                1.0 / (a / d_n).hypot(b / d_t)
            }
        }
    }

    /// How far velocities and impulses, by row, may be off: the largest error in the scale, relative to the largest of them
    /// where that exceeds one.
    pub fn error<T: Ordered>(&self, velocity: impl Iterator<Item = T>, impulse: impl Iterator<Item = T>) -> f64 {
        let velocity = velocity.zip(&self.mobility).map(|(number, mobility)| (number, 1.0 / mobility));
        let impulse = impulse.zip(&self.mobility).map(|(number, mobility)| (number, *mobility));
        let (mut size, mut error) = (1.0_f64, 0.0_f64);
        for (number, factor) in velocity.chain(impulse) {
            size = size.max((number.to_f64() / self.speed * factor).abs());
            let off = number.error() / self.speed * factor;
            // `f64::max` would drop a NaN.
            error = if off.is_nan() { f64::INFINITY } else { error.max(off) };
        }
        error / size
    }

    /// Whether two lists of contact velocities are the same but for rounding.
    pub fn same_velocity(&self, a: &[Vector<f64>], b: &[Vector<f64>]) -> bool {
        let differences = a.iter().flatten().zip(b.iter().flatten()).zip(&self.mobility);
        differences.map(|((a, b), mobility)| (a - b).abs() / (mobility * self.speed)).all(|far| far < 1e-8)
    }
}
