//! The impulses that a list of modes allows, as combinations of few generators.
//!
//! ```text
//!     L = B lambda      separate: none    slide+-: the ray (-+a, b)    stick: both axes (frictionless: the normal)
//! ```
//!
//! Everything is in the scale of the rows: L_i sqrt(G_ii) / S.

use super::basis::dot;
use super::mode::Mode;
use super::problem::ContactProblem;
use super::sign::Scale;
use crate::planar::Vector;

/// Direction of a sliding (or frictionless) contact's impulse in the scale of the rows, of length one.
pub fn slide_ray(problem: &ContactProblem, scale: &Scale, contact: usize, mode: Mode) -> Vector<f64> {
    let (a, b) = problem.friction()[contact].pair();
    let ray = [-mode.direction() * a * scale.mobility[2 * contact], b * scale.mobility[2 * contact + 1]];
    let length = ray[0].hypot(ray[1]);
    ray.map(|entry| entry / length)
}

/// The rays and planes that the modes allow for the impulses: L (scaled) = sum of lambda_j times generator j.
pub struct Generators {
    /// Row and entry of each generator's one or two non-zero rows.
    entries: Vec<Vec<(usize, f64)>>,
    /// Z^T times each generator.
    images: Vec<Vec<f64>>,
}

impl Generators {
    /// Of a combination of modes, with the scaled rows Z.
    pub fn of(rows: &[Vec<f64>], problem: &ContactProblem, scale: &Scale, modes: &[Mode]) -> Self {
        let mut entries = Vec::new();
        for (contact, &mode) in modes.iter().enumerate() {
            let (t, n) = (2 * contact, 2 * contact + 1);
            if mode == Mode::Stick {
                if !problem.friction()[contact].is_zero() {
                    entries.push(vec![(t, 1.0)]);
                }
                entries.push(vec![(n, 1.0)]);
            } else if mode.slides() {
                let ray = slide_ray(problem, scale, contact, mode);
                entries.push(vec![(t, ray[0]), (n, ray[1])]);
            }
        }
        let image = |generator: &Vec<(usize, f64)>| {
            let mut image = vec![0.0; rows.first().map_or(0, Vec::len)];
            for &(row, factor) in generator {
                for (entry, part) in image.iter_mut().zip(&rows[row]) {
                    *entry += factor * part;
                }
            }
            image
        };
        let images = entries.iter().map(image).collect();
        Self { entries, images }
    }

    /// How many.
    pub fn count(&self) -> usize {
        self.entries.len()
    }

    /// The inner products of a direction of w with every generator's image.
    pub fn against(&self, direction: &[f64]) -> Vec<f64> {
        self.images.iter().map(|image| dot(direction, image)).collect()
    }

    /// `factor` times the scaled impulse of a row, by lambda.
    pub fn impulse_row(&self, row: usize, factor: f64) -> Vec<f64> {
        let of = |generator: &Vec<(usize, f64)>| {
            generator.iter().find(|(own, _)| *own == row).map_or(0.0, |(_, entry)| factor * entry)
        };
        self.entries.iter().map(of).collect()
    }

    /// The impulse of every row \[N s\].
    pub fn raw_impulse(&self, lambda: &[f64], scale: &Scale) -> Vec<f64> {
        let mut impulse = vec![0.0; scale.mobility.len()];
        for (generator, factor) in self.entries.iter().zip(lambda) {
            for &(row, entry) in generator {
                impulse[row] += factor * entry * scale.speed / scale.mobility[row];
            }
        }
        impulse
    }
}
