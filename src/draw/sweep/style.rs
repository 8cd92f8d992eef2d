//! How lines along a parameter are drawn, and their legend: colors for components, dashes for outcomes.

use super::{KindLook, angles, is_seen};
use crate::draw::plot::{Color, Dash, LegendEntry, LegendKey, Stroke};
use crate::law::Mode;
use crate::sweep::Survey;
use crate::write::words;

/// The components and their lines: if both are equal, the wider one shows behind the other.
pub(super) const COMPONENTS: [(&str, Stroke); 2] =
    [("tangential", Stroke::solid(Color::Blue, 2.8)), ("normal", Stroke::solid(Color::Vermilion, 1.6))];

/// How the lines of each outcome are drawn.
pub(super) struct OutcomeStyles<'a>(Vec<OutcomeStyle<'a>>);

struct OutcomeStyle<'a> {
    contacts: &'a [String],
    modes: &'a [Mode],
    /// Its own dashes; `None` if its region identifies it.
    dash: Option<Dash>,
    /// Of the first region in which it is valid.
    color: Color,
    /// The letters of the regions in which it is valid.
    letters: Vec<String>,
    /// Whether another outcome is also valid somewhere.
    ambiguous: bool,
    /// Whether its lines are visible anywhere.
    seen: bool,
}

impl<'a> OutcomeStyles<'a> {
    /// If some region is ambiguous, each visible outcome has its own dashes wherever it is valid. If there are more
    /// outcomes than dashes, only those of ambiguous regions have them.
    pub fn of(survey: &'a Survey, kinds: &[KindLook]) -> Self {
        let mut styles: Vec<OutcomeStyle> = Vec::new();
        for region in &survey.regions {
            let contacts = region.regime.contacts();
            let KindLook { letter, color, .. } = &kinds[region.kind];
            let outcomes = region.regime.outcomes().unwrap_or_default();
            let seen = is_seen(region, survey);
            for modes in outcomes.iter().filter(|modes| !modes.is_empty()) {
                let known = styles.iter().position(|style| (style.contacts, style.modes) == (contacts, modes));
                let at = known.unwrap_or(styles.len());
                if known.is_none() {
                    let (letters, ambiguous, seen) = (Vec::new(), false, false);
                    styles.push(OutcomeStyle { contacts, modes, dash: None, color: *color, letters, ambiguous, seen });
                }
                let style = &mut styles[at];
                style.ambiguous |= outcomes.len() > 1 && seen;
                style.seen |= seen;
                if !style.letters.contains(letter) {
                    style.letters.push(letter.clone());
                }
            }
        }
        let seen = styles.iter().filter(|style| style.seen).count();
        let all = seen <= Dash::ALL.len() && styles.iter().any(|style| style.ambiguous);
        let dashed = styles.iter_mut().filter(|style| style.ambiguous || all && style.seen);
        dashed.zip(Dash::ALL.into_iter().cycle()).for_each(|(style, dash)| style.dash = Some(dash));
        Self(styles)
    }

    pub fn dash(&self, contacts: &[String], modes: &[Mode]) -> Dash {
        let own = self.0.iter().find(|style| (style.contacts, style.modes) == (contacts, modes));
        own.and_then(|style| style.dash).unwrap_or(Dash::SOLID)
    }

    /// Components, angles, outcomes with the letters of their regions, and regions without outcomes.
    pub fn legend(&self, kinds: &[KindLook], angles: bool) -> Vec<LegendEntry> {
        let mut entries = Vec::new();
        if !self.0.is_empty() {
            entries.extend(COMPONENTS.map(|(name, stroke)| LegendEntry::new(name, LegendKey::Line(stroke))));
        }
        if angles {
            entries.extend(angles::legend());
        }
        entries.extend(self.0.iter().map(|OutcomeStyle { contacts, modes, dash, color, letters, .. }| {
            let sentence = words::modes(contacts.iter().map(String::as_str), modes);
            let line = |dash| LegendKey::Line(Stroke { dash, ..Stroke::solid(Color::Black, 1.6) });
            let key = dash.map_or(LegendKey::Fill(*color), line);
            LegendEntry::new(format!("{}: {sentence}", letters.join(", ")), key)
        }));
        for KindLook { letter, color, happening } in kinds {
            let answered = happening.outcomes.unwrap_or_default().iter().any(|modes| !modes.is_empty());
            let lines = if answered { happening.not_excluded() } else { happening.lines() };
            if !lines.is_empty() {
                entries.push(LegendEntry::new(format!("{letter}: {}", lines.join("\n")), LegendKey::Fill(*color)));
            }
        }
        entries
    }
}
