//! Texts that stand in the data once, however many stills have them.

use std::collections::HashMap;

/// Different texts, by number.
#[derive(Debug, Default)]
pub(super) struct Texts {
    pub all: Vec<String>,
    known: HashMap<String, usize>,
}

impl Texts {
    /// The number of a text.
    pub fn number(&mut self, text: String) -> usize {
        *self.known.entry(text).or_insert_with_key(|text| {
            self.all.push(text.clone());
            self.all.len() - 1
        })
    }
}
