//! The regions of a study of two parameters.

use super::{Happening, not_guaranteed};
use crate::sweep::{Area, BorderCurve, CELLS, Map, Parameter, letter};
use crate::write::Palette;
use serde::Serialize;
use std::fmt::Write;

/// The record of a study of two parameters, without its samples.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapSweep<'a> {
    /// The parameters.
    pub parameters: Vec<&'a str>,
    /// The regions.
    pub regions: Vec<MapRegion<'a>>,
    /// The borders between them.
    pub borders: &'a [BorderCurve],
    /// Limits of the search, as sentences.
    pub notes: Vec<String>,
    /// How many samples there are.
    #[serde(skip)]
    samples: usize,
}

/// Where one set of outcomes is valid.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapRegion<'a> {
    /// Its letter.
    pub letter: String,
    /// Its outcomes.
    #[serde(flatten)]
    pub happening: Happening<'a>,
    /// The part of the ranges that it covers.
    pub share: f64,
    /// Closed loops of points, in the order of the parameters, with the region on their left (the second parameter up);
    /// holes run the other way.
    pub loops: &'a [Vec<[f64; 2]>],
}

impl<'a> MapSweep<'a> {
    /// The record of the `map` of these parameters.
    pub fn new(parameters: &'a [Parameter], map: &'a Map) -> Self {
        let whole: f64 = parameters.iter().map(Parameter::range).product();
        let region = |(kind, area): (usize, &'a Area)| MapRegion {
            letter: letter(kind),
            happening: Happening::of(&area.regime, area.verdict, area.refused.as_ref()),
            share: area.loops.iter().map(|points| surface(points)).sum::<f64>() / whole,
            loops: &area.loops,
        };
        let contacts = map.areas.iter().map(|area| area.regime.contacts().len()).max().unwrap_or(0);
        let mut notes = not_guaranteed(contacts, map.dependent);
        if contacts > 0 {
            notes.push(format!(
            "curves are traced along the lines of a grid of at least {CELLS} by {CELLS} cells: an area that lies within one of its \
             cells is not found"
            ));
        }
        Self {
            parameters: parameters.iter().map(|parameter| parameter.name.as_str()).collect(),
            regions: map.areas.iter().enumerate().map(region).collect(),
            borders: &map.curves,
            notes,
            samples: parameters.iter().map(|parameter| parameter.steps).product(),
        }
    }

    /// All regions and the transitions between them, for people.
    pub fn text(&self, robot: &str, palette: &Palette) -> String {
        let mut out = String::new();
        // Writing into a string cannot fail.
        let _ = self.write(robot, palette, &mut out);
        out
    }

    fn write(&self, robot: &str, Palette { strong, faint, plain }: &Palette, out: &mut String) -> std::fmt::Result {
        let count = self.regions.len();
        let regions = if count == 1 { "one region".to_owned() } else { format!("{count} regions") };
        let names = self.parameters.join(" and ");
        writeln!(out, "{strong}{robot}{plain} against {names}: {regions}, {} samples.\n", self.samples)?;
        for region in &self.regions {
            for (line, words) in region.happening.lines().iter().enumerate() {
                let share = if line == 0 { format!("{:.2} %", 100.0 * region.share) } else { String::new() };
                let letter = if line == 0 { &region.letter } else { "" };
                writeln!(out, "{strong}{letter:2}{plain}  {share:>8}  {words}")?;
            }
        }
        writeln!(out)?;
        let mut written: Vec<String> = Vec::new();
        for BorderCurve { sides, transition, .. } in self.borders {
            let [left, right] = sides.map(letter);
            let line = format!("between {left} and {right}: {}", transition.in_words([&left, &right]));
            if !written.contains(&line) {
                writeln!(out, "{faint}{line}{plain}")?;
                written.push(line);
            }
        }
        for note in &self.notes {
            writeln!(out, "\nNote: {note}.")?;
        }
        Ok(())
    }
}

/// The area of a loop; negative if it runs clockwise.
fn surface(points: &[[f64; 2]]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}
