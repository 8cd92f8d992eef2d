//! Infinite friction: a sticking contact is held whatever it takes, and one that slides has no normal impulse.

use super::{Condition, ContactLaw, Friction, Function, Impulse, Inequality, Mode};
use crate::scalar::Real;
use std::cmp::Ordering;

/// No bound on the tangential impulse: the cone a L_n >= b |L_t| with (a, b) = (1, 0).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unbounded;

impl<T: Real> ContactLaw<T> for Unbounded {
    fn friction(&self) -> Friction<T> {
        Friction::Infinite
    }

    fn modes(&self) -> &'static [&'static [Mode]] {
        &[&[Mode::Separate], &[Mode::Stick], &[Mode::SlidePlus], &[Mode::SlideMinus]]
    }

    #[inline]
    fn impulse(&self, mode: Mode) -> Impulse<T> {
        match mode {
            Mode::Separate => Impulse::Zero,
            Mode::Stick => Impulse::Free,
            Mode::SlidePlus | Mode::SlideMinus => Impulse::Along([T::from_f64(-mode.direction()), T::zero()]),
        }
    }

    #[inline]
    fn impulse_conditions(&self, mode: Mode, mut visit: impl FnMut(Condition<T>)) {
        let inequality = match mode {
            Mode::Separate => return,
            Mode::Stick => Inequality::NormalImpulse,
            Mode::SlidePlus | Mode::SlideMinus => Inequality::TangentialImpulse,
        };
        visit(Condition { inequality, function: Function::Second });
    }

    fn beyond(&self, mode: Mode, _: Inequality, tangential: Ordering) -> Vec<Mode> {
        match (mode, tangential) {
            (Mode::Stick, Ordering::Equal) => vec![Mode::Separate, Mode::SlidePlus, Mode::SlideMinus],
            // Friction acts against the slide.
            (Mode::Stick, tangential) => vec![Mode::closed(tangential.reverse())],
            _ => vec![Mode::Separate],
        }
    }
}
