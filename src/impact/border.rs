//! Where an outcome on a border leads.

use super::outcome::{AtZero, Border, Motion};
use crate::law::{Inequality, Law, Mode};
use std::cmp::Ordering;

/// The border of an outcome whose impulse inequalities `at_zero` are zero; `None` if none is.
pub fn border(
    modes: &[Mode],
    laws: &[Law],
    at_zero: &[(usize, Inequality)],
    motion: &Motion,
    name: impl Fn(usize) -> String,
) -> Option<Border> {
    if at_zero.is_empty() {
        return None;
    }
    let mut border = Border { at_zero: Vec::new(), neighbours: Vec::new() };
    for (contact, (&mode, law)) in modes.iter().zip(laws).enumerate() {
        let own = || at_zero.iter().filter(|(place, _)| *place == contact).map(|&(_, inequality)| inequality);
        // Without pressure the cone is its own tip, and says nothing more.
        let unpressed = own().find(|&inequality| inequality == Inequality::NormalImpulse);
        let Some(inequality) = unpressed.or_else(|| own().next()) else { continue };
        border.at_zero.push(AtZero { contact: name(contact), inequality });
        let tangential = motion.impulse[contact][0].partial_cmp(&0.0).unwrap_or(Ordering::Equal);
        for beyond in law.beyond(mode, inequality, tangential).into_iter().filter(|&beyond| beyond != mode) {
            let mut neighbour = modes.to_vec();
            neighbour[contact] = beyond;
            border.neighbours.push(neighbour);
        }
    }
    Some(border)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Friction;

    #[test]
    fn border_leads_to_the_modes_beside_it() {
        use Inequality::{FrictionCone, NormalImpulse};
        let laws = [Friction::Finite(0.5), Friction::ZERO].map(Law::from);
        for (tangential, at_zero, expected, neighbours) in [
            // A cone's edge leads to the slide that its friction resists.
            (0.5, vec![(0, FrictionCone)], vec![("0", FrictionCone)], vec![[Mode::SlideMinus, Mode::Stick]]),
            // A contact without pressure may do anything next.
            (
                0.0,
                vec![(0, NormalImpulse), (0, FrictionCone), (1, NormalImpulse)],
                vec![("0", NormalImpulse), ("1", NormalImpulse)],
                vec![
                    [Mode::Separate, Mode::Stick],
                    [Mode::SlidePlus, Mode::Stick],
                    [Mode::SlideMinus, Mode::Stick],
                    [Mode::Stick, Mode::Separate],
                ],
            ),
        ] {
            let motion = Motion { impulse: vec![[tangential, 1.0]; 2], velocity_after: vec![[0.0, 0.0]; 2] };
            let found = border(&[Mode::Stick; 2], &laws, &at_zero, &motion, |contact| contact.to_string()).unwrap();
            let zeros: Vec<_> = found.at_zero.iter().map(|zero| (&*zero.contact, zero.inequality)).collect();
            assert_eq!((zeros, found.neighbours), (expected, neighbours.iter().map(|modes| modes.to_vec()).collect()));
        }
    }
}
