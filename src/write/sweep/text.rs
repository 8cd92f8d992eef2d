//! The regions of a study for people.

use super::super::Palette;
use super::super::words;
use super::{Happening, Sweep};
use crate::impact::Verdict;
use crate::sweep::{EndedOutcome, Side, Transition};
use std::fmt::Write;

impl Sweep<'_> {
    /// All regions and borders of `robot`'s study, with a line break at its end.
    pub fn text(&self, robot: &str, palette: &Palette) -> String {
        let mut out = String::new();
        // Writing into a string cannot fail.
        let _ = self.write(robot, palette, &mut out);
        out
    }

    fn write(&self, robot: &str, Palette { strong, faint, plain }: &Palette, out: &mut String) -> std::fmt::Result {
        let (count, name) = (self.regions.len(), self.parameter);
        let regions = if count == 1 { "one region".to_owned() } else { format!("{count} regions") };
        writeln!(out, "{strong}{robot}{plain} against {name}: {regions}, {} samples.\n", self.steps)?;
        let places: Vec<String> =
            self.regions.iter().map(|region| format!("{} .. {}", brief(region.from), brief(region.to))).collect();
        let width = places.iter().map(String::len).max().unwrap_or(0);
        let letters = self.regions.iter().map(|region| region.letter.len()).max().unwrap_or(1);
        for (index, (region, place)) in self.regions.iter().zip(places).enumerate() {
            let whole: Vec<String> = region.happening.lines();
            for (line, words) in whole.iter().enumerate() {
                let (letter, place) = if line == 0 { (region.letter.as_str(), place.as_str()) } else { ("", "") };
                writeln!(out, "{strong}{letter:letters$}{plain}  {place:width$}  {words}")?;
            }
            if let Some(border) = self.borders.get(index) {
                let sides = [&region.letter, &self.regions[index + 1].letter];
                let transition = border.transition.in_words(sides);
                writeln!(out, "{:letters$}  {faint}at {:?}: {transition}{plain}", "", border.at)?;
            }
        }
        for note in &self.notes {
            writeln!(out, "\nNote: {note}.")?;
        }
        Ok(())
    }
}

impl Happening<'_> {
    /// Its outcomes, one a line.
    pub fn lines(&self) -> Vec<String> {
        if let Some(error) = &self.error {
            return vec![format!("refused: {}", error.message)];
        }
        let Some(outcomes) = self.outcomes else { return vec!["refused".to_owned()] };
        let contacts = self.contacts.unwrap_or_default();
        let words = |modes: &Vec<_>| words::modes(contacts.iter().map(String::as_str), modes);
        let mut lines: Vec<String> = match outcomes {
            [] => vec!["no outcome".to_owned()],
            [only] if only.is_empty() => vec!["nothing touches the ground".to_owned()],
            outcomes => outcomes.iter().map(words).collect(),
        };
        if let (Some(Verdict::NoImpact), [only]) = (self.verdict, &mut lines[..]) {
            only.push_str(" (no impact)");
        }
        for more in lines.iter_mut().skip(1) {
            more.insert_str(0, "or ");
        }
        lines.extend(self.not_excluded());
        lines
    }

    /// The combinations that no precision excludes, one a line.
    pub fn not_excluded(&self) -> Vec<String> {
        let contacts = self.contacts.unwrap_or_default();
        let sentence = |modes: &Vec<_>| words::modes(contacts.iter().map(String::as_str), modes);
        self.undecided.unwrap_or_default().iter().map(|modes| format!("not excluded: {}", sentence(modes))).collect()
    }
}

impl Transition {
    /// What changes between regions of these letters, as a sentence without its end.
    pub fn in_words(&self, [below, above]: [&String; 2]) -> String {
        match (&self.refused_below, &self.refused_above) {
            (Some(_), None) => return format!("from {above} on states are answered"),
            (None, Some(_)) => return format!("from {above} on states are refused"),
            (Some(_), Some(_)) => return "states are refused for another reason".to_owned(),
            (None, None) => {}
        }
        let ends = |EndedOutcome { contact, inequality, modes, side }: &EndedOutcome| {
            let modes: Vec<String> = modes.iter().map(ToString::to_string).collect();
            let side = match side {
                Side::Below => below,
                Side::Above => above,
            };
            format!("{contact} has {inequality} where {} of {side} ends", modes.join("/"))
        };
        let alone = |contact: &String, side: &str| format!("{contact} touches the ground in {side} only");
        let opening = self.opening.iter().map(|contact| alone(contact, below));
        let closing = self.closing.iter().map(|contact| alone(contact, above));
        let all: Vec<String> = self.ended.iter().map(ends).chain(opening).chain(closing).collect();
        if all.is_empty() {
            return "the outcomes change, but no inequality of either side is seen to pass zero".to_owned();
        }
        all.join("; ")
    }
}

/// A number in as many digits as people read.
fn brief(value: f64) -> String {
    let rounded = format!("{value:.9}");
    match rounded.trim_end_matches('0').trim_end_matches('.') {
        "-0" | "" => "0".to_owned(),
        short if value == 0.0 || short != "0" => short.to_owned(),
        _ => format!("{value:.3e}"),
    }
}
