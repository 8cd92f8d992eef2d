//! A motion carried on from its last rows, to a moment at which there is no row.

/// A motion is carried on by so many times the distance of its last rows at most.
pub(super) const REACH: f64 = 2.5;

/// How much later \[s\] than the last of some rows the parabola through the values at the last three (a line where there
/// are two) is down at `level`, if it gets there at all, and the rows are not too near to each other for a moment `most`
/// later. Their `times` and values are given the last one first.
pub(super) fn down_to(level: f64, times: &[f64], value: impl Fn(usize) -> f64, most: f64) -> Option<f64> {
    let &[last, before, ..] = times else { return None };
    let (step, rate) = (last - before, (value(0) - value(1)) / (last - before));
    let curvature = times.get(2).map_or(0.0, |earlier| {
        let earlier_rate = (value(1) - value(2)) / (before - earlier);
        (rate - earlier_rate) / (last - earlier)
    });
    let (slope, height) = (rate + curvature * step, value(0) - level);
    let discriminant = slope * slope - 4.0 * curvature * height;
    // Of two roots the first; the usual formula would cancel digits where the curvature is small.
    let later = 2.0 * height / (discriminant.sqrt() - slope);
    (most <= REACH * step && later.is_finite() && later >= 0.0).then_some(later)
}

/// How the values at some moments, or rather their polynomial, give that at another.
#[derive(Debug, Clone)]
pub(super) struct Interpolation {
    /// Of each moment in the value, and in its rate \[1/s\].
    weights: Vec<(f64, f64)>,
}

impl Interpolation {
    /// At `time`, from values at different `times`: Lagrange's polynomial.
    pub fn at(time: f64, times: &[f64]) -> Self {
        let others = |own: usize| (0..times.len()).filter(move |&other| other != own);
        let weights = (0..times.len()).map(|own| {
            let factor = |other: usize| (time - times[other]) / (times[own] - times[other]);
            let without = |left: usize| others(own).filter(move |&other| other != left).map(factor).product::<f64>();
            let rate = others(own).map(|other| without(other) / (times[own] - times[other])).sum();
            (others(own).map(factor).product(), rate)
        });
        Self { weights: weights.collect() }
    }

    /// At `time`, from values at at least two different `times`: the line of least squares.
    pub fn along(time: f64, times: &[f64]) -> Self {
        // The number of rows of a window.
        #[allow(clippy::cast_precision_loss)]
        let share = 1.0 / times.len() as f64;
        let middle = share * times.iter().sum::<f64>();
        let spread: f64 = times.iter().map(|own| (own - middle) * (own - middle)).sum();
        let rate = |own: &f64| (own - middle) / spread;
        Self { weights: times.iter().map(|own| (share + (time - middle) * rate(own), rate(own))).collect() }
    }

    /// How much the value differs from that recorded if all have a noise of one.
    pub fn noise(&self) -> f64 {
        self.weights.iter().fold(1.0, |sum, (weight, _)| sum + weight * weight).sqrt()
    }

    pub fn value(&self, value: impl Fn(usize) -> f64) -> f64 {
        self.weights.iter().enumerate().map(|(at, (weight, _))| weight * value(at)).sum()
    }

    pub fn rate(&self, value: impl Fn(usize) -> f64) -> f64 {
        self.weights.iter().enumerate().map(|(at, (_, weight))| weight * value(at)).sum()
    }
}

/// The value at `time` on the line through two others, each behind its time; the later one where that is too far away.
pub(super) fn on_line([(from, start), (to, end)]: [(f64, f64); 2], time: f64) -> f64 {
    if to > from && time - to <= REACH * (to - from) { end + (time - to) / (to - from) * (end - start) } else { end }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_carried_on_exactly() {
        let fall = |time: f64| 1.0 - 4.0 * time * time;
        let times = [0.375, 0.25, 0.0];
        let ahead = Interpolation::at(0.5, &times).value(|row| fall(times[row]));
        assert!((ahead - fall(0.5)).abs() < 1e-15, "{ahead}");
        assert_eq!(down_to(0.0, &times, |row| fall(times[row]), 0.25), Some(0.125));
        assert_eq!(down_to(2.0, &times, |row| fall(times[row]), 0.25), None);
    }

    #[test]
    fn least_squares_leave_the_middle_of_both_sides() {
        let times = [0.0, 1.0, 2.0, 3.0];
        let values = [1.0, 3.0, 5.0, 7.0];
        let exact = Interpolation::along(4.0, &times);
        assert_eq!((exact.value(|at| values[at]), exact.rate(|at| values[at])), (9.0, 2.0));
        let both = Interpolation::along(1.5, &times);
        assert_eq!(
            (both.value(|at| [1.0, -1.0, -1.0, 1.0][at]), both.rate(|at| [1.0, -1.0, -1.0, 1.0][at])),
            (0.0, 0.0)
        );
        assert_eq!(both.noise(), 1.25_f64.sqrt());
    }

    #[test]
    fn two_near_rows_carry_on_a_line() {
        let falling = |row: usize| [2.0, 3.0][row];
        assert_eq!(down_to(0.0, &[1.0, 0.5], falling, 1.0), Some(1.0));
        assert_eq!(down_to(0.0, &[1.0, 0.5], |_| 1.0, 1.0), None, "it does not fall");
        assert!(down_to(0.0, &[1.0], falling, 0.1).is_none() && down_to(0.0, &[1.0, 0.5], falling, 1.5).is_none());
        let line = [(1.0, 3.0), (2.0, 5.0)];
        assert_eq!([1.5, 2.5, 9.0].map(|time| on_line(line, time)), [4.0, 6.0, 5.0]);
        assert_eq!(on_line([(1.0, 3.0), (1.0, 5.0)], 1.5), 5.0);
    }
}
