//! The regions of a study as text for people.

use super::{Happening, MapSweep, Regions, Sweep};
use crate::error::visible;
use crate::sweep::{BorderCurve, EndedOutcome, RESOLUTION, Side, Transition};
use crate::write::{Palette, words, written};
use crate::{Mode, Verdict};
use std::fmt::Write;

impl Regions<'_> {
    /// Returns all regions and borders of `robot`'s study as text that ends with a line break.
    pub fn text(&self, robot: &str, palette: &Palette) -> String {
        written(|out| self.write(robot, palette, out))
    }

    fn write(&self, robot: &str, palette: &Palette, out: &mut String) -> std::fmt::Result {
        let (names, regions, samples, notes) = match self {
            Self::Along(sweep) => (sweep.parameter.to_owned(), sweep.regions.len(), sweep.steps, &sweep.notes),
            Self::Map(map) => (map.parameters.join(" and "), map.regions.len(), map.samples, &map.notes),
        };
        let Palette { strong, plain, .. } = palette;
        let (robot, names) = (visible(robot), visible(&names));
        let regions = if regions == 1 { "one region".to_owned() } else { format!("{regions} regions") };
        writeln!(out, "{strong}{robot}{plain} against {names}: {regions}, {samples} samples.\n")?;
        match self {
            Self::Along(sweep) => sweep.write(palette, out)?,
            Self::Map(map) => map.write(palette, out)?,
        }
        notes.iter().try_for_each(|note| {
            writeln!(out, "\nNote: {}{}", visible(note), if note.ends_with('?') { "" } else { "." })
        })
    }
}

impl Sweep<'_> {
    fn write(&self, Palette { strong, faint, plain }: &Palette, out: &mut String) -> std::fmt::Result {
        let end = |at| self.place(at, brief);
        let places: Vec<String> =
            self.regions.iter().map(|region| format!("{} .. {}", end(region.from), end(region.to))).collect();
        let width = places.iter().map(String::len).max().unwrap_or(0);
        let letters = self.regions.iter().map(|region| region.letter.len()).max().unwrap_or(1);
        for (index, (region, place)) in self.regions.iter().zip(&places).enumerate() {
            for (line, words) in region.happening.lines().iter().enumerate() {
                let (letter, place) = if line == 0 { (&*region.letter, &**place) } else { ("", "") };
                writeln!(out, "{strong}{letter:letters$}{plain}  {place:width$}  {words}")?;
            }
            if let Some(border) = self.borders.get(index) {
                let sides = [index, index + 1].map(|at| (&*self.regions[at].letter, &self.regions[at].happening));
                let at = self.place(border.at, |at| format!("{at:?}"));
                let transition = border.transition.in_words(sides);
                writeln!(out, "{:letters$}  {faint}at {at}: {transition}{plain}", "")?;
            }
        }
        Ok(())
    }

    /// Formats a value of the parameter; a value that the resolution of borders does not distinguish from zero is `~0`.
    pub(crate) fn place(&self, at: f64, text: impl Fn(f64) -> String) -> String {
        let range = self.regions.iter().map(|region| region.to - region.from).sum::<f64>();
        if at != 0.0 && at.abs() < RESOLUTION * range { "~0".to_owned() } else { text(at) }
    }
}

impl MapSweep<'_> {
    fn write(&self, Palette { strong, faint, plain }: &Palette, out: &mut String) -> std::fmt::Result {
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
            let sides = sides.map(|at| (&*self.regions[at].letter, &self.regions[at].happening));
            let [left, right] = sides.map(|(letter, _)| letter);
            let line = format!("between {left} and {right}: {}", transition.in_words(sides));
            if !written.contains(&line) {
                writeln!(out, "{faint}{line}{plain}")?;
                written.push(line);
            }
        }
        Ok(())
    }
}

impl Happening<'_> {
    /// Returns the outcomes, one per line.
    pub fn lines(&self) -> Vec<String> {
        if let Some(error) = &self.error {
            let example = if self.has_depth { ", for example" } else { "" };
            return vec![format!("refused{example}: {}", error.message)];
        }
        let Some(outcomes) = self.outcomes else { return vec!["refused".to_owned()] };
        let mut lines: Vec<String> = match outcomes {
            [] => vec![words::Wording::of(self.question).nothing.to_owned()],
            [only] if only.is_empty() => vec!["nothing touches the ground".to_owned()],
            outcomes => outcomes.iter().map(|modes| self.in_words(modes)).collect(),
        };
        if let (Some(Verdict::NoImpact), [only]) = (self.verdict, &mut lines[..]) {
            only.push_str(" (no impact)");
        }
        lines.iter_mut().skip(1).for_each(|more| more.insert_str(0, "or "));
        lines.extend(self.not_excluded());
        lines
    }

    /// Returns the combinations that no precision excludes, one per line.
    pub fn not_excluded(&self) -> Vec<String> {
        let undecided = self.undecided.unwrap_or_default().iter();
        undecided.map(|modes| format!("not excluded: {}", self.in_words(modes))).collect()
    }

    fn in_words(&self, modes: &[Mode]) -> String {
        words::modes(self.contacts.unwrap_or_default(), modes)
    }
}

impl Transition {
    /// Describes what changes between these regions, each with its letter, as a sentence without its period.
    pub(crate) fn in_words(&self, [below, above]: [(&str, &Happening<'_>); 2]) -> String {
        match self.refused {
            [Some(_), None] => return format!("from {} on states are answered", above.0),
            [None, Some(_)] => return format!("from {} on states are refused", above.0),
            [Some(_), Some(_)] => return "states are refused for another reason".to_owned(),
            [None, None] => {}
        }
        let ends = |EndedOutcome { contact, inequality, modes, side }: &EndedOutcome| {
            let (letter, happening) = if *side == Side::Below { below } else { above };
            let names = happening.contacts.unwrap_or_default();
            let mode = names.iter().position(|name| name == contact).and_then(|at| modes.get(at));
            let ended = mode.map_or("an outcome", |&mode| words::verb(mode)[1]);
            let mut sentence = format!("{}, which ends {ended} in {letter}", inequality.reached_by(contact));
            if happening.outcomes.is_some_and(|outcomes| outcomes.len() > 1) {
                let others = names.iter().zip(modes).filter(|(name, _)| *name != contact);
                let (names, modes): (Vec<&String>, Vec<Mode>) = others.unzip();
                sentence.push_str(&match words::modes(names, &modes) {
                    others if others.is_empty() => others,
                    others => format!(" ({others})"),
                });
            }
            sentence
        };
        let alone = |contact: &String, letter: &str| format!("{contact} touches the ground in {letter} only");
        let opening = self.opening.iter().map(|contact| alone(contact, below.0));
        let closing = self.closing.iter().map(|contact| alone(contact, above.0));
        let all: Vec<String> = self.ended.iter().map(ends).chain(opening).chain(closing).collect();
        if all.is_empty() {
            return "the outcomes change, but no inequality of either side is seen to pass zero".to_owned();
        }
        visible(&all.join("; ")).into_owned()
    }
}

/// Formats a number with at most nine decimals, or with an exponent if they show nothing of it.
fn brief(value: f64) -> String {
    let rounded = format!("{value:.9}");
    match rounded.trim_end_matches('0').trim_end_matches('.') {
        "-0" | "0" if value == 0.0 => "0".to_owned(),
        "-0" | "0" => format!("{value:.3e}"),
        short => short.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn small_numbers_have_an_exponent_whatever_their_sign() {
        let shown = [0.0, -0.0, 1e-10, -1e-10, -0.25, 1e-9].map(super::brief);
        assert_eq!(shown, ["0", "0", "1.000e-10", "-1.000e-10", "-0.25", "0.000000001"]);
    }
}
