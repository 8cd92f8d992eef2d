//! Detection of resting contacts. A foot that stands in a simulation has c = J v of about 1e-17 m/s, whose sign has no
//! meaning. A contact counts as at rest if its velocity is zero within its error.
//!
//! ```text
//!     |c| <= rounding of J v + D,   D = sum of A_k dv_k + sum of |u_k| dq_k   where |c| <= 1e-4 sum of A_k |v_k|, else 0
//! ```
//!
//! The sums run over all coordinates k that move the contact. A_k bounds its arm from the joint. u_k is the velocity of
//! the joint's axis, by which the velocity of a resting contact changes with the angle. dv_k and dq_k are half units in
//! the last decimal places of the numbers ([`half_units`]). With a stance, the terms of its foot are added twice.

use super::Pipeline;
use super::assembly::Assembly;
use super::still::{Still, WELL_KNOWN};
use crate::contact::Contact;
use crate::dynamics::plan::{JointMotion, Plan};
use crate::dynamics::{RoundingBounds, Workspace, point_velocity};
use crate::error::{Error, Reason, Result, rounded};
use crate::impact::CONTACT_LIMIT;
use crate::planar::{Pair, Vector};
use crate::scalar::{Real, Residue};
use crate::state::State;
use std::cmp::Ordering;
use std::fmt;
use std::ops::RangeInclusive;

/// A velocity may come from rounding of the state's numbers if it is at most this fraction of the sum of its terms.
const CANCELED: f64 = 1e-4;
/// A contact whose velocity is at most this fraction of the sum of its terms may be one that stands.
const SUSPICIOUS: f64 = 1e-3;
/// Numbers with this many significant digits are taken as rounded; those with fewer are exact, with more full f64.
const ROUNDED: RangeInclusive<usize> = 6..=15;

/// Upper bound on the last place of an f32 number, relative to the number.
const ULP_OF_F32: f64 = f32::EPSILON as f64;

/// The text after the contact's name in the note on a resting contact, before the speeds.
pub(crate) const AT_REST: &str = " is taken as exactly at rest";

/// The stance of a state.
#[derive(Debug, Clone, Copy)]
pub(super) struct Standing<'a> {
    pub foot: Option<&'a Contact>,
    /// The index of this foot's contact.
    pub place: Option<usize>,
}

/// Why a contact is taken as resting, with the limit of its speed \[m/s\].
enum RestReason {
    Option(f64),
    Rounding(f64),
    Digits(f64),
}

impl Pipeline<'_> {
    /// Finds the contacts that rest, marks them in `resting`, and notes them unless the result is brief. `velocity` is
    /// dq/dt. The contacts' velocities and their bounds must be known.
    pub(super) fn find_resting(
        &mut self,
        state: &State,
        velocity: &[f64],
        contacts: &[Contact],
        Standing { foot, place }: Standing,
        (resting, notes): (&mut Vec<bool>, &mut Vec<String>),
    ) {
        resting.clear();
        resting.resize(contacts.len(), false);
        for (index, contact) in contacts.iter().enumerate() {
            let [speeds, bounds] = [self.assembly.workspace.contact_velocity[index], self.bounds.velocity[index]];
            let [slow, bound] = [length(speeds), length(bounds)];
            if place == Some(index) {
                continue;
            }
            // With an uncertainty, no speed is taken as zero unless the option asks for it.
            let is_strict = state.uncertainty.is_some() && self.options.resting_speed.is_none();
            let rests = || self.rests(state, velocity, [slow, bound], (index, contact), foot);
            let because = if is_strict { None } else { rests() };
            resting[index] = because.is_some();
            if self.options.brief {
                continue;
            }
            let name = &contact.name;
            if let Some(because) = because {
                // A smaller bound only covers underflow. Contacts on the foot of the stance need no note.
                let is_of_foot = self.assembly.loops.is_empty() && foot.is_some_and(|foot| foot.body == contact.body);
                let is_blurred = bound > f64::MIN_POSITIVE.sqrt() && self.options.resting_speed.is_none();
                if slow > 0.0 || is_blurred && !is_of_foot {
                    let moves =
                        if slow > 0.0 { format!(" although it moves at {slow:.1e} m/s") } else { String::new() };
                    notes.push(format!("{name}{AT_REST}{moves} ({because})"));
                }
            } else if bound > 0.0 && slow <= bound {
                let moves =
                    if slow > 0.0 { format!("moves at {slow:.1e} m/s, which is") } else { "does not move,".into() };
                notes.push(format!(
                    "{name} {moves} within the rounding of its velocity: if it is at rest, say so by `stance` or the \
                     option `resting_speed`"
                ));
            } else if speeds[1].abs() <= bounds[1]
                && (speeds[1] != 0.0 || bounds[1] > 0.0 && self.is_rounded_to_zero(state, contact, foot))
            {
                notes.push(format!(
                    "{name} slides, and moves at {} m/s along the normal, which is within the rounding of its velocity, so \
                     rounding decides whether it strikes",
                    rounded(speeds[1] + 0.0)
                ));
            } else if self.options.resting_speed.is_none()
                && slow > 0.0
                && slow <= SUSPICIOUS * self.bounds.terms(index)
            {
                notes.push(format!(
                    "{name} moves at {slow:.1e} m/s, far slower than the rates that add up to it: if it stands, say so by \
                     `stance` or the option `resting_speed: {:.0e}`",
                    2.0 * slow
                ));
            }
        }
    }

    /// Returns whether the normal velocity of a contact, which is zero in f64, is not zero in exact numbers; false for
    /// states with loops, for which this is not computed.
    fn is_rounded_to_zero(&self, state: &State, contact: &Contact, foot: Option<&Contact>) -> bool {
        let mut exact = Assembly::<Residue>::new(Plan::new(self.robot, &[], &[]));
        exact.configuration.set(&exact.plan, &state.position);
        exact.place();
        let point = |contact: &Contact| contact.exact_point(self.robot, state.scene.ground.axes(contact.ground));
        let mut velocity: Vec<Residue> = state.velocity.iter().map(|&entry| Residue::from_f64(entry)).collect();
        foot.into_iter().for_each(|foot| exact.rest(&point(foot), &mut velocity));
        let (point, are_loops_open) = (point(contact), self.assembly.loops.is_empty());
        are_loops_open && point.axes()[1].dot(exact.velocity_of(&point, &velocity)).is_zero() == Some(false)
    }

    /// Takes resting contacts as exactly at rest, once G is known. The c of contacts that depend on them becomes that
    /// of a motion in which they rest, because no impulses fit a c that no motion has.
    pub(super) fn settle(
        &mut self,
        contacts: &[Contact],
        (velocity, stance): (&[f64], Option<usize>),
        still: &mut Still,
        (resting, notes): (&mut [bool], &mut Vec<String>),
    ) {
        let Still { contacts: at_rest, rows, held } = &mut *still;
        at_rest.clear();
        rows.clear();
        held.clear();
        if !resting.contains(&true) {
            return;
        }
        let Assembly { workspace: Workspace { delassus, contact_velocity, .. }, left, .. } = &mut self.assembly;
        let RoundingBounds { velocity: bounds, delassus: error, .. } = &mut self.bounds;
        let stands = |index: usize| stance == Some(index) || contact_velocity[index] == [0.0; 2];
        at_rest.extend(resting.iter().enumerate().map(|(index, rests)| *rests || stands(index)));
        if !at_rest.contains(&false) {
            contact_velocity.fill([0.0; 2]);
            bounds.fill([0.0; 2]);
            return;
        }
        if contacts.len() <= CONTACT_LIMIT {
            still.find_rows(delassus, *error, left);
        }
        let size = 2 * contacts.len();
        self.assembly.settle(still, |row, [speed, pivot], delassus| {
            // |G_ir / pivot| is at most sqrt(G_ii / pivot), and `known` is its error relative to that.
            let known = *error * delassus[row * (size + 1)] / pivot;
            let off = bounds[row / 2][row % 2] + known * speed.abs();
            let reach = if known < WELL_KNOWN { 2.0 * off / pivot.sqrt() } else { f64::INFINITY };
            // A row that cannot move is not affected, not even by an infinite bound.
            for other in (0..size).filter(|other| delassus[other * (size + 1)] > 0.0) {
                bounds[other / 2][other % 2] += reach * delassus[other * (size + 1)].sqrt();
            }
        });
        let speeds = &mut self.assembly.workspace.contact_velocity;
        // Only a braked joint with a rate can move a held contact. An infinite bound leaves open whether it does.
        let is_driven = self.braked.iter().any(|joint| velocity[self.robot.base_dofs() + joint] != 0.0);
        for &index in &still.held {
            let [slow, bound] = [length(speeds[index]), length(bounds[index])];
            if slow > bound || is_driven && !bound.is_finite() {
                continue;
            }
            (still.contacts[index], resting[index], speeds[index]) = (true, true, [0.0; 2]);
            if !self.options.brief {
                let name = &contacts[index].name;
                notes.push(format!("{name}{AT_REST}: those at rest hold its body"));
            }
        }
        bounds.iter_mut().zip(&still.contacts).filter(|(_, still)| **still).for_each(|(bound, _)| *bound = [0.0; 2]);
    }

    /// Returns why a contact with the speed (or component) `slow`, known to `bound`, is taken as resting, if it is.
    fn rests(
        &self,
        state: &State,
        velocity: &[f64],
        [slow, bound]: [f64; 2],
        (index, contact): (usize, &Contact),
        foot: Option<&Contact>,
    ) -> Option<RestReason> {
        match self.options.resting_speed {
            Some(limit) => (slow < limit).then_some(RestReason::Option(limit)),
            // Loops are closed again in every number type; the rounding of this moves contacts that rest as given.
            None if bound == 0.0 && self.assembly.loops.is_empty() => None,
            None if slow <= bound => Some(RestReason::Rounding(bound)),
            None if slow > CANCELED * self.bounds.terms(index) => None,
            None => Some(bound + self.digits(state, velocity, contact, foot))
                .filter(|limit| slow <= *limit)
                .map(RestReason::Digits),
        }
    }

    /// Returns the sign of each contact's tangential velocity; `None` if the contact leaves the ground. Refuses a
    /// contact that approaches. Components within the limit of a resting contact are set to zero and noted.
    pub(super) fn slips(
        &mut self,
        state: &State,
        velocity: &[f64],
        contacts: &[Contact],
        foot: Option<&Contact>,
        notes: &mut Vec<String>,
    ) -> Result<Vec<Option<Ordering>>> {
        let mut slips = Vec::with_capacity(contacts.len());
        for (index, contact) in contacts.iter().enumerate() {
            let (speeds, bounds) = (self.assembly.workspace.contact_velocity[index], self.bounds.velocity[index]);
            for (row, along) in [(1, "along the normal"), (0, "along the ground")] {
                let slow = speeds[row].abs();
                if slow != 0.0
                    && let Some(because) = self.rests(state, velocity, [slow, bounds[row]], (index, contact), foot)
                {
                    self.assembly.workspace.contact_velocity[index][row] = 0.0;
                    let name = &contact.name;
                    notes.push(format!("{name} moves at {slow:.1e} m/s {along}, which is taken as zero ({because})"));
                }
            }
            let [tangential, normal] = self.assembly.workspace.contact_velocity[index];
            if normal < 0.0 {
                let reason =
                    format!("{} approaches the ground at {} m/s: that is an impact", contact.name, rounded(-normal));
                return Err(Error::new(Reason::Inconsistent(reason)).at("velocity").hint(
                    "ask `impact` what it does, and continue from a velocity after it; or take slow contacts as resting by \
                     a greater `resting_speed`",
                ));
            }
            slips.push((normal == 0.0).then(|| tangential.partial_cmp(&0.0).unwrap_or(Ordering::Equal)));
        }
        Ok(slips)
    }

    /// The speed that a resting contact may have because the state's numbers were rounded \[m/s\].
    fn digits(&self, state: &State, velocity: &[f64], contact: &Contact, foot: Option<&Contact>) -> f64 {
        let (plan, workspace) = (&self.assembly.plan, &self.assembly.workspace);
        let speed = |contact: &Contact, rates: &[f64]| self.bounds.speed(plan, contact.arm(self.robot), rates);
        let [turns, mut rates] = [&state.position, &state.velocity].map(|numbers| half_units(numbers));
        if foot.is_some() {
            // With a stance, the rates of the base are placeholders.
            rates[..2].fill(0.0);
        }
        let turned = |contact: &Contact| -> f64 {
            let axes = plan.way_to_root(contact.body).filter_map(|(index, body)| match body.motion {
                JointMotion::Root if plan.floating => Some((index, turns[2])),
                JointMotion::Revolute { rate, .. } => Some((index, turns[body.coordinate] * rate.abs())),
                _ => None,
            });
            axes.map(|(index, turn)| turn * point_velocity(plan, index, Vector::zero(), velocity, workspace).length())
                .sum()
        };
        let off = |contact: &Contact| speed(contact, &rates) + turned(contact);
        off(contact) + foot.map_or(0.0, |foot| 2.0 * off(foot))
    }
}

impl fmt::Display for RestReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Option(limit) => write!(f, "resting speed {limit} m/s"),
            Self::Rounding(limit) => write!(f, "its velocity is rounded by up to {limit:.1e} m/s"),
            Self::Digits(limit) => write!(f, "by the digits of the state it is known to {limit:.1e} m/s"),
        }
    }
}

#[inline]
fn length([t, n]: Pair<f64>) -> f64 {
    let squared = t * t + n * n;
    if squared.is_normal() { squared.sqrt() } else { libm::hypot(t, n) }
}

/// Returns half a unit in the last decimal place to which each number was rounded. A number whose shortest decimal has
/// six to fifteen significant digits was rounded to its last one. A shorter number may have lost trailing zeros: it is
/// taken to have as many digits as the longest of these, but no place finer than their finest. Others get 0. Numbers of
/// f32, and lists that may be the text of f32, get the rounding of f32 if that is greater.
fn half_units(numbers: &[f64]) -> Vec<f64> {
    let last_places: Vec<(usize, i32)> = numbers.iter().map(|&number| last_place(number)).collect();
    let rounded = || last_places.iter().filter(|(digits, _)| ROUNDED.contains(digits));
    let Some(finest) = rounded().map(|&(_, place)| place).min() else { return vec![0.0; numbers.len()] };
    let most = rounded().map(|&(digits, _)| digits).max().unwrap_or_default() as i32;
    let are_text_of_f32 = numbers.iter().all(|&number| is_text_of_single(number));
    let are_of_f32 = numbers.iter().any(|&number| is_single(number) && !is_text_of_single(number));
    let half_unit = |(&number, &(digits, place)): (&f64, &(usize, i32))| {
        let of_f32 = 0.5 * ULP_OF_F32 * number.abs();
        let place = match digits {
            0 => finest,
            digits if digits < *ROUNDED.start() && !is_text_of_single(number) => return of_f32,
            digits if digits < *ROUNDED.start() => finest.max(place + digits as i32 - most),
            digits if ROUNDED.contains(&digits) => place,
            _ => return 0.0,
        };
        let half = 0.5 * libm::exp10(f64::from(place));
        let is_of_f32 = are_text_of_f32 || are_of_f32 && is_single(number);
        if is_of_f32 { half.max(of_f32) } else { half }
    };
    numbers.iter().zip(&last_places).map(half_unit).collect()
}

/// Whether the shortest decimal of this number is also the shortest decimal of the nearest f32.
fn is_text_of_single(number: f64) -> bool {
    zmij::Buffer::new().format(number as f32).parse() == Ok(number)
}

/// Whether a number is exactly an f32, and so was rounded to one, whatever digits it has in f64.
fn is_single(number: f64) -> bool {
    f64::from(number as f32) == number
}

/// The number of digits in the shortest decimal of the number's precision, and the power of ten of the last one.
fn last_place(number: f64) -> (usize, i32) {
    let mut buffer = zmij::Buffer::new();
    let text = if is_single(number) { buffer.format(number as f32) } else { buffer.format(number) };
    let (decimal, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let exponent = exponent.parse().unwrap_or(0);
    let decimal = decimal.trim_end_matches('0');
    let (digits, place) = match decimal.strip_suffix('.') {
        Some(integer) => {
            let digits = integer.trim_end_matches('0');
            (digits, exponent + (integer.len() - digits.len()) as i32)
        }
        None => (decimal, exponent - decimal.find('.').map_or(0, |point| decimal.len() - point - 1) as i32),
    };
    let digits = digits.trim_start_matches(['-', '0', '.']).bytes().filter(u8::is_ascii_digit).count();
    (digits, place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_many_decimals_are_rounded_to_them() {
        let half = |numbers: &[f64]| half_units(numbers);
        // The format of `%.6f`.
        assert_eq!(half(&[0.566082, -1.191566, 0.5, 0.0]), [5e-7; 4]);
        // The format of `%.6g`, which drops zeros at the end.
        assert_eq!(half(&[0.00123457, -5.88049, 1234.56, -1.447, 0.0]), [5e-9, 5e-6, 5e-3, 5e-6, 5e-9]);
    }

    #[test]
    fn last_place_is_that_of_the_shortest_decimal() {
        for number in [1.0, -0.25, 12345.0, 1_234_500.0, 0.00123457, -5.88049, 0.1 + 0.2, 1.5e-9, 1e300, -7.25e22] {
            let text = format!("{number:e}");
            let (mantissa, exponent) = text.split_once('e').unwrap();
            let digits = mantissa.bytes().filter(u8::is_ascii_digit).count();
            assert_eq!(last_place(number), (digits, exponent.parse::<i32>().unwrap() - (digits as i32 - 1)), "{text}");
        }
    }

    #[test]
    fn numbers_of_f32_were_rounded_to_it() {
        let widened = [0.339_661_72_f32, -1.191_566_f32, 0.5].map(f64::from);
        let half = f64::exp2(-24.0);
        assert_eq!(half_units(&widened), [widened[0] * half, 5e-7, 0.5 * half]);
        // The format of NumPy, and a number that has four digits in f32.
        let printed = [0.123_456_79_f32, -1.234_567_8].map(|number| number.to_string().parse().unwrap());
        assert_eq!(half_units(&printed), printed.map(|number: f64| number.abs() * half));
        assert_eq!(half_units(&[f64::from(0.7275_f32), 0.123456])[0], f64::from(0.7275_f32) * half);
    }

    #[test]
    fn short_numbers_are_meant_and_long_ones_are_f64() {
        assert_eq!(half_units(&[1.0, -0.25, 12345.0, 0.0]), [0.0; 4]);
        assert_eq!(half_units(&[0.1 + 0.2, 1.0 / 3.0, 1.0]), [0.0; 3]);
        assert_eq!(half_units(&[0.1 + 0.2, 0.123456, 1.0]), [0.0, 5e-7, 5e-6]);
    }
}
