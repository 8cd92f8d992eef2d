//! Integrates the stiff equations of a compliant impact, from its first moment until nothing more happens.
//!
//! ```text
//!     y' = f(y):   z_i = h sum_j A_ij f(y + z_j),  i = 1..3,   y(t + h) = y + z_3          Radau IIA, order 5
//! ```
//!
//! The stages follow from a simplified Newton iteration, split by W = Z T^-T into one real and one complex system.
//! Source: Hairer and Wanner, *Solving ODEs II* (1996), section IV.8; constants and step control are those of their
//! code RADAU5. Cost: O(N^3) for a Jacobian and its factors, which steps of one size share, and O(N^2) for an
//! iteration.

use crate::{Error, Reason, Result};
use nalgebra::{Complex, DMatrix, DVector, Dyn, LU, Matrix3, MatrixXx3, Vector3};

/// The first step, in the model's own time: the damper's force is there at once.
const FIRST_STEP: f64 = 1e-6;
/// Attempted steps after which a run is given up.
const MOST_STEPS: usize = 5_000;
/// Steps before which no run has ended: all begin without forces.
const FEWEST_STEPS: usize = 2;

/// Where in a step the stages lie.
const NODES: [f64; 3] = [0.155_051_025_721_682_2, 0.644_948_974_278_317_8, 1.0];
/// Eigenvalues of A^-1: a real one and the parts of a complex pair.
const REAL: f64 = 3.637_834_252_744_496;
const ALPHA: f64 = 2.681_082_873_627_752_3;
const BETA: f64 = 3.050_430_199_247_410_5;
/// Weights of the stages in the error estimate.
const ERROR: Vector3<f64> = Vector3::new(-10.048_809_399_827_416, 1.382_142_733_160_749, -1.0 / 3.0);
/// T^T and T^-T, which make A^-1 block diagonal.
#[rustfmt::skip]
const TO_STAGES: Matrix3<f64> = Matrix3::new(
    9.123_239_487_089_295E-2, 2.417_179_327_071_07E-1, 9.660_481_826_150_93E-1,
    -1.412_552_950_209_542E-1, 2.041_293_522_937_999_4E-1, 1.0,
    -3.002_919_410_514_742_4E-2, 3.829_421_127_572_619E-1, 0.0,
);
#[rustfmt::skip]
const FROM_STAGES: Matrix3<f64> = Matrix3::new(
    4.325_579_890_063_155, -4.178_718_591_551_905, -5.028_726_349_457_868E-1,
    3.391_992_518_158_098_4E-1, -3.276_828_207_610_623_7E-1, 2.571_926_949_855_605,
    5.417_705_399_358_749E-1, 4.766_235_545_005_504_4E-1, -5.960_392_048_282_249E-1,
);
/// W's part in the residual, times the step.
const BLOCKS: Matrix3<f64> = Matrix3::new(REAL, 0.0, 0.0, 0.0, ALPHA, BETA, 0.0, -BETA, ALPHA);

/// Newton iterations of a step, and the part of the tolerance to which they converge.
const MOST_ITERATIONS: i32 = 7;
const CONVERGED: f64 = 0.003_162_277_660_168_379_4;
/// Newton iterations that contract faster than this may keep the Jacobian.
const FAST: f64 = 1e-3;
/// A step shrinks to an eighth or grows fivefold at most, and by less than this not at all.
const SHRINKAGE: f64 = 5.0;
const GROWTH: f64 = 0.125;
const WORTHWHILE: f64 = 1.2;
const SAFETY: f64 = 0.9;

/// Equations of an impact in units in which times and states are of order one.
pub(super) trait Equations {
    /// f(y).
    fn rates(&self, state: &[f64]) -> Vec<f64>;

    /// Their derivatives at a state and its rates; forward differences unless the model knows better.
    fn jacobian(&self, state: &[f64], rates: &[f64]) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(state.len(), state.len());
        let mut moved = state.to_vec();
        for (column, &entry) in state.iter().enumerate() {
            let by = f64::EPSILON.sqrt() * entry.abs().max(1.0);
            moved[column] += by;
            for (row, rate) in self.rates(&moved).into_iter().enumerate() {
                jacobian[(row, column)] = (rate - rates[row]) / by;
            }
            moved[column] = entry;
        }
        jacobian
    }

    /// Whether nothing more happens from `state` on.
    fn has_ended(&self, state: &[f64]) -> bool;
}

/// Where a run came to.
#[derive(Debug, Clone)]
pub(super) struct End {
    /// The last state.
    pub state: DVector<f64>,
    /// Steps of the integrator, the start included.
    pub steps: usize,
    /// Whether it ended before the horizon.
    pub ended: bool,
}

/// How well and how long to integrate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Relative tolerance.
    pub relative: f64,
    /// Absolute tolerance of every entry.
    pub absolute: f64,
    /// The longest run, in the model's own time.
    pub horizon: f64,
}

/// Integrates from `start`.
///
/// # Errors
/// [`Reason::Unsupported`] if the steps become too many or too small.
pub(super) fn integrate(model: &impl Equations, start: Vec<f64>, limits: Limits) -> Result<End> {
    // The error estimate is of order 3, the solution of order 5.
    let relative = 0.1 * limits.relative.powf(2.0 / 3.0);
    let absolute = relative * (limits.absolute / limits.relative);
    let scale = |state: &DVector<f64>| state.map(|entry| absolute + relative * entry.abs());
    let state = DVector::from_vec(start);
    let mut run = Radau {
        rates: DVector::from_vec(model.rates(state.as_slice())),
        scale: scale(&state),
        state,
        model,
        jacobian: None,
        factors: None,
        last: None,
    };
    let (mut time, mut step, mut steps, mut rejected) = (0.0, FIRST_STEP, 1, false);
    let mut accepted: Option<(f64, f64)> = None;
    for _ in 0..MOST_STEPS {
        step = step.min(limits.horizon - time);
        if step <= f64::EPSILON * time {
            return Err(gave_up("its steps become too small"));
        }
        let attempt = match run.attempt(step, rejected || accepted.is_none()) {
            Ok(attempt) => attempt,
            Err(shrinkage) => {
                (step, rejected) = (step * shrinkage, true);
                continue;
            }
        };
        let Attempt { stages, error, iterations, contraction } = attempt;
        let safety =
            SAFETY.min(SAFETY * f64::from(1 + 2 * MOST_ITERATIONS) / f64::from(iterations + 2 * MOST_ITERATIONS));
        let mut ratio = (error.powf(0.25) / safety).clamp(GROWTH, SHRINKAGE);
        if error >= 1.0 {
            step = if accepted.is_none() { 0.1 * step } else { step / ratio };
            rejected = true;
            continue;
        }
        if let Some((last_step, last_error)) = accepted {
            // Gustafsson's predictive controller.
            let predicted = last_step / step * (error * error / last_error).powf(0.25) / SAFETY;
            ratio = ratio.max(predicted.clamp(GROWTH, SHRINKAGE));
        }
        accepted = Some((step, error.max(1e-2)));
        time += step;
        run.state += stages.column(2);
        run.rates = DVector::from_vec(model.rates(run.state.as_slice()));
        run.scale = scale(&run.state);
        run.last = Some((step, stages));
        steps += 1;
        let ended = model.has_ended(run.state.as_slice());
        if (ended && steps > FEWEST_STEPS) || time >= limits.horizon {
            return Ok(End { state: run.state, steps, ended });
        }
        let next = if rejected { (step / ratio).min(step) } else { step / ratio };
        let kept = contraction < FAST && step < next && next < WORTHWHILE * step;
        step = if kept { step } else { next };
        rejected = false;
        if contraction >= FAST {
            run.jacobian = None;
        }
    }
    Err(gave_up("it takes too many steps"))
}

fn gave_up(why: &str) -> Error {
    Error::new(Reason::Unsupported(format!("the integration of the compliant contact ended early: {why}")))
        .hint("take another tolerance, or damping and friction that are less extreme")
}

struct Radau<'m, M> {
    model: &'m M,
    state: DVector<f64>,
    /// f at `state`.
    rates: DVector<f64>,
    /// The tolerance of each entry.
    scale: DVector<f64>,
    jacobian: Option<DMatrix<f64>>,
    factors: Option<Factors>,
    /// The last step and its stages.
    last: Option<(f64, MatrixXx3<f64>)>,
}

/// The factors of both systems of the Newton iteration, for steps of one size.
struct Factors {
    step: f64,
    real: LU<f64, Dyn, Dyn>,
    complex: LU<Complex<f64>, Dyn, Dyn>,
}

/// A step whose stages are found.
struct Attempt {
    /// What the state changes by until each stage.
    stages: MatrixXx3<f64>,
    /// The error in parts of the tolerance.
    error: f64,
    iterations: i32,
    /// What each Newton iteration leaves of the last one's change.
    contraction: f64,
}

impl<M: Equations> Radau<'_, M> {
    fn rates_at(&self, state: &DVector<f64>) -> DVector<f64> {
        DVector::from_vec(self.model.rates(state.as_slice()))
    }

    /// The root of the mean square in parts of the tolerance.
    fn size(&self, of: &DVector<f64>) -> f64 {
        (of.component_div(&self.scale).norm_squared() / of.len() as f64).sqrt()
    }

    /// Tries a step of this size; fails with the part of it to try next.
    fn attempt(&mut self, step: f64, careful: bool) -> std::result::Result<Attempt, f64> {
        let fresh = self.jacobian.is_none();
        let jacobian = self.jacobian.take();
        let jacobian = jacobian.unwrap_or_else(|| self.model.jacobian(self.state.as_slice(), self.rates.as_slice()));
        let factors = self.factors.take().filter(|factors| factors.step == step && !fresh);
        let factors = factors.unwrap_or_else(|| Factors::new(&jacobian, step));
        let attempt = self.newton(step, &factors).and_then(|(stages, iterations, contraction)| {
            let push = &stages * (ERROR / step);
            let mut off = factors.real.solve(&(&push + &self.rates)).ok_or(0.5)?;
            if careful && self.size(&off) >= 1.0 {
                off = factors.real.solve(&(self.rates_at(&(&self.state + off)) + push)).ok_or(0.5)?;
            }
            Ok(Attempt { stages, error: self.size(&off).max(1e-10), iterations, contraction })
        });
        // Where an old Jacobian leads nowhere, a new one is due.
        if attempt.is_ok() || fresh {
            (self.jacobian, self.factors) = (Some(jacobian), Some(factors));
        }
        attempt
    }

    /// The stages, and the iterations and their contraction.
    fn newton(&self, step: f64, factors: &Factors) -> std::result::Result<(MatrixXx3<f64>, i32, f64), f64> {
        let mut stages = self.guess(step);
        let mut transformed = &stages * FROM_STAGES;
        // How much the error exceeds the last change. Nothing is taken from the last step: a kink may lie between.
        let mut excess = 1.0;
        let (mut quotient, mut last_change, mut last_quotient) = (FAST, 0.0, 0.0);
        for iteration in 1..=MOST_ITERATIONS {
            let rates = stages.column_iter().map(|stage| self.rates_at(&(&self.state + stage)));
            let rates = MatrixXx3::from_columns(&rates.collect::<Vec<_>>());
            let residual = rates * FROM_STAGES - &transformed * (BLOCKS / step);
            let change = factors.solve(&residual).ok_or(0.5)?;
            let sizes = change.column_iter().map(|column| self.size(&column.into_owned()).powi(2));
            let size = (sizes.sum::<f64>() / 3.0).sqrt();
            if iteration > 1 && iteration < MOST_ITERATIONS {
                let now = size / last_change;
                quotient = if iteration == 2 { now } else { libm::sqrt(now * last_quotient) };
                last_quotient = now;
                if quotient.is_nan() || quotient >= 0.99 {
                    return Err(0.5);
                }
                excess = quotient / (1.0 - quotient);
                let left = MOST_ITERATIONS - 1 - iteration;
                let expected = excess * size * quotient.powi(left) / CONVERGED;
                if expected >= 1.0 {
                    return Err(0.8 * expected.clamp(1e-4, 20.0).powf(-1.0 / f64::from(4 + left)));
                }
            }
            last_change = size.max(1e-16);
            transformed += change;
            stages = &transformed * TO_STAGES;
            if excess * size <= CONVERGED {
                return Ok((stages, iteration, quotient));
            }
        }
        Err(0.5)
    }

    /// The last step's polynomial, continued.
    fn guess(&self, step: f64) -> MatrixXx3<f64> {
        let Some((last, stages)) = &self.last else { return MatrixXx3::zeros(self.state.len()) };
        let nodes = [NODES[0], NODES[1], NODES[2], 0.0];
        let weight = |stage: usize, at: f64| -> f64 {
            let others = (0..4).filter(|&other| other != stage);
            others.map(|other| (at - nodes[other]) / (nodes[stage] - nodes[other])).product()
        };
        let ahead = |stage: usize, next: usize| {
            weight(stage, 1.0 + NODES[next] * step / last) - if stage == 2 { 1.0 } else { 0.0 }
        };
        stages * Matrix3::from_fn(ahead)
    }
}

impl Factors {
    fn new(jacobian: &DMatrix<f64>, step: f64) -> Self {
        let shifted = |by: Complex<f64>| {
            let mut matrix = jacobian.map(|entry| Complex::new(-entry, 0.0));
            (0..matrix.nrows()).for_each(|k| matrix[(k, k)] += by / step);
            matrix
        };
        let real = shifted(Complex::new(REAL, 0.0)).map(|entry| entry.re);
        Self { step, real: real.lu(), complex: shifted(Complex::new(ALPHA, BETA)).lu() }
    }

    /// None if a factor is singular.
    fn solve(&self, residual: &MatrixXx3<f64>) -> Option<MatrixXx3<f64>> {
        let real = self.real.solve(&residual.column(0))?;
        let pair = residual.column(1).zip_map(&residual.column(2), Complex::new);
        let pair = self.complex.solve(&pair)?;
        Some(MatrixXx3::from_columns(&[real, pair.map(|entry| entry.re), pair.map(|entry| entry.im)]))
    }
}
