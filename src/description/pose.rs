//! Poses in three dimensions, in URDF's convention.

use std::f64::consts::FRAC_PI_2;

/// A 3 x 3 matrix, row by row.
pub type Matrix = [[f64; 3]; 3];

/// Pose of a frame in an outer frame: translation `xyz` and rotation `rpy`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// The frame's origin in the outer frame \[m\].
    pub xyz: [f64; 3],
    /// Roll, pitch and yaw \[rad\]: rotations about the outer frame's fixed x, y and z axes, in this order.
    pub rpy: [f64; 3],
}

impl Pose {
    /// Returns the matrix from this frame's axes to those of the outer frame: Rz(yaw) Ry(pitch) Rx(roll).
    ///
    /// Zero angles and quarter turns give exact ones and zeros. The digits are the same on every platform.
    pub fn rotation(&self) -> Matrix {
        // Most poses have no rotation.
        if self.rpy == [0.0; 3] {
            return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        }
        let sincos = |angle| quarter_turn(angle).unwrap_or_else(|| libm::sincos(angle));
        let [(sr, cr), (sp, cp), (sy, cy)] = self.rpy.map(sincos);
        let rotation = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        // Makes negative zeros positive.
        rotation.map(|row| row.map(|entry| entry + 0.0))
    }
}

/// Largest deviation of a quarter turn in units in the last place: files are often written from computed angles.
const ULPS: f64 = 4.0;
/// A quarter turn that is rounded to at least this many digits counts as exact.
const DIGITS: usize = 12;

/// Returns sine and cosine if `angle` \[rad\] is one to four quarter turns in either direction; else `None`. An angle
/// counts if it is within four units in the last place of a multiple of pi/2, or is a multiple rounded to 12 or more
/// digits. 1.5708 does not count.
fn quarter_turn(angle: f64) -> Option<(f64, f64)> {
    let quarters = libm::round(angle / FRAC_PI_2);
    let exact = quarters * FRAC_PI_2;
    let rounded = || {
        let written = format!("{angle:e}");
        let digits = written.bytes().take_while(|&byte| byte != b'e').filter(u8::is_ascii_digit).count();
        digits >= DIGITS && written == format!("{exact:.*e}", digits - 1)
    };
    let is_near = |exact: f64| (angle - exact).abs() <= ULPS * f64::EPSILON * libm::scalbn(1.0, libm::ilogb(exact));
    match quarters {
        1.0 | -3.0 => Some((1.0, 0.0)),
        2.0 | -2.0 => Some((0.0, -1.0)),
        3.0 | -1.0 => Some((-1.0, 0.0)),
        4.0 | -4.0 => Some((0.0, 1.0)),
        _ => None,
    }
    .filter(|_| is_near(exact) || rounded())
}

/// Returns `matrix` times `vector`. The identity keeps every digit.
pub fn apply(matrix: &Matrix, vector: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// Returns `a` times `b`. The identity keeps every digit.
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|column| row[0] * b[0][column] + row[1] * b[1][column] + row[2] * b[2][column]))
}

/// Scales `vector` to length one. A vector of length one keeps its digits, and zero remains zero.
pub fn unit(vector: [f64; 3]) -> [f64; 3] {
    if vector.iter().map(|component| component * component).sum::<f64>() == 1.0 {
        return vector;
    }
    // Scaling by a power of two is exact, and prevents overflow and underflow of the squares.
    let largest = vector.into_iter().map(f64::abs).fold(0.0, f64::max);
    if largest == 0.0 {
        return vector;
    }
    let [x, y, z] = vector.map(|component| libm::scalbn(component, -libm::ilogb(largest)));
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// Returns the right-handed rotation by `angle` \[rad\] about the unit vector `axis` (Rodrigues' formula).
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
    fn quarter_turns_are_exact_as_they_are_written() {
        let quarters = [
            ("1.5707963267948966", [1.0, 0.0]),
            ("-1.57079632679", [-1.0, 0.0]),
            ("1.5707963267949", [1.0, 0.0]),
            ("1.5707963267948972", [1.0, 0.0]),
            ("1.570796326794896", [1.0, 0.0]),
            ("-3.141592653589793", [0.0, -1.0]),
            ("3.14159265359", [0.0, -1.0]),
            ("3.1415926535897913", [0.0, -1.0]),
            ("4.71238898038469", [-1.0, 0.0]),
            ("-4.71238898038469", [1.0, 0.0]),
            ("6.283185307179586", [0.0, 1.0]),
        ];
        for (angle, [sin, cos]) in quarters {
            let about_x = [[1.0, 0.0, 0.0], [0.0, cos, 0.0 - sin], [0.0, sin, cos]];
            let bits = |matrix: Matrix| matrix.map(|row| row.map(f64::to_bits));
            assert_eq!(bits(rotation([angle.parse().unwrap(), 0.0, 0.0])), bits(about_x), "{angle}");
        }
        for angle in ["1.5708", "1.570796", "1.570796327", "1.57079632678", "1.5707963267948986", "3.14159", "1e-16"] {
            let angle: f64 = angle.parse().unwrap();
            let (sin, cos) = libm::sincos(angle);
            assert_eq!(rotation([angle, 0.0, 0.0])[2], [0.0, sin, cos], "{angle}");
        }
    }

    #[test]
    fn angles_follow_the_right_hand() {
        for (k, axis) in IDENTITY.into_iter().enumerate() {
            let by = |angle| rotation([0, 1, 2].map(|at| if at == k { angle } else { 0.0 }));
            assert_close(apply(&by(FRAC_PI_2), IDENTITY[(k + 1) % 3]), IDENTITY[(k + 2) % 3]);
            turn(axis, 0.7).into_iter().zip(by(0.7)).for_each(|(row, expected)| assert_close(row, expected));
        }
        // A third of a full turn about the diagonal takes x to y, y to z and z to x.
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
