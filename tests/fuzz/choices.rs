//! Bytes read as choices; where they end, every choice is the first one.

use serde_json::Value;
use std::collections::BTreeSet;

/// The names of all fields of states, problems and studies, from the list that hints and schemas follow.
pub fn field_names() -> String {
    fn collect(value: &Value, names: &mut BTreeSet<String>) {
        let Value::Object(entries) = value else { return };
        for (name, entry) in entries {
            if name == "properties" {
                names.extend(entry.as_object().into_iter().flatten().map(|(field, _)| field.clone()));
            }
            collect(entry, names);
        }
    }
    let format = serde_json::from_str(include_str!("../../src/read/format.json")).expect("a schema");
    let mut names = BTreeSet::new();
    collect(&format, &mut names);
    names.into_iter().collect::<Vec<_>>().join(" ")
}

/// Reads choices from bytes, whichever engine made these.
pub struct Choices<'a> {
    bytes: &'a [u8],
}

impl<'a> Choices<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.bytes.split_first() else { return 0 };
        self.bytes = rest;
        first
    }

    fn bits(&mut self) -> u64 {
        (0..8).fold(0, |bits, _| bits << 8 | u64::from(self.byte()))
    }

    /// A number below `count`, which is not 0.
    pub fn below(&mut self, count: usize) -> usize {
        let wide = if count <= 256 { 0 } else { usize::from(self.byte()) << 8 };
        (wide | usize::from(self.byte())) % count
    }

    pub fn once_in(&mut self, count: usize) -> bool {
        self.below(count) == count - 1
    }

    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }

    /// A whole number from -`most` to `most`; 0 comes first.
    pub fn whole(&mut self, most: usize) -> i32 {
        let at = self.below(2 * most + 1) as i32;
        if at % 2 == 0 { at / 2 } else { -(at + 1) / 2 }
    }

    /// From -1 to 1, with every digit.
    pub fn real(&mut self) -> f64 {
        self.bits() as i64 as f64 / (1u64 << 63) as f64
    }

    /// A number of any size, now and then none at all.
    pub fn number(&mut self) -> f64 {
        match self.below(16) {
            0..4 => f64::from(self.whole(4)),
            4 | 5 => f64::from(self.whole(16)) / 8.0,
            6..10 => self.real(),
            10 | 11 => 0.1 * f64::from(self.whole(20)),
            12 => 2f64.powi(self.whole(60)),
            13 => self.real() * 10f64.powi(self.whole(300)),
            14 if self.once_in(2) => f64::from(self.whole(2)).next_up(),
            14 => f64::from(self.whole(2)).next_down(),
            _ => f64::from_bits(self.bits()),
        }
    }

    /// All bytes that are left.
    pub fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.bytes)
    }

    /// Any bytes, one of `samples` that is changed, or what `write` writes, changed or mostly not.
    pub fn text(&mut self, samples: &[&str], words: &str, write: impl Fn(&mut Self) -> String) -> Vec<u8> {
        let sample = match self.below(16) {
            0 => return self.rest().to_vec(),
            1..4 => self.pick(samples).to_owned(),
            4..6 => write(self),
            _ => return write(self).into_bytes(),
        };
        self.mutated(&sample, words)
    }

    /// A text changed in a few places: pieces taken out, doubled, put elsewhere, and some of these words put in.
    fn mutated(&mut self, text: &str, words: &str) -> Vec<u8> {
        let words: Vec<&str> = words.split_whitespace().collect();
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..=self.below(6) {
            let at = self.below(bytes.len() + 1);
            let length = match self.below(4) {
                0 => 1,
                1 | 2 => self.below(20),
                _ => self.below(400),
            };
            let end = (at + length).min(bytes.len());
            match self.below(8) {
                0 => drop(bytes.drain(at..end)),
                1 => {
                    let piece = bytes[at..end].to_vec();
                    bytes.splice(at..at, piece);
                }
                2 => {
                    let piece: Vec<u8> = bytes.drain(at..end).collect();
                    let place = self.below(bytes.len() + 1);
                    bytes.splice(place..place, piece);
                }
                3 => {
                    let byte = self.byte();
                    bytes.splice(at..at, [byte]);
                }
                4 => bytes.truncate(at.max(bytes.len() / 2)),
                5 => {
                    let number = format!("{:?}", self.number());
                    bytes.splice(at..end, number.into_bytes());
                }
                // A whole word or number gives way to another.
                _ => {
                    let inside = |byte: &u8| byte.is_ascii_alphanumeric() || b"._-+".contains(byte);
                    let start = at - bytes[..at].iter().rev().take_while(|byte| inside(byte)).count();
                    let end = at + bytes[at..].iter().take_while(|byte| inside(byte)).count();
                    bytes.splice(start..end, self.pick(&words).bytes());
                }
            }
        }
        bytes
    }
}
