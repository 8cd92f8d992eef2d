//! Whole pictures: what is left out, the same bytes each time, how large they grow.

use super::*;

fn axis(label: &str, logarithmic: bool) -> Axis {
    Axis { label: label.into(), logarithmic, ..Axis::default() }
}

fn marks(points: Vec<Point>) -> Picture {
    let shapes = vec![Shape::Marks { points, mark: Mark::Circle, colour: Colour::Blue, size: MARK }];
    let panel = Panel { shapes, ..Panel::new(axis("time [s]", true), axis("error", true)) };
    let entry = Entry { name: "f64".into(), key: Key::Mark(Mark::Circle, Colour::Blue) };
    Picture {
        title: "title".into(),
        rows: vec![vec![panel]],
        legend: Legend { entries: vec![entry], arrangement: Arrangement::Beside },
    }
}

#[test]
fn what_cannot_be_drawn_is_left_out() {
    assert_eq!(marks(vec![(0.0, 1.0), (1.0, f64::NAN)]).svg(), None);
    let svg = marks(vec![(1e-6, 1e-15), (1e-3, 1e-7), (1.0, 0.0)]).svg().unwrap();
    assert!(svg.starts_with("<svg"));
    assert!(!svg.contains("NaN"));
    assert_eq!(svg.matches("<circle").count(), 3, "two points and the key");
}

#[test]
fn a_png_is_one_and_the_same_bytes_each_time() {
    let picture = marks(vec![(1e-6, 1e-15), (1e-3, 1e-7)]);
    let png = picture.png().unwrap().unwrap();
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    assert_eq!(picture.png().unwrap().unwrap(), png);
}

/// Every kind of shape, two panels above each other.
fn figure() -> Picture {
    let wave = |phase: f64| -> Vec<Point> {
        (0..=200_000).map(|at| f64::from(at) * 1e-5).map(|x| (x, libm::sin(7.0 * x + phase))).collect()
    };
    let line = |phase: f64, dash: Dash, at: usize| Shape::Line {
        points: wave(phase),
        stroke: Stroke { colour: Colour::SERIES[at], width: 2.0, dash },
    };
    let band = |from, to, letter: &str, at| Band { from, to, letter: letter.into(), fill: Colour::Tint(at) };
    let bands = vec![
        band(0.0, 0.5, "A", 0),
        band(0.5, 1.0, "B", 1),
        band(1.0, 1.000_001, "C", 2),
        band(1.000_001, 1.004, "D", 3),
        band(1.004, 2.0, "E", 4),
    ];
    let upper = Panel {
        x: Axis { range: Some((0.0, 2.0)), bare: true, ..axis("", false) },
        size: (540.0, 200.0),
        bands: bands.clone(),
        shapes: Dash::ALL.into_iter().enumerate().map(|(at, dash)| line(0.3 * at as f64, dash, at)).collect(),
        ..Panel::new(Axis::default(), axis("velocity after [m/s]", false))
    };
    let square = |low: f64, high: f64| vec![(low, low), (high, low), (high, high), (low, high)];
    let label = Label {
        at: (0.5, 0.5e-6),
        offset: (0.0, 0.0),
        text: "α < β".into(),
        anchor: Anchor::Middle,
        size: 14,
        colour: Colour::Black,
        rim: true,
    };
    let lower = Panel {
        x: Axis { range: Some((0.0, 2.0)), ..axis("α [rad]", false) },
        size: (540.0, 200.0),
        bands: bands.into_iter().map(|band| Band { letter: String::new(), ..band }).collect(),
        shapes: vec![
            Shape::Line {
                points: wave(0.0).into_iter().map(|(x, y)| (x, 1e-6 * y)).collect(),
                stroke: Stroke::solid(Colour::Blue, 2.0),
            },
            Shape::Arrow { from: (1.5, 0.0), to: (1.7, 0.8e-6), stroke: Stroke::solid(Colour::Vermilion, 2.0) },
            Shape::Text(label),
        ],
        ..Panel::new(Axis::default(), axis("impulse [N s]", false))
    };
    let map = Panel {
        title: "areas with holes\nand circles".into(),
        size: (300.0, 200.0),
        equal: true,
        shapes: vec![
            Shape::Area {
                loops: vec![square(0.0, 1.0), square(0.25, 0.75)],
                fill: Some(Colour::Tint(3)),
                stroke: None,
            },
            Shape::Circle {
                centre: (0.5, 0.5),
                radius: 0.2,
                fill: None,
                stroke: Some(Stroke::solid(Colour::Black, 1.0)),
            },
            Shape::Marks { points: vec![(0.5, 0.5)], mark: Mark::Centre, colour: Colour::Black, size: 8.0 },
        ],
        ..Panel::new(axis("a [m]", false), axis("b [m]", false))
    };
    let entries = Dash::ALL.into_iter().enumerate().map(|(at, dash)| Entry {
        name: format!("branch {}", at + 1),
        key: Key::Line(Stroke { colour: Colour::SERIES[at], width: 2.0, dash }),
    });
    Picture {
        title: "Everything at once".into(),
        rows: vec![vec![upper, map], vec![lower]],
        legend: Legend { entries: entries.collect(), arrangement: Arrangement::Rows },
    }
}

#[test]
fn the_figure_of_everything_is_what_it_was() {
    let svg = figure().svg().unwrap();
    assert!(svg.len() < 500_000, "{} bytes", svg.len());
    insta::assert_snapshot!("everything", svg.replace("><", ">\n<"));
}

#[test]
fn a_unit_is_as_long_up_as_forward_where_that_is_asked_for() {
    let panel = &figure().rows[0][1];
    let frame = Frame::new(panel);
    let [origin, right, up] = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|point| frame.place(point).unwrap());
    assert!(((right.0 - origin.0) - (origin.1 - up.1)).abs() < 1e-9);
}

#[test]
fn control_characters_and_markup_do_not_break_a_picture() {
    let mut picture = figure();
    picture.title = "a\u{1}<b> & \"c\" $d$\u{ffff}".into();
    let svg = picture.svg().unwrap();
    assert!(svg.contains("a&lt;b&gt; &amp;"), "{}", &svg[..600]);
    assert!(picture.png().is_ok());
}
