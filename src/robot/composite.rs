//! Inertias of welded links -> inertia of their body.
//!
//! ```text
//!     m = sum m_i,   c = sum m_i c_i / m,   I = sum (n' R_i I_i R_i' n + m_i |c_i - c|^2)
//! ```
//!
//! Distances are taken in the plane, and the normal is n = +y (Featherstone 2008, sections 2.8 and 2.13).

use crate::description::Matrix;
use crate::planar::Vector;

/// A negative moment below this fraction of its terms is a rounding error of a rotated inertia.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Files give few digits: a moment may exceed the sum of the other two by this fraction of the largest entry.
const ROUNDED: f64 = 1e-3;

/// Returns whether a rigid body can have this inertia about its center of mass: no principal moment exceeds the sum of
/// the other two, so that none is negative (Featherstone 2008, section 2.13). Equivalently, no principal minor of
/// `tr(I) / 2 - I` is negative.
pub(super) fn is_physical(inertia: &Matrix) -> bool {
    let largest = inertia.as_flattened().iter().map(|entry| entry.abs()).fold(0.0, f64::max);
    if largest == 0.0 {
        return true;
    }
    let scaled = inertia.map(|row| row.map(|entry| entry / largest));
    let half = 0.5 * (scaled[0][0] + scaled[1][1] + scaled[2][2]);
    let second = |row: usize, column: usize| if row == column { half - scaled[row][row] } else { -scaled[row][column] };
    let minor = |a: usize, b: usize| second(a, a) * second(b, b) - second(a, b) * second(b, a);
    let cofactor =
        |row: usize, a: usize, b: usize| second(row, 0) * (second(a, 1) * second(b, 2) - second(a, 2) * second(b, 1));
    let determinant = cofactor(0, 1, 2) + cofactor(1, 2, 0) + cofactor(2, 0, 1);
    let minors = [second(0, 0), second(1, 1), second(2, 2), minor(0, 1), minor(1, 2), minor(2, 0), determinant];
    minors.into_iter().all(|minor| minor >= -ROUNDED)
}

/// The contribution of a link to the inertia of its body, in the body's frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LinkInertia {
    mass: f64,
    com: Vector<f64>,
    /// Moment of inertia about the normal through the center of mass \[kg m^2\]; negative in some files.
    pub(super) moment: f64,
}

impl LinkInertia {
    pub(super) fn new(mass: f64, com: Vector<f64>, moment: f64) -> Self {
        Self { mass, com, moment }
    }

    /// Projects the `inertia` about the center of mass, whose axes are the columns of `rotation` in the body's frame;
    /// without it the result is a point mass. Returns it with the largest rounding error of its moment.
    pub(super) fn projected(mass: f64, com: Vector<f64>, inertia: Option<&Matrix>, rotation: &Matrix) -> (Self, f64) {
        // The middle row of R is n' R.
        let normal = rotation[1];
        let (mut moment, mut size) = (0.0, 0.0);
        for (row, left) in inertia.into_iter().flatten().zip(normal) {
            for (entry, right) in row.iter().zip(normal) {
                let term = left * entry * right;
                moment += term;
                size += term.abs();
            }
        }
        let largest =
            inertia.into_iter().flat_map(|rows| rows.as_flattened()).fold(0.0, |most, entry| entry.abs().max(most));
        let scale = [size, largest, mass * com.dot(com)].into_iter().fold(0.0, f64::max);
        (Self { mass, com, moment }, ROUNDING * scale)
    }
}

/// Returns mass, center of mass and moment about it for each of `bodies` bodies. Each part has the index of its body.
pub(super) fn composites(bodies: usize, mut parts: Vec<(usize, LinkInertia)>) -> Vec<(f64, Vector<f64>, f64)> {
    let mut wholes = vec![composite(&[]); bodies];
    // The sort is stable: parts of one body keep their order, so sums keep their digits.
    parts.sort_by_key(|(body, _)| *body);
    for parts in parts.chunk_by(|(a, _), (b, _)| a == b) {
        wholes[parts[0].0] = composite(parts);
    }
    wholes
}

/// Returns mass, center of mass and moment about it of all `parts` together. If only one has mass, its digits are kept.
fn composite(parts: &[(usize, LinkInertia)]) -> (f64, Vector<f64>, f64) {
    let parts = parts.iter().map(|(_, part)| part);
    // The empty sum is -0.
    let mass = 0.0 + parts.clone().map(|part| part.mass).sum::<f64>();
    let mut massive = parts.clone().filter(|part| part.mass > 0.0);
    let com = match (massive.next(), massive.next()) {
        (None, _) => Vector::zero(),
        (Some(single), None) => single.com,
        _ => {
            let mean = |entry: fn(Vector<f64>) -> f64| {
                parts.clone().map(|part| part.mass * entry(part.com)).sum::<f64>() / mass
            };
            Vector::new(mean(|com| com.x), mean(|com| com.z))
        }
    };
    let moments = parts.map(|part| {
        let arm = part.com - com;
        if part.mass > 0.0 { part.moment + part.mass * arm.dot(arm) } else { part.moment }
    });
    (mass, com, 0.0 + moments.sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Pose;

    const INERTIA: Matrix = [[0.3, 0.01, -0.02], [0.01, 0.1, 0.03], [-0.02, 0.03, 0.25]];

    #[test]
    fn an_inertia_gives_the_moment_about_the_normal() {
        // Without rotation and with pitch, the moment is the middle entry bit for bit. Rolled by a, n in the link's
        // axes is (0, cos a, -sin a). Yawed by a, n is (sin a, cos a, 0).
        let (sin, cos) = libm::sincos(0.4);
        for (rpy, expected, off) in [
            ([0.0; 3], 0.1, 0.0),
            ([0.0, 0.4, 0.0], 0.1, 0.0),
            ([0.4, 0.0, 0.0], 0.1 * cos * cos - 2.0 * 0.03 * cos * sin + 0.25 * sin * sin, 1e-16),
            ([0.0, 0.0, 0.4], 0.3 * sin * sin + 2.0 * 0.01 * sin * cos + 0.1 * cos * cos, 1e-16),
        ] {
            let rotation = Pose { xyz: [0.0; 3], rpy }.rotation();
            let (part, _) = LinkInertia::projected(1.0, Vector::zero(), Some(&INERTIA), &rotation);
            assert!((part.moment - expected).abs() <= off, "{rpy:?}");
        }
    }

    #[test]
    fn only_some_inertias_belong_to_a_body() {
        let diagonal = |x, y, z| [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        assert!(is_physical(&INERTIA));
        // A ball, a rod, a plate, a point, and a plate with rounded digits.
        for [x, y, z] in [[1.0; 3], [0.0, 1.0, 1.0], [1.0, 1.0, 2.0], [0.0; 3], [1.0, 1.0, 2.001]] {
            assert!(is_physical(&diagonal(x, y, z)), "{x} {y} {z}");
        }
        for [x, y, z] in [[0.0, 1.0, 0.0], [1.0, 1.0, 2.1], [-1.0, 1.0, 1.0], [-1.0; 3]] {
            assert!(!is_physical(&diagonal(x, y, z)), "{x} {y} {z}");
        }
        // The principal moments are 3, 1 and 1, at any scale.
        for size in [1.0, 1e300, 1e-300] {
            let sized = |inertia: Matrix| inertia.map(|row| row.map(|entry| size * entry));
            assert!(!is_physical(&sized([[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 1.0]])));
            assert!(is_physical(&sized(INERTIA)));
        }
    }
}
