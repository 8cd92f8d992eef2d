//! Counts ignored elements by kind.

use super::{Ignored, xml};
use crate::error::{Reason, Result};
use roxmltree::Node;
use std::collections::HashMap;

/// The most kinds of ignored elements.
const MOST_IGNORED: usize = 1000;

/// Counts of ignored elements.
#[derive(Default)]
pub(super) struct Tally {
    pub(super) kinds: Vec<Ignored>,
    by_tag: HashMap<(&'static str, String), usize>,
}

impl Tally {
    /// Counts `element`, a child of a `parent`.
    pub(super) fn count(&mut self, parent: &'static str, element: Node<'_, '_>) -> Result<()> {
        let tag = element.tag_name().name();
        let kind = *self.by_tag.entry((parent, tag.into())).or_insert(self.kinds.len());
        if kind == MOST_IGNORED {
            let reason = Reason::TooMany { what: "kinds of unknown elements", limit: MOST_IGNORED };
            return Err(xml::refuse(element, reason));
        }
        match self.kinds.get_mut(kind) {
            Some(known) => known.count += 1,
            None => self.kinds.push(Ignored { parent, tag: tag.into(), count: 1 }),
        }
        Ok(())
    }
}
