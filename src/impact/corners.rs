//! Finds the corners of a bounded set that is the affine image of a polyhedron.
//!
//! ```text
//!     S = { z(y) : f_i(y) >= 0 }      z and f_i affine; S has as many dimensions as z has entries
//! ```
//!
//! A linear program finds the corner of S that is farthest in a given direction. Corners are added until none lies
//! beyond a facet of the hull of the known corners (Lassez and Lassez, *Quantifier elimination for conjunctions of
//! linear constraints via a convex hull algorithm*, 1992). A new corner removes the facets that it lies beyond and adds
//! one facet over each ridge of their horizon (Grünbaum, *Convex Polytopes*, 1967, section 5.2).
//!
//! Cost: one linear program per corner and facet of S, however many corners the polyhedron has.

use super::linear::{LinearFunction, Unsettled, extended, settled, solve};
use super::simplex::maximize;
use crate::scalar::{Ordered, dot};
use std::cmp::Ordering;

/// The search gives up beyond this number of facets.
const FACETS: usize = 500;

/// Returns z at all corners of S; `None` if S has too many facets. At y = 0 no function may be negative.
pub fn corners<T: Ordered>(
    functions: &[LinearFunction<T>],
    image: &[LinearFunction<T>],
) -> Result<Option<Vec<Vec<T>>>, Unsettled> {
    let mut hull = Hull { functions, image, corners: Vec::new(), facets: Vec::new() };
    hull.begin()?;
    while let Some(open) = hull.facets.iter().position(|facet| facet.open) {
        hull.facets[open].open = false;
        let corner = hull.farthest(&hull.facets[open].normal)?;
        if settled(hull.height(&hull.facets[open], &corner))?.is_gt() {
            hull.add(corner)?;
        }
        if hull.facets.len() > FACETS {
            return Ok(None);
        }
    }
    Ok(Some(hull.corners))
}

/// The convex hull of the known corners.
struct Hull<'a, T> {
    functions: &'a [LinearFunction<T>],
    image: &'a [LinearFunction<T>],
    corners: Vec<Vec<T>>,
    facets: Vec<Facet<T>>,
}

struct Facet<T> {
    /// The outward normal.
    normal: Vec<T>,
    /// All known corners on the facet.
    corners: Vec<usize>,
    /// Whether S may reach beyond the facet.
    open: bool,
}

impl<T: Ordered> Hull<'_, T> {
    /// A corner of S that is farthest in a direction.
    fn farthest(&self, direction: &[T]) -> Result<Vec<T>, Unsettled> {
        T::keeping(|| {
            let rank = 0..self.image.len();
            let axis = |index| rank.clone().map(|at| if at == index { T::one() } else { T::zero() }).collect();
            let axes = rank.clone().map(axis);
            let mut functions = self.functions.to_vec();
            let mut y = vec![T::zero(); self.image.first().map_or(0, |z| z.coefficients.len())];
            // Among the farthest points, the one with the greatest entries, compared one after the other, is a corner.
            for toward in [direction.to_vec()].into_iter().chain(axes) {
                let column = |at: usize| self.image.iter().map(|z| z.coefficients[at]).collect::<Vec<T>>();
                let objective: Vec<T> = (0..y.len()).map(|at| dot(&toward, &column(at))).collect();
                let shifted: Vec<LinearFunction<T>> = functions.iter().map(|function| function.seen_from(&y)).collect();
                let step = maximize(&shifted, &objective)?.ok_or(Unsettled)?;
                for (entry, change) in y.iter_mut().zip(step) {
                    *entry = *entry + change;
                }
                functions.push(LinearFunction { constant: -dot(&objective, &y), coefficients: objective });
            }
            Ok(self.image.iter().map(|z| z.at(&y)).collect())
        })
    }

    /// Finds a simplex of corners and its facets.
    fn begin(&mut self) -> Result<(), Unsettled> {
        let dimension = self.image.len();
        while self.corners.len() <= dimension {
            // The known corners do not differ along this direction; some corner does.
            let normals = self.normals(&(0..self.corners.len()).collect::<Vec<_>>())?;
            let direction = normals.into_iter().next().ok_or(Unsettled)?;
            let mut corner = self.farthest(&direction)?;
            if let Some(first) = self.corners.first()
                && settled(dot(&direction, &difference(&corner, first)))?.is_eq()
            {
                corner = self.farthest(&opposite(&direction))?;
            }
            self.corners.push(corner);
        }
        for left_out in 0..=dimension {
            let through: Vec<usize> = (0..=dimension).filter(|&corner| corner != left_out).collect();
            let facet = self.facet(&through)?.ok_or(Unsettled)?;
            // The two ends of a segment are already the farthest corners.
            self.facets.push(Facet { open: dimension > 1, ..facet });
        }
        Ok(())
    }

    /// Adds a corner that lies beyond a facet.
    fn add(&mut self, corner: Vec<T>) -> Result<(), Unsettled> {
        let number = self.corners.len();
        let heights = self.facets.iter().map(|facet| settled(self.height(facet, &corner)));
        let heights: Vec<Ordering> = heights.collect::<Result<_, _>>()?;
        self.corners.push(corner);
        let (mut seen, mut unseen) = (Vec::new(), Vec::new());
        for (mut facet, height) in std::mem::take(&mut self.facets).into_iter().zip(heights) {
            match height {
                Ordering::Greater => {
                    seen.push(facet);
                    continue;
                }
                Ordering::Equal => facet.corners.push(number),
                Ordering::Less => unseen.push(facet.corners.clone()),
            }
            self.facets.push(facet);
        }
        for (one, other) in seen.iter().flat_map(|one| unseen.iter().map(move |other| (one, other))) {
            let mut ridge: Vec<usize> = one.corners.iter().copied().filter(|corner| other.contains(corner)).collect();
            ridge.push(number);
            let known = |facet: &Facet<T>| ridge.iter().all(|corner| facet.corners.contains(corner));
            if ridge.len() >= self.image.len() && !self.facets.iter().any(known) {
                self.facets.extend(self.facet(&ridge)?);
            }
        }
        Ok(())
    }

    /// The facet through these corners; `None` if they determine no plane, or known corners lie on both sides of it.
    fn facet(&self, through: &[usize]) -> Result<Option<Facet<T>>, Unsettled> {
        let [normal] = &self.normals(through)?[..] else { return Ok(None) };
        let mut facet = Facet { normal: normal.clone(), corners: Vec::new(), open: true };
        let mut side = Ordering::Equal;
        for (number, corner) in self.corners.iter().enumerate() {
            match settled(dot(normal, &difference(corner, &self.corners[through[0]])))? {
                Ordering::Equal => facet.corners.push(number),
                sign if side.is_eq() || sign == side => side = sign,
                _ => return Ok(None),
            }
        }
        if side.is_gt() {
            facet.normal = opposite(normal);
        }
        Ok(Some(facet))
    }

    /// A basis of the directions orthogonal to the differences of these corners.
    fn normals(&self, through: &[usize]) -> Result<Vec<Vec<T>>, Unsettled> {
        let equation =
            |&corner: &usize| extended(&difference(&self.corners[corner], &self.corners[through[0]]), T::zero());
        let found = T::keeping(|| {
            let equations = through.iter().skip(1).map(equation).collect();
            Ok(solve(self.image.len(), equations)?.ok_or(Unsettled)?.directions.concat())
        })?;
        Ok(found.chunks(self.image.len()).map(<[T]>::to_vec).collect())
    }

    /// How far a point lies beyond a facet, times the length of the facet's normal.
    fn height(&self, facet: &Facet<T>, point: &[T]) -> T {
        dot(&facet.normal, &difference(point, &self.corners[facet.corners[0]]))
    }
}

fn difference<T: Ordered>(a: &[T], b: &[T]) -> Vec<T> {
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}

fn opposite<T: Ordered>(direction: &[T]) -> Vec<T> {
    direction.iter().map(|&entry| -entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::linear::tests::{Number, affine};

    fn found(functions: &[LinearFunction<Number>], image: &[LinearFunction<Number>]) -> Vec<Vec<f64>> {
        let corners = corners(functions, image).unwrap().unwrap();
        let mut corners: Vec<Vec<f64>> =
            corners.iter().map(|corner| corner.iter().map(|entry| entry.to_f64() + 0.0).collect()).collect();
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        corners
    }

    /// The cube 0 <= y_i <= 1, with its center as the origin.
    fn cube(dimension: usize) -> Vec<LinearFunction<Number>> {
        let face = |axis: usize, slope: f64| {
            let coefficients: Vec<f64> = (0..dimension).map(|at| if at == axis { slope } else { 0.0 }).collect();
            affine(0.5, &coefficients)
        };
        (0..dimension).flat_map(|axis| [face(axis, 1.0), face(axis, -1.0)]).collect()
    }

    #[test]
    fn a_cube_has_all_its_corners() {
        for dimension in 1..=5 {
            let unit = |axis: usize| -> Vec<f64> { (0..dimension).map(|at| f64::from(u8::from(at == axis))).collect() };
            let image: Vec<_> = (0..dimension).map(|axis| affine(0.5, &unit(axis))).collect();
            let corner = |bits: usize| -> Vec<f64> {
                (0..dimension).map(|at| f64::from(u8::from(bits >> (dimension - 1 - at) & 1 == 1))).collect()
            };
            assert_eq!(found(&cube(dimension), &image), (0..1 << dimension).map(corner).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_shadow_has_no_corner_inside() {
        // Projected along its diagonal, a cube is a hexagon; two corners of the cube lie in its middle.
        let hexagon = [affine(0.0, &[1.0, -1.0, 0.0]), affine(0.0, &[0.0, 1.0, -1.0])];
        let expected = [[-1.0, 0.0], [-1.0, 1.0], [0.0, -1.0], [0.0, 1.0], [1.0, -1.0], [1.0, 0.0]];
        assert_eq!(found(&cube(3), &hexagon), expected);
    }

    #[test]
    fn free_directions_without_effect_do_no_harm() {
        // |y1| <= 1/2, y2 >= 0, and y3 is free.
        let functions = [affine(0.5, &[1.0, 0.0, 0.0]), affine(0.5, &[-1.0, 0.0, 0.0]), affine(0.0, &[0.0, 1.0, 0.0])];
        assert_eq!(found(&functions, &[affine(0.0, &[2.0, 0.0, 0.0])]), [[-1.0], [1.0]]);
    }

    #[test]
    fn a_square_pyramid_has_five_corners() {
        // Some facets have three corners and one has four.
        let slopes = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
        let sides = slopes.map(|[x, y]| affine(0.5, &[x, y, -1.0]));
        let functions: Vec<_> = sides.into_iter().chain([affine(0.25, &[0.0, 0.0, 1.0])]).collect();
        let image = [affine(0.0, &[1.0, 0.0, 0.0]), affine(0.0, &[0.0, 1.0, 0.0]), affine(0.0, &[0.0, 0.0, 1.0])];
        let expected =
            [[-0.75, -0.75, -0.25], [-0.75, 0.75, -0.25], [0.0, 0.0, 0.5], [0.75, -0.75, -0.25], [0.75, 0.75, -0.25]];
        assert_eq!(found(&functions, &image), expected);
    }
}
