//! The contact law: what each mode demands of one contact's impulse and velocity.
//!
//! ```text
//!     velocity   separate  xi_n > 0    stick  c_t = xi_n = 0      slide+-  xi_n = 0,  +-c_t > 0   the same for every law
//!     impulse    separate  L = 0       stick  L free in its cone  slide+-  L = lambda (-+mu, 1), lambda >= 0
//! ```
//!
//! The velocities are those of [`Mode`], with Newton's restitution in Moreau's form: xi_n = c_n+ + e min(c_n-, 0). The
//! impulses are each law's own, and all of a law is in [`Law`]: code that enumerates, bounds or reads combinations asks
//! it, and matches on no mode and no friction itself.
//!
//! In sustained contact the same holds with forces for impulses and accelerations for velocities, for contacts at rest.
//! One that slides already has a direction, and its friction with it:
//!
//! ```text
//!     separate  a_n > 0,  f = 0        slide+-  a_n = 0,  f = lambda (-+mu, 1), lambda >= 0,  whatever a_t is
//! ```

mod inequality;
mod function;
mod mode;
mod friction;

pub use friction::Friction;
pub use function::Function;
pub use inequality::Inequality;
pub use mode::Mode;

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

/// The law of a contact; `T` is the number of its coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Law<T = f64> {
    /// No friction: the impulse is normal, and a closed contact sticks or slides as the others let it.
    Frictionless,
    /// |L_t| <= mu L_n, and a sliding contact is resisted by all of it.
    Coulomb(T),
    /// No bound on L_t: a sticking contact is held whatever it takes, and one that slides has no normal impulse.
    Unbounded,
    /// It slides already as this mode says, before any force acts: it slides on or separates.
    Sliding(Friction<T>, Mode),
}

impl<T: Real> Law<T> {
    /// The friction as it is given and written.
    pub fn friction(&self) -> Friction<T> {
        match *self {
            Self::Frictionless => Friction::Finite(T::zero()),
            Self::Coulomb(mu) => Friction::Finite(mu),
            Self::Unbounded => Friction::Infinite,
            Self::Sliding(friction, _) => friction,
        }
    }

    /// The modes that the contact may take, in the order in which they are tried. Those of one group have the same
    /// impulses, so that one elimination serves them all; its first mode stands for the group.
    pub fn modes(&self) -> &'static [&'static [Mode]] {
        match self {
            Self::Frictionless => &[&[Mode::Separate], &[Mode::Stick, Mode::SlidePlus, Mode::SlideMinus]],
            Self::Coulomb(_) | Self::Unbounded => {
                &[&[Mode::Separate], &[Mode::Stick], &[Mode::SlidePlus], &[Mode::SlideMinus]]
            }
            Self::Sliding(_, Mode::SlideMinus) => &[&[Mode::Separate], &[Mode::SlideMinus]],
            Self::Sliding(..) => &[&[Mode::Separate], &[Mode::SlidePlus]],
        }
    }

    /// The signs of the velocity after a mode, as [`Mode::velocity`] has them, or of the acceleration of a contact that
    /// slides already.
    pub fn velocity(&self, mode: Mode) -> [Option<Ordering>; 2] {
        let [tangential, normal] = mode.velocity();
        [if matches!(self, Self::Sliding(..)) { None } else { tangential }, normal]
    }

    /// Whether L . xi <= 0 in every mode. Friction on a contact that slides already does not ask for its acceleration.
    pub fn is_dissipative(&self) -> bool {
        !matches!(self, Self::Sliding(..))
    }

    /// The mode of a closed contact whose tangential velocity has this sign.
    pub fn closed(&self, velocity: Ordering) -> Mode {
        if let Self::Sliding(_, mode) = self { *mode } else { Mode::closed(velocity) }
    }

    /// The mode that stands for those with the same impulses.
    pub fn representative(&self, mode: Mode) -> Mode {
        self.modes().iter().find(|group| group.contains(&mode)).map_or(mode, |group| group[0])
    }

    /// Which impulses a contact of this mode can have.
    #[inline]
    pub fn impulse(&self, mode: Mode) -> Impulse<T> {
        match (*self, mode) {
            (_, Mode::Separate) => Impulse::Zero,
            // Minus zero: times the lambda of a contact that is pulled it is a plain zero.
            (Self::Frictionless, _) => Impulse::Along([T::from_f64(-0.0), T::one()]),
            // However it is closed, its friction has its direction.
            (Self::Sliding(friction, mode), _) => match friction {
                Friction::Finite(mu) => Impulse::Along([T::from_f64(-mode.direction()) * mu, T::one()]),
                Friction::Infinite => Impulse::Along([T::from_f64(-mode.direction()), T::zero()]),
            },
            (_, Mode::Stick) => Impulse::Free,
            (Self::Coulomb(mu), _) => Impulse::Along([T::from_f64(-mode.direction()) * mu, T::one()]),
            (Self::Unbounded, _) => Impulse::Along([T::from_f64(-mode.direction()), T::zero()]),
        }
    }

    /// The rays of the convex cone that holds the impulses of all modes, and of each whether its opposite does so, too.
    pub fn rays(&self) -> Vec<([T; 2], bool)> {
        let (zero, one) = (T::zero(), T::one());
        match *self {
            Self::Frictionless => vec![([zero, one], false)],
            Self::Coulomb(mu) => vec![([-mu, one], false), ([mu, one], false)],
            Self::Unbounded => vec![([one, zero], true), ([zero, one], false)],
            Self::Sliding(_, mode) => match self.impulse(mode) {
                Impulse::Along(ray) => vec![(ray, false)],
                Impulse::Zero | Impulse::Free => Vec::new(),
            },
        }
    }

    /// Calls `visit` with every inequality of a mode, that of its velocity last.
    #[inline]
    pub fn conditions(&self, mode: Mode, mut visit: impl FnMut(Inequality, Function<T>)) {
        let pushed = match (self, mode) {
            (_, Mode::Separate) => None,
            (Self::Unbounded, Mode::SlidePlus | Mode::SlideMinus) | (Self::Sliding(Friction::Infinite, _), _) => {
                Some(Inequality::TangentialImpulse)
            }
            (Self::Frictionless | Self::Coulomb(_) | Self::Unbounded | Self::Sliding(..), _) => {
                Some(Inequality::NormalImpulse)
            }
        };
        let moved = match mode {
            Mode::Separate => Some((Inequality::NormalVelocity, Function::Second)),
            Mode::SlidePlus | Mode::SlideMinus if matches!(self, Self::Sliding(..)) => None,
            Mode::SlidePlus => Some((Inequality::TangentialVelocity, Function::First)),
            Mode::SlideMinus => Some((Inequality::TangentialVelocity, Function::MinusFirst)),
            Mode::Stick => None,
        };
        if let Some(inequality) = pushed {
            visit(inequality, Function::Second);
        }
        if let (&Self::Coulomb(mu), Mode::Stick) = (self, mode) {
            visit(Inequality::FrictionCone, Function::ConeMinus(mu));
            visit(Inequality::FrictionCone, Function::ConePlus(mu));
        }
        if let Some((inequality, function)) = moved {
            visit(inequality, function);
        }
    }

    /// Whether c_t = 0 of a mode has no impulse to hold it: an equation more than unknowns.
    #[inline]
    pub fn is_unheld(&self, mode: Mode) -> bool {
        mode == Mode::Stick && matches!(self, Self::Frictionless | Self::Sliding(..))
    }

    /// The modes that share velocity and impulse with a closed `mode` whose `inequality` is zero; `tangential` is the
    /// sign of L_t. Without friction the direction of a slide changes without a border.
    pub fn beyond(&self, mode: Mode, inequality: Inequality, tangential: Ordering) -> Vec<Mode> {
        let at_edge = match self {
            Self::Frictionless | Self::Sliding(..) => return vec![Mode::Separate],
            Self::Coulomb(_) => inequality == Inequality::FrictionCone,
            Self::Unbounded => tangential.is_ne(),
        };
        match mode {
            // Friction acts against the slide.
            Mode::Stick if at_edge => vec![Mode::closed(tangential.reverse())],
            Mode::Stick => vec![Mode::Separate, Mode::SlidePlus, Mode::SlideMinus],
            _ => vec![Mode::Separate],
        }
    }
}

impl<T: Real + PartialEq> From<Friction<T>> for Law<T> {
    fn from(friction: Friction<T>) -> Self {
        match friction {
            Friction::Finite(mu) if mu == T::zero() => Self::Frictionless,
            Friction::Finite(mu) => Self::Coulomb(mu),
            Friction::Infinite => Self::Unbounded,
        }
    }
}
