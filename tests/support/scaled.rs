//! Comparison with a reference, relative to a stated size, that collects all differences before it fails.

use nalgebra::DMatrix;
use std::borrow::Cow;

/// A matrix of a report.
type Rows<'a> = Option<Cow<'a, [Vec<f64>]>>;

/// The differences found so far.
#[derive(Debug, Default)]
pub struct Differences(Vec<String>);

impl Differences {
    /// Adds a difference.
    pub fn note(&mut self, place: &str, what: impl std::fmt::Display) {
        self.0.push(format!("{place}: {what}"));
    }

    /// Compares values that are not numbers.
    pub fn same<T: PartialEq + std::fmt::Debug>(&mut self, place: &str, is: T, should: T) {
        if is != should {
            self.note(place, format!("{is:?} instead of {should:?}"));
        }
    }

    /// Compares number by number; `tolerance` is absolute: a relative one times the size that it refers to.
    pub fn compare(&mut self, place: &str, is: &[f64], should: &[f64], tolerance: f64) {
        if is.len() != should.len() {
            return self.note(place, format!("{} numbers instead of {}", is.len(), should.len()));
        }
        if !near(is, should, tolerance) {
            let off = largest(&is.iter().zip(should).map(|(is, should)| is - should).collect::<Vec<_>>());
            self.note(place, format!("off by {off:.3e} of {tolerance:.3e}\n  is     {is:?}\n  should {should:?}"));
        }
    }

    /// Compares a matrix with a reference to `factor` times its largest entry; a missing matrix is a difference.
    pub fn compare_matrix(&mut self, place: &str, is: &Rows<'_>, should: &DMatrix<f64>, factor: f64) {
        let is = is.as_deref().unwrap_or_default();
        if is.len() != should.nrows() || is.iter().any(|row| row.len() != should.ncols()) {
            return self.note(place, format!("not {} x {}: {is:?}", should.nrows(), should.ncols()));
        }
        let should: Vec<f64> = should.row_iter().flat_map(|row| row.iter().copied().collect::<Vec<_>>()).collect();
        self.compare(place, &is.concat(), &should, factor * largest(&should));
    }

    /// Fails with all differences, if there are any.
    pub fn finish(self) {
        assert!(self.0.is_empty(), "{} differences:\n{}", self.0.len(), self.0.join("\n"));
    }
}

/// Whether both have the same length and their entries differ by at most `tolerance`; a NaN always differs.
pub fn near(is: &[f64], should: &[f64], tolerance: f64) -> bool {
    is.len() == should.len() && is.iter().zip(should).all(|(is, should)| (is - should).abs() <= tolerance)
}

/// The largest magnitude; 0 for no numbers.
pub fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |size, number| size.max(number.abs()))
}

pub fn matrix(rows: &[Vec<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), rows.first().map_or(0, Vec::len), |i, j| rows[i][j])
}
