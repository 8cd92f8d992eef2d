//! The contact law: the conditions of each mode on the impulse and velocity of a contact.
//!
//! ```text
//!     velocity   separate  xi_n > 0    stick  c_t = xi_n = 0      slide+-  xi_n = 0,  +-c_t > 0   for every law
//!     impulse    separate  L = 0       stick  L free in its cone  slide+-  L = lambda (-+mu, 1), lambda >= 0
//! ```
//!
//! The conditions on velocities are those of [`Mode`], with Newton's restitution in Moreau's form: xi_n = c_n+ + e
//! min(c_n-, 0). The conditions on impulses depend on the law. All of a law is in [`Law`]: code that enumerates, bounds
//! or checks combinations calls it, and does not match on modes or friction itself.
//!
//! In sustained contact, the same conditions hold for contacts at rest, with forces in place of impulses and
//! accelerations in place of velocities. A contact that already slides has a given direction, which also determines the
//! direction of its friction:
//!
//! ```text
//!     separate  a_n > 0,  f = 0        slide+-  a_n = 0,  f = lambda (-+mu, 1), lambda >= 0,  a_t any
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

/// The impulses that a mode admits, before its inequalities. They have as many unknowns as the mode has velocity
/// equations, except where [`Law::is_unheld`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Impulse<T = f64> {
    /// L = 0.
    Zero,
    /// L = lambda times these entries [tangential, normal].
    Along([T; 2]),
    /// Both entries are unknowns.
    Free,
}

impl<T> Impulse<T> {
    /// The number of unknowns.
    pub(crate) fn unknowns(&self) -> usize {
        match self {
            Self::Zero => 0,
            Self::Along(_) => 1,
            Self::Free => 2,
        }
    }
}

/// The law of a contact; `T` is the number type of its coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Law<T = f64> {
    /// No friction: the impulse is normal. Whether a closed contact sticks or slides depends on the other contacts.
    Frictionless,
    /// Coulomb's law with coefficient mu: |L_t| <= mu L_n, with equality for a sliding contact, against its motion.
    Coulomb(T),
    /// Infinite friction: L_t has no bound. A sliding contact has no normal impulse.
    Unbounded,
    /// In sustained contact, a contact that already slides as this mode says: it keeps sliding or separates.
    Sliding(Friction<T>, Mode),
}

impl<T: Real> Law<T> {
    /// The friction of the law, as given in states and written in results.
    pub fn friction(&self) -> Friction<T> {
        match *self {
            Self::Frictionless => Friction::Finite(T::zero()),
            Self::Coulomb(mu) => Friction::Finite(mu),
            Self::Unbounded => Friction::Infinite,
            Self::Sliding(friction, _) => friction,
        }
    }

    /// The modes that the contact may take, in groups and in the order in which they are tried. Modes of one group have
    /// the same impulses, so that one elimination serves them all; the first mode represents the group.
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

    /// The signs that a mode requires of [c_t, xi_n] after the impact, as [`Mode::velocity`]; for a contact that
    /// already slides, of its acceleration. `None` for an entry of any sign.
    pub fn velocity(&self, mode: Mode) -> [Option<Ordering>; 2] {
        let [tangential, normal] = mode.velocity();
        [if matches!(self, Self::Sliding(..)) { None } else { tangential }, normal]
    }

    /// Whether L . xi <= 0 holds in every mode. It need not for a contact that already slides, whose friction does not
    /// depend on its acceleration.
    pub fn is_dissipative(&self) -> bool {
        !matches!(self, Self::Sliding(..))
    }

    /// The mode of a closed contact whose tangential velocity has this sign.
    pub fn closed(&self, velocity: Ordering) -> Mode {
        if let Self::Sliding(_, mode) = self { *mode } else { Mode::closed(velocity) }
    }

    /// The first mode with the same impulses as `mode`, which represents its group.
    pub fn representative(&self, mode: Mode) -> Mode {
        self.modes().iter().find(|group| group.contains(&mode)).map_or(mode, |group| group[0])
    }

    /// The impulses that a contact in this mode can have.
    #[inline]
    pub fn impulse(&self, mode: Mode) -> Impulse<T> {
        match (*self, mode) {
            (_, Mode::Separate) => Impulse::Zero,
            // Minus zero, so that the product with a negative lambda is plus zero.
            (Self::Frictionless, _) => Impulse::Along([T::from_f64(-0.0), T::one()]),
            (Self::Coulomb(_) | Self::Unbounded, Mode::Stick) => Impulse::Free,
            // In every closed mode a sliding contact's friction acts against the given direction.
            (Self::Coulomb(mu), mode) | (Self::Sliding(Friction::Finite(mu), mode), _) => {
                Impulse::Along([T::from_f64(-mode.direction()) * mu, T::one()])
            }
            (Self::Unbounded, mode) | (Self::Sliding(Friction::Infinite, mode), _) => {
                Impulse::Along([T::from_f64(-mode.direction()), T::zero()])
            }
        }
    }

    /// The rays that span the cone of the impulses of all modes, and whether the cone holds the opposite of each, too.
    pub fn rays(&self) -> Vec<([T; 2], bool)> {
        let (zero, one) = (T::zero(), T::one());
        match *self {
            Self::Frictionless => vec![([zero, one], false)],
            Self::Coulomb(mu) => vec![([-mu, one], false), ([mu, one], false)],
            Self::Unbounded => vec![([one, zero], true), ([zero, one], false)],
            Self::Sliding(_, mode) => match self.impulse(mode) {
                Impulse::Along(ray) => vec![(ray, false)],
                _ => Vec::new(),
            },
        }
    }

    /// Calls `visit` with every inequality of a mode; that of its velocity comes last.
    #[inline]
    pub fn conditions(&self, mode: Mode, mut visit: impl FnMut(Inequality, Function<T>)) {
        match (self, mode) {
            (_, Mode::Separate) => return visit(Inequality::NormalVelocity, Function::Second),
            (Self::Unbounded, Mode::SlidePlus | Mode::SlideMinus) | (Self::Sliding(Friction::Infinite, _), _) => {
                visit(Inequality::TangentialImpulse, Function::Second);
            }
            (Self::Frictionless | Self::Coulomb(_) | Self::Unbounded | Self::Sliding(..), _) => {
                visit(Inequality::NormalImpulse, Function::Second);
            }
        }
        match (self, mode) {
            (&Self::Coulomb(mu), Mode::Stick) => {
                visit(Inequality::FrictionCone, Function::ConeMinus(mu));
                visit(Inequality::FrictionCone, Function::ConePlus(mu));
            }
            (Self::Sliding(..), _) | (_, Mode::Stick | Mode::Separate) => {}
            (_, Mode::SlidePlus) => visit(Inequality::TangentialVelocity, Function::First),
            (_, Mode::SlideMinus) => visit(Inequality::TangentialVelocity, Function::MinusFirst),
        }
    }

    /// Whether the mode demands c_t = 0 although no impulse can enforce it: one more equation than unknowns.
    #[inline]
    pub fn is_unheld(&self, mode: Mode) -> bool {
        mode == Mode::Stick && matches!(self, Self::Frictionless | Self::Sliding(..))
    }

    /// The modes that have the same velocity and impulse as a closed `mode` whose `inequality` is zero; `tangential` is
    /// the sign of L_t. Frictionless slides are not included, since their direction changes without a border.
    pub fn beyond(&self, mode: Mode, inequality: Inequality, tangential: Ordering) -> Vec<Mode> {
        let at_edge = match self {
            Self::Frictionless | Self::Sliding(..) => return vec![Mode::Separate],
            Self::Coulomb(_) => inequality == Inequality::FrictionCone,
            Self::Unbounded => tangential.is_ne(),
        };
        match mode {
            // Friction opposes the slide.
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
