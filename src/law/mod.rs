//! The contact law: what each mode demands of one contact's impulse and velocity.
//!
//! ```text
//!     velocity   separate  xi_n > 0    stick  c_t = xi_n = 0      slide+-  xi_n = 0,  +-c_t > 0   the same for every law
//!     impulse    separate  L = 0       stick  L free in its cone  slide+-  L = lambda (-+mu, 1), lambda >= 0
//! ```
//!
//! The velocities are those of [`Mode`], with restitution in xi ([`restitution`]). The impulses are each law's own: one
//! file per law, each a [`ContactLaw`] with the same methods in the same order, listed once in [`Law`]. Code that
//! enumerates, bounds or reads combinations asks the law, and matches on no mode and no friction itself.

mod inequality;
mod condition;
mod mode;
mod friction;
mod frictionless;
mod coulomb;
mod unbounded;
pub mod restitution;

pub use condition::{Condition, Function};
pub use coulomb::Coulomb;
pub use friction::Friction;
pub use frictionless::Frictionless;
pub use inequality::Inequality;
pub use mode::Mode;
pub use unbounded::Unbounded;

use crate::scalar::Real;
use std::cmp::Ordering;

/// The impulses that a mode admits before its inequalities are asked; as many unknowns as equations of its velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Impulse<T = f64> {
    /// L = 0.
    Zero,
    /// L = lambda times these entries, [tangential, normal].
    Along([T; 2]),
    /// Both entries are unknowns.
    Free,
}

/// What one contact's friction allows; `T` is the number of its coefficients.
pub trait ContactLaw<T: Real> {
    /// The friction as it is given and written.
    fn friction(&self) -> Friction<T>;

    /// The modes that the contact may take, in the order in which they are tried. Those of one group have the same
    /// impulses, so that one elimination serves them all; its first mode stands for the group.
    fn modes(&self) -> &'static [&'static [Mode]];

    /// The impulses of a mode.
    fn impulse(&self, mode: Mode) -> Impulse<T>;

    /// Calls `visit` with each inequality of a mode's impulse.
    fn impulse_conditions(&self, mode: Mode, visit: impl FnMut(Condition<T>));

    /// The modes that share velocity and impulse with a closed `mode` whose `inequality` is zero; `tangential` is the
    /// sign of L_t.
    fn beyond(&self, mode: Mode, inequality: Inequality, tangential: Ordering) -> Vec<Mode>;

    /// Calls `visit` with every inequality of a mode, that of its velocity last.
    #[inline]
    fn conditions(&self, mode: Mode, mut visit: impl FnMut(Condition<T>)) {
        self.impulse_conditions(mode, &mut visit);
        if let Some(condition) = mode.velocity_condition() {
            visit(condition);
        }
    }

    /// Whether c_t = 0 of a mode has no impulse to hold it: an equation more than unknowns.
    #[inline]
    fn is_unheld(&self, mode: Mode) -> bool {
        mode == Mode::Stick && !matches!(self.impulse(mode), Impulse::Free)
    }

    /// The mode that stands for those with the same impulses.
    fn representative(&self, mode: Mode) -> Mode {
        self.modes().iter().find(|group| group.contains(&mode)).map_or(mode, |group| group[0])
    }
}

/// Lists the laws: an enum of them all, which is the law that it holds.
macro_rules! laws {
    ($($(#[$doc:meta])* $name:ident($law:ty)),* $(,)?) => {
        /// The law of a contact.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Law<T = f64> {
            $($(#[$doc])* $name($law)),*
        }

        impl<T: Real> ContactLaw<T> for Law<T> {
            #[inline]
            fn friction(&self) -> Friction<T> {
                match self { $(Self::$name(law) => law.friction()),* }
            }

            #[inline]
            fn modes(&self) -> &'static [&'static [Mode]] {
                match self { $(Self::$name(law) => ContactLaw::<T>::modes(law)),* }
            }

            #[inline]
            fn impulse(&self, mode: Mode) -> Impulse<T> {
                match self { $(Self::$name(law) => law.impulse(mode)),* }
            }

            #[inline]
            fn impulse_conditions(&self, mode: Mode, visit: impl FnMut(Condition<T>)) {
                match self { $(Self::$name(law) => law.impulse_conditions(mode, visit)),* }
            }

            fn beyond(&self, mode: Mode, inequality: Inequality, tangential: Ordering) -> Vec<Mode> {
                match self { $(Self::$name(law) => ContactLaw::<T>::beyond(law, mode, inequality, tangential)),* }
            }
        }
    };
}

laws! {
    /// No friction.
    Frictionless(Frictionless),
    /// |L_t| <= mu L_n.
    Coulomb(Coulomb<T>),
    /// No bound on L_t.
    Unbounded(Unbounded),
}

impl From<Friction> for Law {
    fn from(friction: Friction) -> Self {
        match friction {
            _ if friction.is_zero() => Self::Frictionless(Frictionless),
            Friction::Finite(mu) => Self::Coulomb(Coulomb { mu }),
            Friction::Infinite => Self::Unbounded(Unbounded),
        }
    }
}
