//! The picture of errors against run time: one panel for G and one for the outcomes.

use crate::accuracy::{Factorization, Method, MethodErrors};
use crate::draw::plot::{Color, LegendEntry, LegendKey, MARK, Mark, Panel, Picture, PlotAxis, PlotShape, range};
use crate::write::accuracy::{Accuracy, name_of};
use crate::write::words::grouped;

/// The marks that distinguish cases. If there are more cases than marks, all of them have a circle.
const MARKS: [Mark; 6] = [Mark::Circle, Mark::Square, Mark::Triangle, Mark::Diamond, Mark::Star, Mark::Cross];

impl Accuracy {
    /// Returns the picture of errors against run time. It omits the reference, whose hundred digits would compress the
    /// scale of all others.
    pub fn picture(&self) -> Picture {
        let named = self.studies.len() <= MARKS.len();
        let title = match self.studies.as_slice() {
            [study] => format!("Error against run time: {}", study.name),
            studies if named => format!("Error against run time of {} cases", studies.len()),
            studies => format!("Error against run time: each mark is one of {} cases by one method", studies.len()),
        };
        let mark = |case: usize| if named { MARKS[case] } else { Mark::Circle };
        let drawn = || {
            let cases = self.studies.iter().enumerate();
            cases.flat_map(|(case, study)| study.methods.iter().filter(is_drawn).map(move |method| (case, method)))
        };
        let groups = grouped(drawn().map(|(_, method)| (name_of(method), method)));
        let key = |method| LegendKey::Mark(Mark::Circle, color(method));
        let mut legend: Vec<LegendEntry> =
            groups.into_iter().map(|(name, methods)| LegendEntry::new(name, key(methods[0]))).collect();
        if named && self.studies.len() > 1 {
            let cases = self.studies.iter().enumerate().filter(|(_, study)| study.methods.iter().any(|m| is_drawn(&m)));
            // Gray stands for any method.
            let key = |case| LegendKey::Mark(mark(case), Color::Gray);
            legend.extend(cases.map(|(case, study)| LegendEntry::new(&study.name, key(case))));
        }
        let panel = |what: &str, pick: fn(&MethodErrors) -> Option<f64>| {
            let series = grouped(drawn().filter_map(|(case, method)| {
                let point = (method.time?.median, method.error.as_ref().and_then(pick)?);
                Some(((mark(case), color(method)), point))
            }));
            let marks = |((mark, color), points)| PlotShape::Marks { points, mark, color, size: MARK };
            let axis = |label: &str| PlotAxis { logarithmic: true, ..PlotAxis::new(label) };
            let shapes = series.into_iter().map(marks).collect();
            Panel { shapes, ..Panel::new(axis("time from state to G [s]"), axis(what)) }
        };
        let mut panels = vec![
            panel("largest error of G", |error| error.delassus),
            panel("largest error of impulses and velocities after", |error| error.outcome),
        ];
        // All panels have the same range of errors.
        let shapes = panels.iter().flat_map(|panel| &panel.shapes);
        let errors = shapes.flat_map(PlotShape::extent).map(|(_, error)| error);
        let range = range(errors.filter(|error| error.is_finite() && *error > 0.0));
        panels.iter_mut().for_each(|panel| panel.y.range = range);
        Picture { title, rows: vec![panels], legend }
    }
}

fn is_drawn(method: &&Method) -> bool {
    method.number != "reference" && method.factorization.is_some() && method.time.is_some() && method.error.is_some()
}

fn color(method: &Method) -> Color {
    match (method.number, method.factorization) {
        ("f32", Some(Factorization::ArticulatedBodies)) => Color::Vermilion,
        ("f32", _) => Color::Orange,
        ("f64", Some(Factorization::ArticulatedBodies)) => Color::Blue,
        ("f64", Some(Factorization::DenseCholesky)) => Color::SkyBlue,
        ("f64", _) => Color::Green,
        (_, Some(Factorization::ArticulatedBodies)) => Color::Black,
        _ => Color::Purple,
    }
}
