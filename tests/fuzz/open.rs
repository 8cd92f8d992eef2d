//! What was found and is not mended yet, and what its cases are excused from; each function goes with its finding.

/// Products of numbers far from one leave f64 or vanish: energies, margins and impulses are then no numbers, and signs
/// of what vanished are wrong. A case is excused whose text has such a number.
pub fn is_far(case: &str) -> bool {
    let words = case.split(|c: char| !c.is_ascii_alphanumeric() && !"+-.".contains(c));
    let mut numbers = words.filter_map(|word| word.parse::<f64>().ok());
    numbers.any(|number| number != 0.0 && !(1e-30..1e30).contains(&number.abs()))
}

/// Numbers settled by a ball have no more digits than it, which an ill-conditioned mass matrix leaves few.
pub const ROUNDING_OF_DYNAMICS: f64 = 1e-9;

/// The least of several impulses loses digits where one friction is much greater than another.
pub const ROUNDING_OF_LEAST_IMPULSES: f64 = 1e-9;
