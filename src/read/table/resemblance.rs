//! Decides whether the name of a column may be a variant of another name.
//!
//! ```text
//!     name, known --[plain]--> the same, the coordinate alone or with another word for position or velocity,
//!                              or one or two letters wrong
//! ```
//!
//! Everything that depends on only one of both names is computed once per name, because a table of 20,000 columns forms
//! 60,000,000 pairs with the names of a robot of 1,500 joints.

/// Words for a position and for a velocity.
const WORDS: [&[&str]; 2] = [
    &["q", "qpos", "pos", "position", "angle"],
    &["v", "vel", "velocity", "dq", "qd", "qdot", "qvel", "dot", "rate", "omega"],
];
/// Largest number of words that are looked for in a name.
const MOST_WORDS: usize = 4;

/// Returns the name in lower case without a unit in brackets, with `_` in place of inner punctuation.
pub(super) fn plain(name: &str) -> String {
    let letter = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let without_unit = name.split(['[', '(']).next().unwrap_or(name);
    without_unit.chars().map(letter).collect::<String>().trim_matches('_').to_owned()
}

/// Returns the names that remain when one part that is among the `words` is removed, as in `base_z` from `base_vel_z`.
pub(super) fn without_one_of(name: &str, words: &[&str]) -> Vec<String> {
    let parts: Vec<&str> = name.split('_').collect();
    let places = (0..parts.len()).filter(|&at| words.contains(&parts[at])).take(MOST_WORDS);
    places.map(|at| [&parts[..at], &parts[at + 1..]].concat().join("_")).collect()
}

/// A name with the values that its comparisons need.
pub(super) struct Compared {
    pub plain: String,
    /// The bits of the characters in `plain`; several characters share a bit.
    bits: u64,
    /// The names that remain without a word for a position, and without a word for a velocity.
    rests: [Vec<String>; 2],
}

impl Compared {
    pub fn new(name: &str) -> Self {
        let plain = plain(name);
        let bits = plain.chars().fold(0, |bits, letter| bits | 1 << (letter as u32 % u64::BITS));
        let rests = WORDS.map(|words| without_one_of(&plain, words));
        Self { plain, bits, rests }
    }

    /// Returns whether a column of this name may be meant as the column `known`: it differs only in case and
    /// punctuation, names the coordinate alone or with another word for position or velocity, or has one or two wrong
    /// letters.
    pub fn resembles(&self, known: &Self) -> bool {
        // Matches "restitution_coefficient" and "friction of the left foot", but not "friction_force".
        const OTHER_QUANTITIES: [&str; 7] = ["needed", "force", "torque", "loss", "power", "margin", "joint"];
        let (name, known_name) = (self.plain.as_str(), known.plain.as_str());
        let mut parts = name.split('_');
        let is_mu = || known_name == "friction" && (name.starts_with("mu_") || name.ends_with("_mu") || name == "mu");
        if matches!(known_name, "friction" | "restitution")
            && (is_mu() || parts.clone().any(|part| part == known_name))
            && !parts.any(|part| OTHER_QUANTITIES.contains(&part))
        {
            return true;
        }
        let kind = ["q_", "v_"].iter().position(|prefix| known_name.starts_with(prefix));
        if let (Some(kind), Some((_, coordinate))) = (kind, known_name.split_once('_')) {
            let alone = |name: &str| name == coordinate || Some(name) == coordinate.strip_prefix("base_");
            if alone(name) || self.rests[kind].iter().any(|rest| alone(rest)) {
                return true;
            }
            // Another quantity of this coordinate, such as a torque, is no part of a state.
            if name.strip_suffix(coordinate).is_some_and(|rest| rest.ends_with('_')) {
                return false;
            }
        }
        let wrong = match known_name.len() {
            0..4 => 0,
            4..8 => 1,
            _ => 2,
        };
        // A replaced letter changes at most two bits. The edit distance takes the longest, so it is computed last.
        (self.bits ^ known.bits).count_ones() as usize <= 2 * wrong
            && name.len().abs_diff(known_name.len()) <= wrong
            && strsim::osa_distance(name, known_name) <= wrong
    }
}
