//! Maps the end of compliant, overdamped contact of the paper's minimalistic biped over the trailing foot's approach
//! speed and d_t / d_n: `cargo run --release --example compliant_map -- map.csv map.png`.

mod map;

use heelstrike::accuracy::compliant::NEAR;
use heelstrike::draw::plot::{Color, LegendEntry, LegendKey, Mark, Panel, Picture, PlotAxis, PlotShape, Stroke};
use heelstrike::impact::{Friction, Mode};
use map::{Biped, LandingCell, LandingMap};
use std::error::Error;
use std::fmt::Write;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let map = Biped::new(Friction::Infinite)?.map(51, 41)?;
    if let Some(path) = arguments.next() {
        std::fs::write(path, csv(&map)?)?;
    }
    if let Some(path) = arguments.next() {
        let png = path.ends_with(".png");
        let bytes = if png { picture(&map).png()? } else { picture(&map).svg().map(String::into_bytes) };
        std::fs::write(path, bytes.unwrap_or_default())?;
    }

    let nearest = |mode| map.runs().filter(|(_, _, cell)| end(cell) == Some(mode)).count();
    println!("{} runs: {} lift off, {} stop", map.cells.len(), nearest(Mode::Separate), nearest(Mode::Stick));
    println!("{} end within {} % of none of the rigid outcomes", none(&map).len(), 100.0 * NEAR);
    for (speed, ratio, _) in map.near_negative_index(NEAR) {
        let border = map.ratios.iter().zip(&map.separatrix).find(|(at, _)| **at == ratio).and_then(|(_, speed)| *speed);
        let away = border.map_or(f64::NAN, |border| (speed - border).abs());
        println!(
            "at {speed} m/s and d_t / d_n = {ratio:.3} one ends within {} % of the slide, whose index is -1: \
                  {away:.4} m/s from the separatrix",
            100.0 * NEAR
        );
    }
    for (ratio, speed) in map.ratios.iter().zip(&map.separatrix).step_by(10) {
        match speed {
            Some(speed) => println!("d_t / d_n = {ratio}: stops from {speed:.3} m/s on"),
            None => println!("d_t / d_n = {ratio}: lifts off at every speed"),
        }
    }
    Ok(())
}

/// The mode in which the trailing foot ends, if that is near a rigid outcome.
fn end(cell: &LandingCell) -> Option<Mode> {
    cell.modes.first().copied().filter(|_| cell.distance <= NEAR)
}

fn none(map: &LandingMap) -> Vec<(f64, f64)> {
    map.runs().filter(|(_, _, cell)| end(cell).is_none()).map(|(speed, ratio, _)| (speed, ratio)).collect()
}

fn csv(map: &LandingMap) -> Result<String, std::fmt::Error> {
    let mut out = String::from("approach_speed,damping_ratio,mode_trailing,mode_leading,index,distance\n");
    for (speed, ratio, cell) in map.runs() {
        let modes: Vec<String> = cell.modes.iter().map(ToString::to_string).collect();
        let index = cell.index.map(|index| index.to_string()).unwrap_or_default();
        writeln!(out, "{speed},{ratio},{},{index},{}", modes.join(","), cell.distance)?;
    }
    Ok(out)
}

fn picture(map: &LandingMap) -> Picture {
    let ends = |mode| -> Vec<(f64, f64)> {
        let runs = map.runs().filter(|(_, _, cell)| end(cell) == Some(mode));
        runs.map(|(speed, ratio, _)| (speed, ratio)).collect()
    };
    let border = map.separatrix.iter().zip(&map.ratios).filter_map(|(speed, &ratio)| speed.map(|speed| (speed, ratio)));
    let drawn = [
        ("lifts off", ends(Mode::Separate), Mark::Circle, Color::SkyBlue),
        ("stops", ends(Mode::Stick), Mark::Square, Color::Orange),
        ("no rigid outcome within 1 %", none(map), Mark::Triangle, Color::Black),
    ];
    let stroke = Stroke::solid(Color::Vermilion, 2.0);
    let marks = drawn.iter().map(|&(name, _, mark, color)| (name, LegendKey::Mark(mark, color)));
    let keys = marks.chain([("separatrix", LegendKey::Line(stroke))]);
    let entries = keys.map(|(name, key)| LegendEntry { name: name.into(), key }).collect();
    let shapes = drawn.into_iter().map(|(_, points, mark, color)| PlotShape::Marks { points, mark, color, size: 3.0 });
    let x = PlotAxis { label: "approach speed of the trailing foot [m/s]".into(), ..PlotAxis::default() };
    let y = PlotAxis { label: "d_t / d_n".into(), logarithmic: true, ..PlotAxis::default() };
    let line = PlotShape::Line { points: border.collect(), stroke };
    Picture {
        title: "Minimalistic biped at α = 1.4, overdamped contact".into(),
        rows: vec![vec![Panel { shapes: shapes.chain([line]).collect(), ..Panel::new(x, y) }]],
        legend: entries,
    }
}
