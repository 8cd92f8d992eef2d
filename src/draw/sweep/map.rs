//! Pictures of studies with two parameters: areas of equal outcomes with their letters, and the borders between them.

use super::fills_of_map;
use super::place::{ENOUGH, around, clear_of, encloses, freest};
use crate::draw::plot::{
    Color, LegendEntry, LegendKey, Panel, Picture, Pixel, PlotAxis, PlotPoint, PlotShape, Stroke, TextBox,
};
use crate::pipeline::Aspect;
use crate::sweep::{Area, Map, letter};
use crate::write::sweep::Happening;

/// Width and height inside the axes \[px\].
const SIZE: Pixel = (540.0, 420.0);
/// The font size of letters \[px\].
const LETTERS: u32 = 15;
const BORDER: Stroke = Stroke::solid(Color::Black, 1.0);
/// The line from a letter to its small area.
const LEADER: Stroke = Stroke::solid(Color::Black, 0.7);
/// The least distance of a letter from borders \[px\].
const CLEAR: f64 = 1.0;
/// The least distance from the frame at which the search for a letter's place begins \[px\].
const INWARD: f64 = 2.0;
/// The letter of a small area is at one of these distances from it \[px\], in one of `DIRECTIONS` directions.
const AWAY: [f64; 6] = [26.0, 38.0, 52.0, 70.0, 95.0, 130.0];
const DIRECTIONS: usize = 24;

pub fn picture([x, y]: [PlotAxis; 2], question: Aspect, map: &Map) -> Picture {
    let points = |points: &Vec<[f64; 2]>| points.iter().map(|&[x, y]| (x, y)).collect();
    let letters = letters(&x, &y, map);
    let is_lettered =
        |letter: &str| letters.iter().any(|shape| matches!(shape, PlotShape::Text { text, .. } if text == letter));
    let (mut shapes, mut legend) = (Vec::new(), Vec::new());
    for ((index, area), color) in map.areas.iter().enumerate().zip(fills_of_map(map)) {
        let happening = Happening::of(question, &area.regime, area.verdict, area.refused.as_ref());
        let (letter, happening) = (letter(index), happening.lines().join("\n"));
        let remark = if is_lettered(&letter) { "" } else { "\n(without room for its letter)" };
        let name = format!("{letter}: {happening}{remark}");
        // The line of the border covers the seam between two fills.
        let loops = area.loops.iter().map(points).collect();
        shapes.push(PlotShape::Area { loops, fill: Some(color), stroke: None });
        legend.push(LegendEntry::new(name, LegendKey::Fill(color)));
    }
    shapes.extend(map.curves.iter().map(|curve| PlotShape::Line { points: points(&curve.points), stroke: BORDER }));
    shapes.extend(letters);
    let panel = Panel { shapes, size: SIZE, ..Panel::new(x, y) };
    Picture { title: String::new(), rows: vec![vec![panel]], legend }
}

/// Places the letters of all areas. A letter is in each part of its area that has room for it. If none has, the letter
/// is next to the largest part, with a line to it; if there is no room there either, the letter is omitted.
fn letters(x: &PlotAxis, y: &PlotAxis, map: &Map) -> Vec<PlotShape> {
    let (Some(x), Some(y)) = (x.range, y.range) else { return Vec::new() };
    let pixel = |[a, b]: [f64; 2]| (SIZE.0 * (a - x.0) / (x.1 - x.0), SIZE.1 * (b - y.0) / (y.1 - y.0));
    let point = |(a, b): Pixel| -> PlotPoint { (x.0 + (x.1 - x.0) * a / SIZE.0, y.0 + (y.1 - y.0) * b / SIZE.1) };
    let pixels = |points: &Vec<[f64; 2]>| -> Vec<Pixel> { points.iter().copied().map(pixel).collect() };
    let half = (0.5 * SIZE.0, 0.5 * SIZE.1);
    let frame = outline(&TextBox { middle: half, half });
    let mut taken: Vec<Vec<Pixel>> = map.curves.iter().map(|curve| pixels(&curve.points)).chain([frame]).collect();
    let loops: Vec<Vec<Pixel>> = map.areas.iter().flat_map(|area| &area.loops).map(pixels).collect();
    // Two points are in the same part of an area if the same loops enclose both.
    let part = |at: Pixel| -> Vec<bool> { loops.iter().map(|corners| encloses(corners, at)).collect() };
    let is_in =
        |area: &Area, at: Pixel| area.loops.iter().filter(|corners| encloses(&pixels(corners), at)).count() % 2 == 1;
    // A search that begins on the frame itself cannot move.
    let inward = |(a, b): Pixel| (a.clamp(INWARD, SIZE.0 - INWARD), b.clamp(INWARD, SIZE.1 - INWARD));
    let text = |index: usize, middle: Pixel| TextBox { middle, half: TextBox::half_of(&letter(index), LETTERS) };
    let label =
        |index: usize, text: &TextBox| PlotShape::Text { at: point(text.middle), text: letter(index), size: LETTERS };
    let (mut shapes, mut texts, mut lettered) = (Vec::new(), Vec::new(), Vec::new());
    let mut small: Vec<(usize, &Area)> = Vec::new();
    for (index, area) in map.areas.iter().enumerate() {
        let half = text(index, SIZE).half;
        let middles = area.middles.iter();
        let middles = middles.map(|(middle, _)| text(index, freest(inward(pixel(*middle)), half, &taken)));
        let fitting: Vec<(TextBox, f64)> = middles
            .map(|text| (text, clear_of(&text, &taken)))
            .filter(|(text, room)| *room >= CLEAR && is_in(area, text.middle))
            .collect();
        if fitting.is_empty() {
            small.push((index, area));
        }
        // Several middles may lie in one part of the area, which has one letter.
        let first = lettered.len();
        for (text, room) in fitting {
            let here = part(text.middle);
            if lettered[first..].iter().any(|(part, _)| *part == here) {
                continue;
            }
            lettered.push((here, room));
            shapes.push(label(index, &text));
            taken.push(outline(&text));
            texts.push(text);
        }
    }
    for (index, area) in small {
        let deepest = area.middles.iter().max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(middle, _)| pixel(*middle));
        // An area that contains no node of the grid has no middle.
        let inner = || area.loops.iter().filter_map(|corners| inner(&pixels(corners)));
        let roomiest = || inner().max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, at)| at);
        let Some(from) = deepest.or_else(roomiest) else { continue };
        let places = AWAY.into_iter().flat_map(|distance| around(from, distance, DIRECTIONS));
        let is_free = |text: &TextBox| {
            let leader = [vec![from, text.middle]];
            clear_of(text, &taken) >= CLEAR + 2.0 && texts.iter().all(|other| clear_of(other, &leader) > 0.0)
        };
        let free: Vec<TextBox> = places.map(|at| text(index, at)).filter(is_free).collect();
        // The letter is on a part of another area that has its own letter, if possible on a wide one.
        let is_beside = |text: &&TextBox, least: f64| {
            let here = part(text.middle);
            lettered.iter().any(|(part, room)| *room >= least && *part == here)
        };
        let place = [ENOUGH, CLEAR].into_iter().find_map(|least| free.iter().find(|text| is_beside(text, least)));
        if let Some(&text) = place {
            let (dx, dy) = (from.0 - text.middle.0, from.1 - text.middle.1);
            let share = 0.5 * f64::from(LETTERS) / libm::hypot(dx, dy);
            let to = (text.middle.0 + share * dx, text.middle.1 + share * dy);
            shapes.push(PlotShape::Line { points: vec![point(from), point(to)], stroke: LEADER });
            shapes.push(label(index, &text));
            taken.extend([outline(&text), vec![from, to]]);
            texts.push(text);
        }
    }
    shapes
}

/// Returns a point well inside a loop, the middle of two opposite corners, after its distance from the loop \[px\]. If
/// all these middles are outside, the point is a corner. `None` if the loop is empty.
fn inner(corners: &[Pixel]) -> Option<(f64, Pixel)> {
    let opposite = corners.iter().zip(corners.iter().skip(corners.len() / 2));
    let middles = opposite.map(|(a, b)| (0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1)));
    let room = |at: Pixel| clear_of(&TextBox { middle: at, half: (0.0, 0.0) }, &[corners.to_vec()]);
    let inside = middles.filter(|at| encloses(corners, *at)).map(|at| (room(at), at));
    let deepest = inside.max_by(|(a, _), (b, _)| a.total_cmp(b));
    deepest.or_else(|| Some((0.0, *corners.get(corners.len() / 4)?)))
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

    /// Returns a map of upright strips with these widths.
    fn strips(widths: &[f64]) -> Map {
        let line = |x: f64| vec![[x, 0.0], [x, 1.0]];
        let (mut areas, mut curves, mut x) = (Vec::new(), Vec::new(), 0.0);
        for (index, width) in widths.iter().enumerate() {
            let outcomes = vec![vec![Mode::ALL[index % 4]]];
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
        Map { areas, curves, ..Map::default() }
    }

    /// Returns the letters of strips, and the lines to small areas \[px\].
    fn placed(widths: &[f64]) -> (Vec<(String, TextBox)>, Vec<Vec<Pixel>>) {
        let axis = PlotAxis { range: Some((0.0, 1.0)), ..PlotAxis::default() };
        let pixel = |(x, y): PlotPoint| (SIZE.0 * x, SIZE.1 * y);
        let (mut texts, mut leaders) = (Vec::new(), Vec::new());
        for shape in letters(&axis, &axis, &strips(widths)) {
            match shape {
                PlotShape::Text { at, text, .. } => {
                    let half = TextBox::half_of(&text, LETTERS);
                    texts.push((text, TextBox { middle: pixel(at), half }));
                }
                PlotShape::Line { points, .. } => leaders.push(points.into_iter().map(pixel).collect()),
                _ => {}
            }
        }
        (texts, leaders)
    }

    #[test]
    fn a_letter_without_room_has_a_line_to_its_area() {
        let (texts, leaders) = placed(&[0.5, 0.01, 0.49]);
        let names: Vec<&str> = texts.iter().map(|(name, _)| &**name).collect();
        assert_eq!(names, ["A", "C", "B"]);
        let places: Vec<f64> = texts.iter().map(|(_, text)| text.middle.0 / SIZE.0).collect();
        assert!((0.0..0.5).contains(&places[0]) && (0.51..1.0).contains(&places[1]));
        let [leader] = &leaders[..] else { panic!("one small area") };
        assert!((leader[0].0 / SIZE.0 - 0.505).abs() < 0.006, "{leader:?}");
    }

    #[test]
    fn letters_of_thin_areas_stand_on_a_wide_one() {
        // The first strip, next to the frame, has room only for its own letter.
        let (texts, leaders) = placed(&[0.05, 0.02, 0.01, 0.92]);
        let names: Vec<&str> = texts.iter().map(|(name, _)| &**name).collect();
        assert_eq!((names, leaders.len()), (vec!["A", "D", "B", "C"], 2));
        for (at, (name, text)) in texts.iter().enumerate() {
            let (from, to) = if at == 0 { (0.0, 0.05) } else { (0.08, 1.0) };
            assert!(from * SIZE.0 < text.middle.0 - text.half.0 && text.middle.0 + text.half.0 < to * SIZE.0, "{name}");
            // The line of another area does not touch this letter.
            let others = leaders.iter().enumerate().filter(|(leader, _)| leader + 2 != at);
            assert!(
                others.map(|(_, line)| clear_of(text, std::slice::from_ref(line))).all(|room| room > 0.0),
                "{name}"
            );
        }
    }

    #[test]
    fn a_part_with_two_middles_has_one_letter() {
        let axis = PlotAxis { range: Some((0.0, 1.0)), ..PlotAxis::default() };
        let mut map = strips(&[0.5, 0.5]);
        map.areas[0].middles.push(([0.25, 0.1], 0.1));
        assert_eq!(letters(&axis, &axis, &map).len(), 2);
    }

    #[test]
    fn what_has_no_room_for_its_letter_is_named_so() {
        let axis = || PlotAxis { range: Some((0.0, 1.0)), ..PlotAxis::default() };
        let map = strips(&[&[0.04][..], &[0.003; 45]].concat());
        let lettered = letters(&axis(), &axis(), &map);
        let lettered = lettered.iter().filter(|shape| matches!(shape, PlotShape::Text { .. })).count();
        let legend = picture([axis(), axis()], Aspect::Impact, &map).legend;
        let named = legend.iter().filter(|entry| entry.name.ends_with("(without room for its letter)")).count();
        assert!(lettered > 0 && named > 0 && lettered + named == legend.len(), "{lettered}, {named}");
    }

    #[test]
    fn a_thin_loop_has_a_point_inside() {
        let sliver = [(0.0, 0.0), (50.0, 30.0), (100.0, 60.0), (100.0, 64.0), (50.0, 34.0), (0.0, 4.0)];
        assert!(inner(&sliver).is_some_and(|(_, at)| encloses(&sliver, at)));
    }
}
