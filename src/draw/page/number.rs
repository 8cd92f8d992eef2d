//! Numbers with the digits that a screen shows.

use crate::planar::Vector;

/// With so many significant digits.
pub(super) fn significant(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// The vector with five digits in each entry.
pub(super) fn vector(vector: &Vector<f64>) -> Vector<f64> {
    vector.map(|entry| significant(entry, 5))
}

/// The unit of coordinates \[m\], a power of ten: a robot of this size spans ten thousand of them or more.
pub(super) fn unit(size: f64) -> f64 {
    let size = if size > 0.0 && size.is_finite() { size } else { 1.0 };
    libm::pow(10.0, libm::floor(libm::log10(size)) - 4.0)
}

/// The multiple of `unit`, a power of ten, that is nearest.
pub(super) fn to_unit(value: f64, unit: f64) -> f64 {
    let whole = (value / unit).round();
    // A quotient by a power of ten has fewer digits than a product has; zero has no sign.
    let rounded = if unit < 1.0 { whole / (1.0 / unit).round() } else { whole * unit };
    if rounded.is_finite() { rounded + 0.0 } else { value }
}

/// The point whose entries are multiples of `unit`.
pub(super) fn place(point: Vector<f64>, unit: f64) -> Vector<f64> {
    point.map(|entry| to_unit(entry, unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_of_a_screen() {
        let unit = unit(1.3);
        assert_eq!(
            [0.1 + 0.2, -1e-9, 1234.56789].map(|value| format!("{}", to_unit(value, unit))),
            ["0.3", "0", "1234.5679"]
        );
        assert_eq!(to_unit(123_456.0, super::unit(5e6)), 123_500.0);
        assert_eq!([1.0 / 3.0, 2e-300, -123_456.7].map(|value| significant(value, 5)), [0.33333, 2e-300, -123_460.0]);
        assert_eq!(super::unit(0.0), 1e-4);
    }
}
