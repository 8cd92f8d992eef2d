//! Extrapolation of a motion from its last rows to a moment between rows.

/// The longest extrapolation, as a multiple of the distance of the last rows.
pub(super) const REACH: f64 = 2.5;

/// Returns the time \[s\] until the parabola through the last values (a line through two) falls to `level`; `None`
/// if it never does, or if `most` is more than [`REACH`] steps. `times` and values begin with the last row.
pub(super) fn down_to(level: f64, times: &[f64], value: impl Fn(usize) -> f64, most: f64) -> Option<f64> {
    let &[last, before, ..] = times else { return None };
    let (step, rate) = (last - before, (value(0) - value(1)) / (last - before));
    let curvature = times.get(2).map_or(0.0, |earlier| {
        let earlier_rate = (value(1) - value(2)) / (before - earlier);
        (rate - earlier_rate) / (last - earlier)
    });
    let (slope, height) = (rate + curvature * step, value(0) - level);
    let discriminant = slope * slope - 4.0 * curvature * height;
    // This is the first of two roots. The usual formula would cancel digits if the curvature is small.
    let later = 2.0 * height / (discriminant.sqrt() - slope);
    (most <= REACH * step && later.is_finite() && later >= 0.0).then_some(later)
}

/// Weights of an interpolation or extrapolation: the value at a moment from the values at other moments.
#[derive(Debug, Clone)]
pub(super) struct Interpolation {
    /// For each of these moments, its weight in the value and in the rate \[1/s\].
    weights: Vec<(f64, f64)>,
}

impl Interpolation {
    /// Weights for the value at `time` from values at different `times`, by Lagrange's polynomial.
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

    /// Weights for the value at `time` from values at two or more different `times`, by the least-squares line.
    pub fn along(time: f64, times: &[f64]) -> Self {
        // The count is the number of rows of a window, so it is exact as an f64.
        #[allow(clippy::cast_precision_loss)]
        let share = 1.0 / times.len() as f64;
        let middle = share * times.iter().sum::<f64>();
        let spread: f64 = times.iter().map(|moment| (moment - middle) * (moment - middle)).sum();
        let rate = |moment: &f64| (moment - middle) / spread;
        Self { weights: times.iter().map(|moment| (share + (time - middle) * rate(moment), rate(moment))).collect() }
    }

    /// Returns the standard deviation of the difference from a recorded value if all values have a noise of one.
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

/// Returns the value at `time` on the line through two others, each after its time; the later one if that is too far.
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
