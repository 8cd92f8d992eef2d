//! Which strict modes one combination of the enumeration stands for.

use super::mode::{Friction, Mode};

/// The strict modes that one leaf stands for: a closed frictionless contact may slide either way or rest.
#[derive(Debug, Clone, Default)]
pub struct Labels {
    modes: Vec<Mode>,
    /// Contacts whose label varies.
    open: Vec<usize>,
    started: bool,
}

impl Labels {
    /// Begins with the labels of a leaf; its own modes alone, unless frictionless contacts `share` theirs.
    pub fn start(&mut self, modes: &[Mode], friction: &[Friction], share: bool) {
        self.modes.clear();
        self.modes.extend_from_slice(modes);
        self.open.clear();
        let varies = |&contact: &usize| share && modes[contact] == Mode::Stick && friction[contact].is_zero();
        self.open.extend((0..modes.len()).filter(varies));
        self.started = false;
    }

    /// The next list of modes, if there is one.
    pub fn next(&mut self) -> Option<&[Mode]> {
        if !self.started {
            self.started = true;
            return Some(&self.modes);
        }
        for &contact in &self.open {
            self.modes[contact] = match self.modes[contact] {
                Mode::Stick => Mode::SlidePlus,
                Mode::SlidePlus => Mode::SlideMinus,
                _ => Mode::Stick,
            };
            if self.modes[contact] != Mode::Stick {
                return Some(&self.modes);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frictionless_contact_has_three_labels_where_it_is_closed() {
        let mut labels = Labels::default();
        let friction = [Friction::ZERO, Friction::Infinite, Friction::ZERO];
        let count = |labels: &mut Labels| {
            let mut seen = std::collections::HashSet::new();
            while let Some(modes) = labels.next() {
                assert!(seen.insert(modes.to_vec()), "twice: {modes:?}");
            }
            seen.len()
        };
        labels.start(&[Mode::Stick, Mode::Stick, Mode::Stick], &friction, true);
        assert_eq!(count(&mut labels), 9);
        labels.start(&[Mode::Stick, Mode::Stick, Mode::Stick], &friction, false);
        assert_eq!(count(&mut labels), 1);
        labels.start(&[Mode::Separate, Mode::Stick, Mode::Stick], &friction, true);
        assert_eq!(count(&mut labels), 3);
        labels.start(&[Mode::Separate, Mode::SlidePlus, Mode::Separate], &friction, true);
        assert_eq!(count(&mut labels), 1);
    }
}
