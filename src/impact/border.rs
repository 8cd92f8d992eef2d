//! Where an outcome on a border leads.

use super::outcome::{AtZero, Border, Motion};
use crate::law::{ContactLaw, Inequality, Law, Mode};
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

    fn name(contact: usize) -> String {
        contact.to_string()
    }

    fn zeros(border: &Border) -> Vec<(&str, Inequality)> {
        border.at_zero.iter().map(|zero| (&*zero.contact, zero.inequality)).collect()
    }

    #[test]
    fn a_cone_s_edge_leads_to_the_slide_that_its_friction_resists() {
        let motion = Motion { impulse: vec![[0.5, 1.0]], velocity_after: vec![[0.0, 0.0]] };
        let friction = [Friction::Finite(0.5).into()];
        let found = border(&[Mode::Stick], &friction, &[(0, Inequality::FrictionCone)], &motion, name).unwrap();
        assert_eq!(zeros(&found), [("0", Inequality::FrictionCone)]);
        assert_eq!(found.neighbours, [[Mode::SlideMinus]]);
        assert_eq!(border(&[Mode::Stick], &friction, &[], &motion, name), None);
    }

    #[test]
    fn a_contact_without_pressure_may_do_anything_next() {
        let motion = Motion { impulse: vec![[0.0, 0.0]; 2], velocity_after: vec![[0.0, 0.0]; 2] };
        let friction = [Friction::Finite(0.5), Friction::ZERO].map(Law::from);
        let at_zero = [(0, Inequality::NormalImpulse), (0, Inequality::FrictionCone), (1, Inequality::NormalImpulse)];
        let found = border(&[Mode::Stick; 2], &friction, &at_zero, &motion, name).unwrap();
        assert_eq!(zeros(&found), [("0", Inequality::NormalImpulse), ("1", Inequality::NormalImpulse)]);
        let first = [Mode::Separate, Mode::SlidePlus, Mode::SlideMinus].map(|mode| vec![mode, Mode::Stick]);
        assert_eq!(found.neighbours[..3], first);
        assert_eq!(found.neighbours[3..], [vec![Mode::Stick, Mode::Separate]]);
    }
}
