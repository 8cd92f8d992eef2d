//! Which strict modes one combination of the enumeration stands for.

use crate::law::{Law, Mode};

/// The lists of modes that one leaf stands for: all whose impulses are the same.
#[derive(Debug, Clone, Default)]
pub struct Labels {
    modes: Vec<Mode>,
    /// Contacts whose mode varies, and the modes.
    open: Vec<(usize, &'static [Mode])>,
    started: bool,
}

impl Labels {
    /// Begins with the modes of a leaf; `shares` is whether modes with the same impulses are visited as one.
    pub fn start(&mut self, modes: &[Mode], laws: &[Law], shares: bool) {
        self.modes.clear();
        self.modes.extend_from_slice(modes);
        self.open.clear();
        if shares {
            let group = |(contact, (mode, law)): (usize, (&Mode, &Law))| {
                let group = law.modes().iter().find(|group| group[0] == *mode)?;
                (group.len() > 1).then_some((contact, *group))
            };
            self.open.extend(modes.iter().zip(laws).enumerate().filter_map(group));
        }
        self.started = false;
    }

    /// The next list of modes, if there is one.
    pub fn next(&mut self) -> Option<&[Mode]> {
        if !self.started {
            self.started = true;
            return Some(&self.modes);
        }
        for &(contact, group) in &self.open {
            let place = group.iter().position(|&mode| mode == self.modes[contact])?;
            self.modes[contact] = group[(place + 1) % group.len()];
            if place + 1 < group.len() {
                return Some(&self.modes);
            }
        }
        None
    }
}
