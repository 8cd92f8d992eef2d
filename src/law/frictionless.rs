//! No friction: the impulse is normal, and a closed contact sticks or slides as the others let it.

use super::{Condition, ContactLaw, Friction, Function, Impulse, Inequality, Mode};
use crate::scalar::Real;
use std::cmp::Ordering;

/// mu = 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frictionless;

impl<T: Real> ContactLaw<T> for Frictionless {
    fn friction(&self) -> Friction<T> {
        Friction::Finite(T::zero())
    }

    /// The modes of a closed contact differ in velocity alone.
    fn modes(&self) -> &'static [&'static [Mode]] {
        &[&[Mode::Separate], &[Mode::Stick, Mode::SlidePlus, Mode::SlideMinus]]
    }

    #[inline]
    fn impulse(&self, mode: Mode) -> Impulse<T> {
        match mode {
            Mode::Separate => Impulse::Zero,
            // Minus zero: times the lambda of a contact that is pulled it is a plain zero.
            Mode::Stick | Mode::SlidePlus | Mode::SlideMinus => Impulse::Along([T::from_f64(-0.0), T::one()]),
        }
    }

    #[inline]
    fn impulse_conditions(&self, mode: Mode, mut visit: impl FnMut(Condition<T>)) {
        if mode != Mode::Separate {
            visit(Condition { inequality: Inequality::NormalImpulse, function: Function::Second });
        }
    }

    /// The direction of a slide changes without a border.
    fn beyond(&self, _: Mode, _: Inequality, _: Ordering) -> Vec<Mode> {
        vec![Mode::Separate]
    }
}
