//! Poses in three dimensions, as URDF writes them.

/// A 3 x 3 matrix, row by row.
pub type Matrix = [[f64; 3]; 3];

/// A frame in another one: translated by `xyz` and rotated by `rpy`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// The frame's origin in the outer frame \[m\].
    pub xyz: [f64; 3],
    /// Roll, pitch and yaw \[rad\]: rotations about the outer frame's fixed x, y and z axes, in this order.
    pub rpy: [f64; 3],
}

impl Pose {
    /// The matrix that takes vectors of this frame into the outer frame's axes: Rz(yaw) Ry(pitch) Rx(roll).
    ///
    /// Angles of zero give exact ones and zeros, and the digits are the same on every platform.
    pub fn rotation(&self) -> Matrix {
        let [(sr, cr), (sp, cp), (sy, cy)] = self.rpy.map(libm::sincos);
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            // 0 - sp and not -sp, which would be a negative zero.
            [0.0 - sp, cp * sr, cp * cr],
        ]
    }
}

/// `matrix` times `vector`; the identity keeps every digit.
pub fn apply(matrix: &Matrix, vector: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// `a` times `b`; the identity keeps every digit.
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|column| row[0] * b[0][column] + row[1] * b[1][column] + row[2] * b[2][column]))
}

/// `vector` at length one; one that has it keeps its digits, and zero stays zero.
pub fn unit(vector: [f64; 3]) -> [f64; 3] {
    // A power of two first, so that no square overflows or vanishes; it costs no digit.
    let largest = vector.into_iter().map(f64::abs).fold(0.0, f64::max);
    if largest == 0.0 {
        return vector;
    }
    let [x, y, z] = vector.map(|component| libm::scalbn(component, -libm::ilogb(largest)));
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// The right-handed rotation by `angle` \[rad\] about the unit vector `axis` (Rodrigues).
pub fn turn(axis: [f64; 3], angle: f64) -> Matrix {
    let (sin, cos) = libm::sincos(angle);
    let [x, y, z] = axis;
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    [0, 1, 2].map(|row| {
        [0, 1, 2].map(|column| {
            let one = if row == column { cos } else { 0.0 };
            one + sin * cross[row][column] + (1.0 - cos) * axis[row] * axis[column]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn rotation(rpy: [f64; 3]) -> Matrix {
        Pose { xyz: [0.0; 3], rpy }.rotation()
    }

    fn assert_close(a: [f64; 3], b: [f64; 3]) {
        for (a, b) in a.into_iter().zip(b) {
            assert!((a - b).abs() < 4.0 * f64::EPSILON, "{a} is not {b}");
        }
    }

    #[test]
    fn no_turn_is_the_identity_bit_for_bit() {
        let turn = rotation([0.0; 3]);
        assert_eq!(turn.map(|row| row.map(f64::to_bits)), IDENTITY.map(|row| row.map(f64::to_bits)));
        let vector = [0.1, -1e-300, 0.073265];
        assert_eq!(apply(&turn, vector).map(f64::to_bits), vector.map(f64::to_bits));
        let other = rotation([0.3, -1.0, 2.0]);
        assert_eq!([product(&turn, &other), product(&other, &turn)], [other; 2]);
    }

    #[test]
    fn angles_follow_the_right_hand() {
        for (k, axis) in IDENTITY.into_iter().enumerate() {
            let by = |angle| rotation([0, 1, 2].map(|at| if at == k { angle } else { 0.0 }));
            assert_close(apply(&by(FRAC_PI_2), IDENTITY[(k + 1) % 3]), IDENTITY[(k + 2) % 3]);
            turn(axis, 0.7).into_iter().zip(by(0.7)).for_each(|(row, expected)| assert_close(row, expected));
        }
        // A third of a whole turn about the diagonal takes x to y, y to z and z to x.
        let diagonal = unit([2.0, 2.0, 2.0]);
        assert_close(apply(&turn(diagonal, 4.0 * FRAC_PI_2 / 3.0), [0.1, 0.2, 0.3]), [0.3, 0.1, 0.2]);
    }

    #[test]
    fn roll_comes_first_and_yaw_last_about_fixed_axes() {
        let [roll, pitch, yaw] = [[0.4, 0.0, 0.0], [0.0, -0.7, 0.0], [0.0, 0.0, 1.9]].map(rotation);
        let by_parts = product(&yaw, &product(&pitch, &roll));
        rotation([0.4, -0.7, 1.9]).into_iter().zip(by_parts).for_each(|(row, expected)| assert_close(row, expected));
    }
}
