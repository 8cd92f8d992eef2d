//! Names, modes, verdicts and grades in words. Every function except [`id`] returns [`visible`] text.

use super::table::number;
use crate::error::visible;
use crate::impact::{Border, OpenCombinations};
use crate::pipeline::Aspect;
use crate::{Mode, Outcome, Verdict};
use serde::Serialize;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::HashMap;
use std::hash::Hash;

/// Returns the name with the id, as in `ramone (k17)`.
pub fn titled(name: &str, id: &Option<Value>) -> String {
    let title = id.as_ref().map_or_else(|| name.to_owned(), |id| format!("{name} ({})", self::id(id)));
    visible(&title).into_owned()
}

/// Returns the id without quotes.
pub(crate) fn id(id: &Value) -> Cow<'_, str> {
    id.as_str().map_or_else(|| id.to_string().into(), Cow::Borrowed)
}

/// Returns the number of things of a kind, as in `1 shape` and `2 shapes`.
pub(crate) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Returns `margin 0.0130, index +1`, or the part that is known.
pub(crate) fn grades(margin: Option<f64>, index: Option<i8>) -> String {
    let margin = margin.map(|margin| format!("margin {}", number(margin)));
    let index = index.map(|index| format!("index {index:+}"));
    margin.into_iter().chain(index).collect::<Vec<_>>().join(", ")
}

/// Returns a clause per contact, as in `left_foot lifts off, right_foot sticks`.
pub(crate) fn modes(names: impl IntoIterator<Item: AsRef<str>>, modes: &[Mode]) -> String {
    let clauses =
        names.into_iter().zip(modes).map(|(name, mode)| format!("{} {}", visible(name.as_ref()), verb(*mode)[0]));
    clauses.collect::<Vec<_>>().join(", ")
}

/// Returns what is zero on a border, as in `the normal impulse of left_foot reaches zero`.
pub(crate) fn at_zero(border: &Border) -> String {
    let zeros = border.at_zero.iter().map(|zero| zero.inequality.reached_by(&visible(&zero.contact)));
    zeros.collect::<Vec<_>>().join(", ")
}

const NUMBERS: [&str; 10] = ["No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine"];

/// The names and units of the numbers of an impact, or of those of forces.
#[derive(Debug)]
pub(crate) struct Wording {
    pub energy: &'static str,
    /// Heads of the contact velocities before the impact (t, n).
    pub before: [&'static str; 2],
    /// Heads of the impulses in an outcome's table (t, n).
    pub impulse: [&'static str; 2],
    pub after: [&'static str; 2],
    pub on_loops: [&'static str; 2],
    /// Head of the table of v after the impact.
    pub coordinates: &'static str,
    pub rates: &'static str,
    pub others: &'static str,
    /// The sentence for a region without an outcome.
    pub nothing: &'static str,
    pub drawn: DrawnNames,
}

/// Names and units in pictures and pages.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct DrawnNames {
    /// Impulse or force of the ground on a contact, and the contact's velocity or acceleration that results.
    pub given: (&'static str, &'static str),
    pub taken: (&'static str, &'static str),
    /// Velocity before the impact, and the unit of what is lost.
    pub moving: &'static str,
    pub lost: &'static str,
}

const IMPACT: Wording = Wording {
    energy: "Kinetic energy before the impact",
    before: ["before: t [m/s]", "n [m/s]"],
    impulse: ["impulse: t [N s]", "n [N s]"],
    after: ["after: t [m/s]", "n [m/s]"],
    on_loops: ["impulse on a: x [N s]", "z [N s]"],
    coordinates: "velocity after",
    rates: "velocities",
    others: "other impulses give the same velocities",
    nothing: "no outcome",
    drawn: DrawnNames {
        given: ("impulse", "N s"),
        taken: ("velocity after", "m/s"),
        moving: "velocity before",
        lost: "J lost",
    },
};

const FORCES: Wording = Wording {
    energy: "Kinetic energy",
    before: ["velocity: t [m/s]", "n [m/s]"],
    impulse: ["force: t [N]", "n [N]"],
    after: ["acceleration: t [m/s^2]", "n [m/s^2]"],
    on_loops: ["force on a: x [N]", "z [N]"],
    coordinates: "acceleration",
    rates: "accelerations",
    others: "other forces give the same accelerations",
    nothing: "no forces are consistent: velocities jump",
    drawn: DrawnNames {
        given: ("force", "N"),
        taken: ("acceleration", "m/s\u{b2}"),
        moving: "velocity",
        lost: "W lost",
    },
};

const UNSETTLED: &str = "some sign was settled by no precision";

/// The verdict `none` of sustained contact.
pub(crate) const NO_FORCES: &str = "No forces are consistent: velocities jump";

impl Wording {
    pub fn of(aspect: Aspect) -> &'static Self {
        match aspect {
            Aspect::Impact => &IMPACT,
            Aspect::Forces => &FORCES,
        }
    }

    /// Returns the verdict as a sentence; `open` counts the open combinations, if there are any.
    pub fn verdict(&self, verdict: Verdict, outcomes: &[Outcome], open: Option<&OpenCombinations>) -> String {
        if let Some(&OpenCombinations { combinations, undecided, beyond_budget }) = open {
            let listed = outcomes.iter().filter(|outcome| !outcome.decided).count() as u64;
            let listed = if listed == undecided { String::new() } else { format!(", of which {listed} are listed") };
            if beyond_budget || !listed.is_empty() {
                let why = if beyond_budget { "the budget of work ended (`budget`)" } else { UNSETTLED };
                return format!(
                    "Undecided: {why}, and {undecided} of {combinations} combinations of modes are open{listed}."
                );
            }
        }
        let sentence = match verdict {
            Verdict::Unique => "Exactly one outcome.",
            Verdict::Ambiguous => {
                let count = outcomes.len();
                let count = NUMBERS.get(count).map_or(count.to_string(), |word| (*word).to_owned());
                let corner = outcomes.iter().find(|outcome| outcome.family);
                let families = corner.map(|_| format!(", and so are the families of {} between them", self.rates));
                let families = families.unwrap_or_default();
                return format!("{count} outcomes are equally valid{families}.");
            }
            Verdict::None if self.drawn.given == FORCES.drawn.given => NO_FORCES,
            // Contacts with a regular Delassus matrix always have an outcome.
            Verdict::None => {
                "No outcome is consistent: contacts that depend on each other are asked for rebounds, or are held to the \
                 ground, as no impulses can do together; lower `restitution`, or name fewer `contacts`."
            }
            Verdict::Undecided => return format!("Undecided: {UNSETTLED}; what it leaves open is listed."),
            Verdict::NoImpact => "No impact: the only outcome needs no impulse from the ground.",
            Verdict::NoContact => return format!("No contact: the ground gives no {}.", self.drawn.given.0),
        };
        sentence.to_owned()
    }
}

/// Returns the mode as in `lifts off` and as in `lifting off`.
pub(crate) fn verb(mode: Mode) -> [&'static str; 2] {
    match mode {
        Mode::Separate => ["lifts off", "lifting off"],
        Mode::Stick => ["sticks", "sticking"],
        Mode::SlidePlus => ["slides forward", "sliding forward"],
        Mode::SlideMinus => ["slides backward", "sliding backward"],
    }
}

/// Lists the names that fit into `room` characters, at least the first, and says how many more there are.
pub(crate) fn list(names: &[impl AsRef<str>], room: usize) -> String {
    let mut end = 0;
    let fits = |name: &&_| {
        end += AsRef::<str>::as_ref(*name).chars().count() + 2;
        end <= room + 2
    };
    let shown = names.iter().take_while(fits).count().max(1).min(names.len());
    let mut text = visible(&names[..shown].iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", ")).into_owned();
    if shown < names.len() {
        text.push_str(&format!(" and {} more", names.len() - shown));
    }
    text
}

/// Groups things by their keys, in the order in which the keys first occur.
pub(crate) fn grouped<K: Clone + Eq + Hash, T>(pairs: impl IntoIterator<Item = (K, T)>) -> Vec<(K, Vec<T>)> {
    let mut groups: Vec<(K, Vec<T>)> = Vec::new();
    let mut places: HashMap<K, usize> = HashMap::new();
    for (key, thing) in pairs {
        let place = *places.entry(key.clone()).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, things)) => things.push(thing),
            None => groups.push((key, vec![thing])),
        }
    }
    groups
}
