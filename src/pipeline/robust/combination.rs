//! One combination of modes on a whole box: det A and the numerators of its inequalities, as polynomials.
//!
//! ```text
//!     A x + f = 0,   x_j = N_j / det A,   N_j = (-1)^(j+k) (minor of [A | f] without column j)         (Cramer)
//! ```
//!
//! Unknowns: two impulses of a sticking contact, one along the ray of a sliding (or frictionless closed) contact.

use crate::law::{Impulse, Inequality, Law, Mode};
use crate::scalar::{Ordered, Sign};

/// A contact problem on a box.
#[derive(Debug)]
pub(super) struct UncertainProblem<T> {
    /// G, 2n x 2n by rows \[1/kg\].
    pub delassus: Vec<T>,
    /// For each row the velocity without impulses; normal rows include the bounce \[m/s\].
    pub free: Vec<T>,
    /// The law of each contact.
    pub laws: Vec<Law<T>>,
}

/// The equations and inequalities of a combination, all multiplied by det A.
#[derive(Debug, Default)]
pub(super) struct BoxCombination<T> {
    /// det A, up to a sign that the numerators share.
    pub determinant: T,
    /// Each numerator with the inequality that it must satisfy after the division by det A. Without one, it is c_t of a
    /// frictionless sticking contact, and must be zero.
    pub numerators: Vec<(Option<Inequality>, T)>,
    /// One entry per unknown: the row of its equation, its contact, and the ray's entries [tangential, normal].
    columns: Vec<(usize, usize, [T; 2])>,
    minors: Vec<T>,
}

impl<T: Ordered> UncertainProblem<T> {
    pub fn contacts(&self) -> usize {
        self.laws.len()
    }

    fn entry(&self, row: usize, (_, contact, ray): (usize, usize, [T; 2])) -> T {
        let at = row * 2 * self.contacts() + 2 * contact;
        self.delassus[at] * ray[0] + self.delassus[at + 1] * ray[1]
    }

    /// Computes the combination `modes` into `into`.
    pub fn combine(&self, modes: &[Mode], into: &mut BoxCombination<T>) {
        let [zero, one] = [T::zero(), T::one()];
        into.columns.clear();
        for (contact, (&mode, law)) in modes.iter().zip(&self.laws).enumerate() {
            let (tangential, normal) = (2 * contact, 2 * contact + 1);
            match law.impulse(mode) {
                Impulse::Zero => {}
                Impulse::Along(ray) => into.columns.push((normal, contact, ray)),
                Impulse::Free => {
                    into.columns.push((tangential, contact, [one, zero]));
                    into.columns.push((normal, contact, [zero, one]));
                }
            }
        }
        self.expand(into);
        self.read(modes, into);
    }

    /// Computes all minors of [A | f] of full height, each without one column, by expansion along row after row.
    fn expand(&self, into: &mut BoxCombination<T>) {
        let BoxCombination { columns, minors, .. } = into;
        let unknowns = columns.len();
        let width = unknowns + 1;
        minors.clear();
        minors.resize(1 << width, T::zero());
        minors[0] = T::one();
        // A set of columns comes after its subsets; its minor has as many rows as columns.
        for set in 1usize..1 << width {
            let height = set.count_ones() as usize;
            if height > unknowns {
                continue;
            }
            let row = columns[height - 1].0;
            let mut sum = T::zero();
            for (place, column) in (0..width).filter(|column| set >> column & 1 == 1).enumerate() {
                let entry = if column < unknowns { self.entry(row, columns[column]) } else { self.free[row] };
                let term = entry * minors[set & !(1 << column)];
                sum = if (height + place) % 2 == 1 { sum + term } else { sum - term };
            }
            minors[set] = sum;
        }
    }

    fn read(&self, modes: &[Mode], into: &mut BoxCombination<T>) {
        let BoxCombination { determinant, numerators, columns, minors } = into;
        let unknowns = columns.len();
        let all = (1usize << (unknowns + 1)) - 1;
        let numerator = |column: usize| {
            let minor = minors[all & !(1 << column)];
            if (column + unknowns).is_multiple_of(2) { minor } else { -minor }
        };
        let det = numerator(unknowns);
        // The velocity of a row times det A.
        let velocity = |row: usize| {
            let start = self.free[row] * det;
            columns.iter().enumerate().fold(start, |sum, (j, &column)| sum + self.entry(row, column) * numerator(j))
        };
        numerators.clear();
        let mut column = 0;
        for (contact, (&mode, law)) in modes.iter().zip(&self.laws).enumerate() {
            let (tangential, normal) = (2 * contact, 2 * contact + 1);
            let impulse = law.impulse(mode);
            let number = |which: usize| match (impulse, which) {
                (Impulse::Zero, _) => velocity(normal),
                (Impulse::Along(_), 0) => velocity(tangential),
                (Impulse::Along(_), _) => numerator(column),
                (Impulse::Free, which) => numerator(column + which),
            };
            law.conditions(mode, |inequality, function| {
                numerators.push((Some(inequality), function.at(number, |mu, impulse| mu * impulse)));
            });
            if law.is_unheld(mode) {
                numerators.push((None, velocity(tangential)));
            }
            column += impulse.unknowns();
        }
        *determinant = det;
    }
}

impl<T: Ordered> BoxCombination<T> {
    /// Returns whether it is an outcome of every state of the box, or of none; `None` if neither was shown.
    pub fn is_valid(&self) -> Option<bool> {
        let signs = || self.numerators.iter().map(|&(inequality, number)| (inequality, number.sign()));
        let has = |wanted: Sign| signs().any(|(inequality, sign)| inequality.is_some() && sign == wanted);
        let unequal = |(inequality, sign): (Option<_>, _)| {
            inequality.is_none() && matches!(sign, Sign::Negative | Sign::Positive)
        };
        if signs().any(unequal) {
            // If det A = 0, a numerator other than zero means that the equations contradict each other.
            return Some(false);
        }
        let (good, bad) = match self.determinant.sign() {
            Sign::Positive => (Sign::Positive, Sign::Negative),
            Sign::Negative => (Sign::Negative, Sign::Positive),
            // This holds for either sign of det A: one of two opposite numerators violates its inequality.
            _ => return (has(Sign::Positive) && has(Sign::Negative)).then_some(false),
        };
        let violated = |(inequality, sign): (Option<Inequality>, Sign)| {
            sign == bad || (sign == Sign::Zero && inequality.is_some_and(Inequality::is_strict))
        };
        if signs().any(violated) {
            return Some(false);
        }
        let satisfied =
            |(inequality, sign): (Option<_>, Sign)| sign == Sign::Zero || (sign == good && inequality.is_some());
        signs().all(satisfied).then_some(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::ContactProblem;
    use crate::impact::enumerate::Tableau;
    use crate::law::Friction;
    use crate::scalar::{Ball, Real};
    use proptest::prelude::*;

    const COUNT: usize = 3;

    fn lists() -> impl Iterator<Item = Vec<Mode>> {
        (0..64usize).map(|number| (0..COUNT).map(|contact| Mode::ALL[number >> (2 * contact) & 3]).collect())
    }

    proptest! {
        /// Compares with the elimination of the ordinary analysis.
        #[test]
        fn numerators_match_elimination(
            root in prop::array::uniform32(-1.0..1.0f64), more in prop::array::uniform4(-1.0..1.0f64),
            before in prop::array::uniform6(-1.0..1.0f64), mu in 0.1..2.0f64,
        ) {
            let rows = 2 * COUNT;
            let root: Vec<f64> = root.into_iter().chain(more).collect();
            let entry = |i: usize, j: usize| -> f64 {
                let product: f64 = (0..rows).map(|k| root[i * rows + k] * root[j * rows + k]).sum();
                product + if i == j { 0.5 } else { 0.0 }
            };
            let delassus: Vec<f64> = (0..rows * rows).map(|at| entry(at / rows, at % rows)).collect();
            let friction = vec![Friction::Finite(mu), Friction::Infinite, Friction::Finite(2.0 * mu)];
            let velocity: Vec<[f64; 2]> = before.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
            let problem = ContactProblem::new(delassus.clone(), velocity, friction.clone(), vec![0.0; COUNT]).unwrap();
            let ball = Ball::<f64>::from_f64;
            let numbers = UncertainProblem {
                delassus: delassus.into_iter().map(ball).collect(),
                free: before.into_iter().map(ball).collect(),
                laws: [Some(mu), None, Some(2.0 * mu)]
                    .map(|mu| mu.map_or(Law::Unbounded, |mu| Law::Coulomb(ball(mu))))
                    .into(),
            };
            let (mut tableau, mut found) = (Tableau::default(), BoxCombination::default());
            let delassus = |row: usize, column: usize| numbers.delassus[row * rows + column];
            tableau.load_entries(problem.laws(), delassus, |row| numbers.free[row]);
            // Both have error bounds, which grow without limit as a pivot approaches zero.
            let differ = |one: Ball<f64>, other: Ball<f64>| matches!((one - other).sign(), Sign::Negative | Sign::Positive);
            for modes in lists() {
                numbers.combine(&modes, &mut found);
                let leaf = tableau.leaf(&modes);
                let product = leaf.pivots.iter().fold(ball(1.0), |product, &pivot| product * pivot);
                prop_assert!(!differ(found.determinant, product), "{modes:?}");
                let mut expected = Vec::new();
                crate::impact::slack::slacks(&leaf, &modes, problem.laws(), |slack| expected.push(slack.number));
                prop_assert_eq!(expected.len(), found.numerators.len());
                for (slack, &(_, numerator)) in expected.into_iter().zip(&found.numerators) {
                    prop_assert!(!differ(numerator, slack * product), "{modes:?}");
                }
            }
        }
    }

    #[test]
    fn opposite_numerators_reject_across_a_pole() {
        let wide = |mid: f64| Ball { mid, radius: 0.1 };
        let mut found = BoxCombination { determinant: wide(0.0), ..BoxCombination::default() };
        found.numerators =
            vec![(Some(Inequality::NormalImpulse), wide(1.0)), (Some(Inequality::NormalVelocity), wide(-1.0))];
        assert_eq!(found.is_valid(), Some(false));
        found.numerators[1].1 = wide(1.0);
        assert_eq!(found.is_valid(), None);
        found.determinant = wide(1.0);
        assert_eq!(found.is_valid(), Some(true));
        found.determinant = wide(-1.0);
        assert_eq!(found.is_valid(), Some(false));
    }

    #[test]
    fn exact_zeros_count_as_the_strict_modes_have_it() {
        let ball = Ball::<f64>::from_f64;
        let mut found = BoxCombination { determinant: ball(1.0), ..BoxCombination::default() };
        for (inequality, valid) in
            [(Some(Inequality::NormalImpulse), true), (None, true), (Some(Inequality::NormalVelocity), false)]
        {
            found.numerators = vec![(inequality, ball(0.0))];
            assert_eq!(found.is_valid(), Some(valid));
        }
        found.numerators = vec![(None, ball(-0.5))];
        assert_eq!(found.is_valid(), Some(false));
    }
}
