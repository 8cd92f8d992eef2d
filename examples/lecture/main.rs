//! The lecture's biped in sustained contact, and Painleve's rod over angle and friction, checked and drawn:
//! `cargo run --example lecture [DIRECTORY]`.

mod biped;
mod rod;

use heelstrike::draw::plot::{Color, LegendEntry, LegendKey, Mark, Panel, Picture, PlotAxis, PlotShape, Stroke};
use rod::{Kind, RodMap};
use std::error::Error;
use std::path::PathBuf;

/// The default directory for pictures.
const HERE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/lecture");

fn main() -> Result<(), Box<dyn Error>> {
    let directory = std::env::args_os().nth(1).map_or_else(|| PathBuf::from(HERE), PathBuf::from);
    std::fs::create_dir_all(&directory)?;
    let map = RodMap::new(45, 41)?;
    let mut claims = biped::claims()?;
    claims.extend(map.claims()?);
    for (words, holds) in &claims {
        println!("{} {words}", if *holds { "yes" } else { "NO " });
    }
    if let Some(svg) = picture(&map).svg() {
        std::fs::write(directory.join("painleve.svg"), svg)?;
    }
    match claims.iter().all(|(_, holds)| *holds) {
        true => Ok(()),
        false => Err("a claim does not hold".into()),
    }
}

fn picture(map: &RodMap) -> Picture {
    let drawn = [
        (Kind::Lifts, "lifts off", Mark::Circle, Color::SkyBlue),
        (Kind::SlidesOn, "slides on", Mark::Square, Color::Orange),
        (Kind::Two, "either: two answers", Mark::Triangle, Color::Black),
        (Kind::Nothing, "no finite forces: it jams", Mark::Diamond, Color::Vermilion),
    ];
    let stroke = Stroke::solid(Color::Black, 1.5);
    let marks = drawn.iter().map(|&(_, name, mark, color)| (name, LegendKey::Mark(mark, color)));
    let keys = marks.chain([("borders of the closed form", LegendKey::Line(stroke))]);
    let legend = keys.map(|(name, key)| LegendEntry { name: name.into(), key }).collect();
    let cells = drawn.iter().map(|&(kind, _, mark, color)| {
        let own = map.cells.iter().filter(|cell| cell.found == Some(kind));
        PlotShape::Marks { points: own.map(|cell| (cell.theta, cell.friction)).collect(), mark, color, size: 3.0 }
    });
    let lines = rod::borders().map(|points| PlotShape::Line { points, stroke });
    let x = PlotAxis { label: "inclination of the rod [rad]".into(), ..PlotAxis::default() };
    let y = PlotAxis { label: "friction".into(), ..PlotAxis::default() };
    Picture {
        title: "Painlevé's uniform rod, its lower end sliding backward".into(),
        rows: vec![vec![Panel { shapes: cells.chain(lines).collect(), ..Panel::new(x, y) }]],
        legend,
    }
}
