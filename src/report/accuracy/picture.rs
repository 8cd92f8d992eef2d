//! Errors against run time as a picture: a panel for G and one for the outcomes.

use super::{Accuracy, name_of};
use crate::accuracy::{Errors, Factorization, Method};
use crate::report::picture::{Axis, Entry, Mark, Panel, Picture, Series};

/// Marks by which cases are told from each other; where there are more cases they are not.
const MARKS: [Mark; 6] = [Mark::Circle, Mark::Square, Mark::Triangle, Mark::Diamond, Mark::Star, Mark::Cross];

/// A mark of any method, as an index of [`COLOURS`](crate::report::picture::COLOURS).
const GREY: usize = 8;

impl Accuracy {
    /// Errors of G and of the outcomes against run time, a point for each method and case; not of the reference, whose
    /// hundred digits would press all others together. An error of exactly zero has no place on a logarithmic axis.
    pub fn picture(&self) -> Picture {
        let named = self.studies.len() <= MARKS.len();
        let title = match self.studies.as_slice() {
            [study] => format!("Error against run time: {}", study.name),
            studies if named => format!("Error against run time of {} cases", studies.len()),
            studies => format!("Error against run time: each mark is one of {} cases by one method", studies.len()),
        };
        let mark = |case: usize| if named { MARKS[case] } else { Mark::Circle };
        let methods = || self.studies.iter().flat_map(|study| &study.methods).filter(|method| is_drawn(method));
        let mut legend: Vec<Entry> = Vec::new();
        for method in methods() {
            let name = name_of(method);
            if !legend.iter().any(|entry| entry.name == name) {
                legend.push(Entry { name, mark: Mark::Circle, colour: colour(method) });
            }
        }
        if named && self.studies.len() > 1 {
            let cases = self.studies.iter().enumerate().filter(|(_, study)| study.methods.iter().any(is_drawn));
            legend.extend(cases.map(|(at, study)| Entry { name: study.name.clone(), mark: mark(at), colour: GREY }));
        }
        let panel = |what: &str, pick: fn(&Errors) -> Option<f64>| {
            let axis = |label: &str| Axis { label: label.into(), logarithmic: true };
            let mut series: Vec<Series> = Vec::new();
            for (case, study) in self.studies.iter().enumerate() {
                for method in study.methods.iter().filter(|method| is_drawn(method)) {
                    let error = method.error.as_ref().and_then(pick);
                    let (Some(time), Some(error)) = (method.time, error) else { continue };
                    let (mark, colour, point) = (mark(case), colour(method), (time.median, error));
                    match series.iter_mut().find(|series| (series.mark, series.colour) == (mark, colour)) {
                        Some(series) => series.points.push(point),
                        None => series.push(Series { points: vec![point], mark, colour }),
                    }
                }
            }
            Panel { x: axis("time from state to G [s]"), y: axis(what), series }
        };
        let panels = vec![
            panel("largest error of G", |error| error.delassus),
            panel("largest error of impulses and velocities after", |error| error.outcome),
        ];
        Picture { title, panels, legend }
    }
}

/// Whether the method has a place in the picture.
fn is_drawn(method: &Method) -> bool {
    method.number != "reference" && method.factorization.is_some() && method.time.is_some() && method.error.is_some()
}

/// The colour of a method, an index of [`COLOURS`](crate::report::picture::COLOURS).
fn colour(method: &Method) -> usize {
    match (method.number, method.factorization) {
        ("f32", Some(Factorization::ArticulatedBodies)) => 6,
        ("f32", _) => 1,
        ("f64", Some(Factorization::ArticulatedBodies)) => 5,
        ("f64", Some(Factorization::DenseCholesky)) => 2,
        ("f64", _) => 3,
        (_, Some(Factorization::ArticulatedBodies)) => 0,
        _ => 7,
    }
}
