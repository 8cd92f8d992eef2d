//! Run times as medians with quartiles.

use serde::Serialize;
use std::time::{Duration, Instant};

/// Limits for measuring the run time of one method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// The total time for all runs except the first; a first run that alone takes this long is the only sample.
    pub time: Duration,
    /// The greatest number of samples.
    pub samples: usize,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { time: Duration::from_millis(20), samples: 101 }
    }
}

/// Seconds per run: the median of the samples, and the quartiles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Spread {
    /// A quarter of the samples is faster \[s\].
    pub lower_quartile: f64,
    /// Half of the samples is faster \[s\].
    pub median: f64,
    /// Three quarters of the samples are faster \[s\].
    pub upper_quartile: f64,
    /// The number of samples.
    pub samples: usize,
}

impl Spread {
    /// Returns the quartiles of `samples` \[s\]; NaN if there are none.
    pub fn of(mut samples: Vec<f64>) -> Self {
        samples.sort_by(f64::total_cmp);
        let [lower_quartile, median, upper_quartile] = [0.25, 0.5, 0.75].map(|share| quantile(&samples, share));
        Self { lower_quartile, median, upper_quartile, samples: samples.len() }
    }
}

/// Returns the value below which a `share` of the values lies, given in ascending order; NaN if there are none. Between
/// two values it is linear, so that the median of an even number is the mean of the middle two.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * sorted.len().saturating_sub(1) as f64;
    let at = |place: f64| sorted.get(place as usize).copied().unwrap_or(f64::NAN);
    let [below, above] = [place.floor(), place.ceil()].map(at);
    // The difference of two infinite values would be NaN.
    if below == above { below } else { below + (above - below) * place.fract() }
}

/// The least time of a sample, which repeats the work until then: the clock has a resolution of about 30 ns.
const SAMPLE: Duration = Duration::from_micros(20);

/// Measures the run time of `work` in repeated runs.
pub fn time<R>(sampling: Sampling, mut work: impl FnMut() -> R) -> Spread {
    let mut timed = |runs: u32| {
        let start = Instant::now();
        (0..runs).for_each(|_| drop(std::hint::black_box(work())));
        start.elapsed()
    };
    let first = timed(1);
    if first >= sampling.time {
        return Spread::of(vec![first.as_secs_f64()]);
    }
    // Caches are warm now.
    let warm = if first < SAMPLE { timed(8) / 8 } else { first };
    let runs = match SAMPLE.as_nanos() / warm.as_nanos().max(1) {
        _ if warm >= SAMPLE => 1,
        runs => runs.clamp(1, 100_000) as u32 + 1,
    };
    let start = Instant::now();
    let mut samples = Vec::new();
    while samples.len() < sampling.samples.max(1) && (samples.len() < 3 || start.elapsed() < sampling.time) {
        samples.push(timed(runs).as_secs_f64() / f64::from(runs));
    }
    Spread::of(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_lie_between_neighbors() {
        for (samples, expected) in
            [(vec![5.0, 1.0, 4.0, 2.0, 3.0], (2.0, 3.0, 4.0)), (vec![8.0, 1.0, 4.0, 2.0], (1.75, 3.0, 5.0))]
        {
            let spread = Spread::of(samples);
            assert_eq!((spread.lower_quartile, spread.median, spread.upper_quartile), expected);
        }
        assert_eq!(quantile(&[1.0, f64::INFINITY, f64::INFINITY], 0.75), f64::INFINITY);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn long_work_is_run_only_a_few_times() {
        let mut runs = 0;
        let sampling = Sampling { time: Duration::ZERO, samples: 7 };
        let spread = time(sampling, || runs += 1);
        assert_eq!((spread.samples, runs), (1, 1));
    }
}
