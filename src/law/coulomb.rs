//! Coulomb friction: |L_t| <= mu L_n, and a sliding contact is resisted by all of it.

use super::{Condition, ContactLaw, Friction, Function, Impulse, Inequality, Mode};
use crate::scalar::Real;
use std::cmp::Ordering;

/// A finite coefficient of friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb<T = f64> {
    /// The coefficient.
    pub mu: T,
}

impl<T: Real> ContactLaw<T> for Coulomb<T> {
    fn friction(&self) -> Friction<T> {
        Friction::Finite(self.mu)
    }

    fn modes(&self) -> &'static [&'static [Mode]] {
        &[&[Mode::Separate], &[Mode::Stick], &[Mode::SlidePlus], &[Mode::SlideMinus]]
    }

    #[inline]
    fn impulse(&self, mode: Mode) -> Impulse<T> {
        match mode {
            Mode::Separate => Impulse::Zero,
            Mode::Stick => Impulse::Free,
            Mode::SlidePlus | Mode::SlideMinus => Impulse::Along([T::from_f64(-mode.direction()) * self.mu, T::one()]),
        }
    }

    #[inline]
    fn impulse_conditions(&self, mode: Mode, mut visit: impl FnMut(Condition<T>)) {
        if mode == Mode::Separate {
            return;
        }
        visit(Condition { inequality: Inequality::NormalImpulse, function: Function::Second });
        if mode == Mode::Stick {
            visit(Condition { inequality: Inequality::FrictionCone, function: Function::ConeMinus(self.mu) });
            visit(Condition { inequality: Inequality::FrictionCone, function: Function::ConePlus(self.mu) });
        }
    }

    fn beyond(&self, mode: Mode, inequality: Inequality, tangential: Ordering) -> Vec<Mode> {
        match (mode, inequality) {
            // Friction acts against the slide.
            (Mode::Stick, Inequality::FrictionCone) => vec![Mode::closed(tangential.reverse())],
            (Mode::Stick, _) => vec![Mode::Separate, Mode::SlidePlus, Mode::SlideMinus],
            _ => vec![Mode::Separate],
        }
    }
}
