//! Where an outcome on a border leads.

use super::mode::{Friction, Mode};
use super::outcome::{Border, Motion, Zero};
use super::sign::SlackKind;
use crate::planar::Vector;

/// The border of an outcome whose impulse inequalities `at_zero` are zero; none where there is none.
pub fn border(
    modes: &[Mode],
    friction: &[Friction],
    at_zero: &[(usize, SlackKind)],
    motion: &Motion,
) -> Option<Border> {
    if at_zero.is_empty() {
        return None;
    }
    let mut border = Border { at_zero: Vec::new(), neighbours: Vec::new() };
    for contact in 0..modes.len() {
        let own = || at_zero.iter().filter(|(place, _)| *place == contact).map(|&(_, kind)| kind);
        let unpressed = own().any(|kind| kind == SlackKind::Pressure);
        // Without pressure the cone is its own tip, and says nothing more.
        let zero = |kind: SlackKind| match kind {
            SlackKind::Pressure => Some(Zero::NormalImpulse),
            SlackKind::Drag => Some(Zero::TangentialImpulse),
            SlackKind::Cone if !unpressed => Some(Zero::FrictionCone),
            _ => None,
        };
        border.at_zero.extend(own().filter_map(zero).map(|zero| (contact, zero)));
        if own().next().is_some() {
            for mode in beyond(modes[contact], friction[contact], unpressed, motion.impulse[contact]) {
                let mut neighbour = modes.to_vec();
                neighbour[contact] = mode;
                border.neighbours.push(neighbour);
            }
        }
    }
    Some(border)
}

/// The modes that share a closed contact's velocity and impulse, where one of its inequalities is zero.
fn beyond(mode: Mode, friction: Friction, unpressed: bool, [l_t, _]: Vector<f64>) -> Vec<Mode> {
    if mode != Mode::Stick {
        return vec![Mode::Separate];
    }
    // Friction acts against the slide.
    let slides = |forward: bool, backward: bool| {
        let chosen = [(forward, Mode::SlidePlus), (backward, Mode::SlideMinus)];
        chosen.into_iter().filter(|(chosen, _)| *chosen).map(|(_, mode)| mode).collect::<Vec<_>>()
    };
    match friction {
        Friction::Finite(mu) if unpressed => {
            let mut modes = vec![Mode::Separate];
            // A frictionless contact changes its direction without passing a border.
            modes.extend(slides(mu > 0.0, mu > 0.0));
            modes
        }
        Friction::Finite(_) => slides(l_t < 0.0, l_t > 0.0),
        Friction::Infinite => {
            let mut modes: Vec<Mode> = (l_t == 0.0).then_some(Mode::Separate).into_iter().collect();
            modes.extend(slides(l_t <= 0.0, l_t >= 0.0));
            modes
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_s_edge_leads_to_the_slide_that_its_friction_resists() {
        let motion = Motion { impulse: vec![[0.5, 1.0]], velocity_after: vec![[0.0, 0.0]] };
        let friction = [Friction::Finite(0.5)];
        let found = border(&[Mode::Stick], &friction, &[(0, SlackKind::Cone)], &motion).unwrap();
        assert_eq!(found.at_zero, [(0, Zero::FrictionCone)]);
        assert_eq!(found.neighbours, [[Mode::SlideMinus]]);
        assert_eq!(border(&[Mode::Stick], &friction, &[], &motion), None);
    }

    #[test]
    fn a_contact_without_pressure_may_do_anything_next() {
        let motion = Motion { impulse: vec![[0.0, 0.0]; 2], velocity_after: vec![[0.0, 0.0]; 2] };
        let friction = [Friction::Finite(0.5), Friction::ZERO];
        let at_zero = [(0, SlackKind::Pressure), (0, SlackKind::Cone), (1, SlackKind::Pressure)];
        let found = border(&[Mode::Stick; 2], &friction, &at_zero, &motion).unwrap();
        assert_eq!(found.at_zero, [(0, Zero::NormalImpulse), (1, Zero::NormalImpulse)]);
        let first = [Mode::Separate, Mode::SlidePlus, Mode::SlideMinus].map(|mode| vec![mode, Mode::Stick]);
        assert_eq!(found.neighbours[..3], first);
        assert_eq!(found.neighbours[3..], [vec![Mode::Stick, Mode::Separate]]);
    }
}
