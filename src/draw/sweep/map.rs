//! Two parameters: areas of equal outcomes with their letters, and the borders between them.

use super::fills_of_map;
use super::place::{around, clear_of, freest};
use crate::draw::plot::{
    Color, LegendEntry, LegendKey, Panel, Picture, Pixel, PlotAxis, PlotPoint, PlotShape, Stroke, TextBox,
};
use crate::pipeline::Aspect;
use crate::sweep::{Area, Map, letter};
use crate::write::sweep::Happening;

/// Inside of the axes \[px\].
const SIZE: Pixel = (540.0, 420.0);
/// Of letters \[px\].
const LETTERS: u32 = 15;
const BORDER: Stroke = Stroke::solid(Color::Black, 1.0);
/// From a letter to its small area.
const LEADER: Stroke = Stroke::solid(Color::Black, 0.7);
/// The least distance of a letter from borders \[px\].
const CLEAR: f64 = 1.0;
/// A letter of a small area stands at one of these distances \[px\], in one of so many directions.
const AWAY: [f64; 4] = [26.0, 38.0, 52.0, 70.0];
const DIRECTIONS: usize = 24;

pub fn picture([x, y]: [PlotAxis; 2], question: Aspect, map: &Map) -> Picture {
    let points = |points: &Vec<[f64; 2]>| points.iter().map(|&[x, y]| (x, y)).collect();
    let (mut shapes, mut legend) = (Vec::new(), Vec::new());
    for ((index, area), color) in map.areas.iter().enumerate().zip(fills_of_map(map)) {
        let happening = Happening::of(question, &area.regime, area.verdict, area.refused.as_ref());
        let name = format!("{}: {}", letter(index), happening.lines().join("\n"));
        // The seam between two fills lies under the border's line.
        let loops = area.loops.iter().map(points).collect();
        shapes.push(PlotShape::Area { loops, fill: Some(color), stroke: None });
        legend.push(LegendEntry::new(name, LegendKey::Fill(color)));
    }
    shapes.extend(map.curves.iter().map(|curve| PlotShape::Line { points: points(&curve.points), stroke: BORDER }));
    shapes.extend(letters(&x, &y, map));
    let panel = Panel { shapes, size: SIZE, ..Panel::new(x, y) };
    Picture { title: String::new(), rows: vec![vec![panel]], legend }
}

/// The letters of all areas: within each part that has room for it, or next to the largest part, with a line to it.
fn letters(x: &PlotAxis, y: &PlotAxis, map: &Map) -> Vec<PlotShape> {
    let (Some(x), Some(y)) = (x.range, y.range) else { return Vec::new() };
    let pixel = |[a, b]: [f64; 2]| (SIZE.0 * (a - x.0) / (x.1 - x.0), SIZE.1 * (b - y.0) / (y.1 - y.0));
    let point = |(a, b): Pixel| -> PlotPoint { (x.0 + (x.1 - x.0) * a / SIZE.0, y.0 + (y.1 - y.0) * b / SIZE.1) };
    let pixels = |points: &Vec<[f64; 2]>| points.iter().copied().map(pixel).collect();
    let mut taken: Vec<Vec<Pixel>> = map.curves.iter().map(|curve| pixels(&curve.points)).collect();
    let text = |index: usize, middle: Pixel| TextBox { middle, half: TextBox::half_of(&letter(index), LETTERS) };
    let label =
        |index: usize, text: &TextBox| PlotShape::Text { at: point(text.middle), text: letter(index), size: LETTERS };
    let fits = |text: &TextBox, taken: &[Vec<Pixel>], room: f64| text.is_within(SIZE) && clear_of(text, taken) >= room;
    let mut shapes = Vec::new();
    let mut small: Vec<(usize, &Area)> = Vec::new();
    for (index, area) in map.areas.iter().enumerate() {
        let half = text(index, SIZE).half;
        let middles = area.middles.iter().map(|(middle, _)| text(index, freest(pixel(*middle), half, &taken)));
        let fitting: Vec<TextBox> = middles.filter(|text| fits(text, &taken, CLEAR)).collect();
        if fitting.is_empty() {
            small.push((index, area));
        }
        for text in fitting {
            taken.push(outline(&text));
            shapes.push(label(index, &text));
        }
    }
    for (index, area) in small {
        // An area between the lines of the grid has no middle: then a point on its edge.
        let deepest = area.middles.iter().max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(middle, _)| middle);
        let Some(from) = deepest.or_else(|| area.loops.first()?.first()) else { continue };
        let from = pixel(*from);
        let places = AWAY.into_iter().flat_map(|distance| around(from, distance, DIRECTIONS));
        let free = places.map(|at| text(index, at)).find(|text| fits(text, &taken, CLEAR + 2.0));
        if let Some(text) = free {
            let (dx, dy) = (from.0 - text.middle.0, from.1 - text.middle.1);
            let share = 0.5 * f64::from(LETTERS) / libm::hypot(dx, dy);
            let to = (text.middle.0 + share * dx, text.middle.1 + share * dy);
            shapes.push(PlotShape::Line { points: vec![point(from), point(to)], stroke: LEADER });
            shapes.push(label(index, &text));
            taken.extend([outline(&text), vec![from, to]]);
        }
    }
    shapes
}

fn outline(TextBox { middle: (x, y), half: (across, up) }: &TextBox) -> Vec<Pixel> {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
    corners.map(|(right, high)| (x + right * across, y + high * up)).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Mode;
    use crate::sweep::{BorderCurve, Regime, Transition};

    /// Upright strips of these widths.
    fn strips(widths: &[f64]) -> Map {
        let line = |x: f64| vec![[x, 0.0], [x, 1.0]];
        let (mut areas, mut curves, mut x) = (Vec::new(), Vec::new(), 0.0);
        for (index, width) in widths.iter().enumerate() {
            let outcomes = vec![vec![Mode::ALL[index]]];
            let regime = Regime::Answered { contacts: vec!["foot".into()], outcomes, undecided: Vec::new() };
            let loops = vec![line(x).into_iter().chain(line(x + width).into_iter().rev()).collect()];
            let middles = vec![([x + 0.5 * width, 0.5], 0.5 * width)];
            areas.push(Area { regime: regime.into(), loops, middles, verdict: None, refused: None });
            if index > 0 {
                let (sides, transition) = ([index - 1, index], Transition::default());
                curves.push(BorderCurve { sides, transition, points: line(x) });
            }
            x += width;
        }
        Map { areas, curves, dependent: false }
    }

    #[test]
    fn a_letter_without_room_has_a_line_to_its_area() {
        let axis = PlotAxis { range: Some((0.0, 1.0)), ..PlotAxis::default() };
        let (mut names, mut places, mut leaders) = (Vec::new(), Vec::new(), Vec::new());
        for shape in letters(&axis, &axis, &strips(&[0.5, 0.01, 0.49])) {
            match shape {
                PlotShape::Text { at, text, .. } => {
                    names.push(text);
                    places.push(at.0);
                }
                PlotShape::Line { points, .. } => leaders.push(points[0].0),
                _ => {}
            }
        }
        assert_eq!(names, ["A", "C", "B"]);
        assert!((0.0..0.5).contains(&places[0]) && (0.51..1.0).contains(&places[1]));
        let [leader] = leaders[..] else { panic!("one small area") };
        assert!((leader - 0.505).abs() < 0.006, "{leader}");
    }
}
