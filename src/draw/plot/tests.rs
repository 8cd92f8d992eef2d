//! Whole pictures: what is left out, the same bytes each time, their size.

use super::*;

fn axis(label: &str, logarithmic: bool) -> PlotAxis {
    PlotAxis { label: label.into(), logarithmic, ..PlotAxis::default() }
}

fn marks(points: Vec<PlotPoint>) -> Picture {
    let shapes = vec![Shape::Marks { points, mark: Mark::Circle, color: Color::Blue, size: MARK }];
    let panel = Panel { shapes, ..Panel::new(axis("time [s]", true), axis("error", true)) };
    let entry = LegendEntry { name: "f64".into(), key: LegendKey::Mark(Mark::Circle, Color::Blue) };
    Picture {
        title: "title".into(),
        rows: vec![vec![panel]],
        legend: Legend { entries: vec![entry], arrangement: Arrangement::Right },
    }
}

#[test]
fn points_off_the_axes_are_left_out() {
    assert_eq!(marks(vec![(0.0, 1.0), (1.0, f64::NAN)]).svg(), None);
    let svg = marks(vec![(1e-6, 1e-15), (1e-3, 1e-7), (1.0, 0.0)]).svg().unwrap();
    assert!(svg.starts_with("<svg"));
    assert!(!svg.contains("NaN"));
    assert_eq!(svg.matches("<circle").count(), 3, "two points and the key");
}

#[test]
fn a_png_has_the_same_bytes_each_time() {
    let picture = marks(vec![(1e-6, 1e-15), (1e-3, 1e-7)]);
    let png = picture.png().unwrap().unwrap();
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    assert_eq!(picture.png().unwrap().unwrap(), png);
}

/// Every kind of shape, two panels above each other.
fn figure() -> Picture {
    let wave = |phase: f64| -> Vec<PlotPoint> {
        (0..=200_000).map(|at| f64::from(at) * 1e-5).map(|x| (x, libm::sin(7.0 * x + phase))).collect()
    };
    let line = |phase: f64, dash: Dash, at: usize| Shape::Line {
        points: wave(phase),
        stroke: Stroke { color: Color::SERIES[at], width: 2.0, dash },
    };
    let band = |from, to, letter: &str, at| Band { from, to, letter: letter.into(), fill: Color::Tint(at) };
    let bands = vec![
        band(0.0, 0.5, "A", 0),
        band(0.5, 1.0, "B", 1),
        band(1.0, 1.000_001, "C", 2),
        band(1.000_001, 1.004, "D", 3),
        band(1.004, 2.0, "E", 4),
    ];
    let upper = Panel {
        x: PlotAxis { range: Some((0.0, 2.0)), bare: true, ..axis("", false) },
        size: (540.0, 200.0),
        bands: bands.clone(),
        shapes: Dash::ALL.into_iter().enumerate().map(|(at, dash)| line(0.3 * at as f64, dash, at)).collect(),
        ..Panel::new(PlotAxis::default(), axis("velocity after [m/s]", false))
    };
    let square = |low: f64, high: f64| vec![(low, low), (high, low), (high, high), (low, high)];
    let lower = Panel {
        x: PlotAxis { range: Some((0.0, 2.0)), ..axis("α [rad]", false) },
        size: (540.0, 200.0),
        bands: bands.into_iter().map(|band| Band { letter: String::new(), ..band }).collect(),
        shapes: vec![
            Shape::Line {
                points: wave(0.0).into_iter().map(|(x, y)| (x, 1e-6 * y)).collect(),
                stroke: Stroke::solid(Color::Blue, 2.0),
            },
            Shape::Arrow { from: (1.5, 0.0), to: (1.7, 0.8e-6), stroke: Stroke::solid(Color::Vermilion, 2.0) },
            Shape::Text { at: (0.5, 0.5e-6), text: "α < β".into(), size: 14 },
        ],
        ..Panel::new(PlotAxis::default(), axis("impulse [N s]", false))
    };
    let map = Panel {
        title: "areas with holes\nand circles".into(),
        size: (300.0, 200.0),
        equal: true,
        shapes: vec![
            Shape::Area { loops: vec![square(0.0, 1.0), square(0.25, 0.75)], fill: Some(Color::Tint(3)), stroke: None },
            Shape::Circle {
                center: (0.5, 0.5),
                radius: 0.2,
                fill: None,
                stroke: Some(Stroke::solid(Color::Black, 1.0)),
            },
            Shape::Marks { points: vec![(0.5, 0.5)], mark: Mark::Center, color: Color::Black, size: 8.0 },
        ],
        ..Panel::new(axis("a [m]", false), axis("b [m]", false))
    };
    let entries = Dash::ALL.into_iter().enumerate().map(|(at, dash)| LegendEntry {
        name: format!("branch {}", at + 1),
        key: LegendKey::Line(Stroke { color: Color::SERIES[at], width: 2.0, dash }),
    });
    Picture {
        title: "Everything at once".into(),
        rows: vec![vec![upper, map], vec![lower]],
        legend: Legend { entries: entries.collect(), arrangement: Arrangement::Rows },
    }
}

#[test]
fn a_figure_of_every_shape_stays_the_same() {
    let svg = figure().svg().unwrap();
    assert!(svg.len() < 500_000, "{} bytes", svg.len());
    insta::assert_snapshot!("everything", svg.replace("><", ">\n<"));
}
