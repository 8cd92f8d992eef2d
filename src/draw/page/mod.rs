//! An interactive page: one file of HTML with its data, its plots and the program that shows them; nothing is loaded.
//!
//! ```text
//!     study, findings --[study]--┐
//!     Gait (a batch)  --[gait]---┴--> states, regions --[frame]--> Page --[html]--> HTML
//!     Picture --rendered--> SVG, windows of its panels ──────────────┘
//! ```
//!
//! A page stops at states with the robot in its configuration and every outcome. Texts and collision shapes that many
//! states share are in the data once; numbers have the digits that a screen shows.

mod number;
mod frame;
mod html;
mod study;
mod gait;

pub use gait::Gait;
pub use study::Stops;

use super::Keyframe;
use super::plot::{PlotWindow, Rendered};
use frame::{PageFrame, PageScale};
use serde::Serialize;
use serde_json::value::RawValue;
use std::collections::HashMap;

/// The most states that a page stops at; of more it takes every second, third ... one.
pub const MOST: usize = 5000;

/// An interactive page.
#[derive(Debug, Clone, Serialize)]
pub struct Page {
    title: String,
    /// One or two: what the states are ordered by.
    axes: Vec<PageAxis>,
    regions: Vec<PageRegion>,
    /// In the order of the axes, the last of which changes fastest.
    frames: Vec<PageFrame>,
    parts: Vec<Box<RawValue>>,
    texts: Vec<String>,
    scale: PageScale,
    windows: Vec<PlotWindow>,
    notes: Vec<String>,
    #[serde(skip)]
    svg: String,
}

/// What states are ordered by.
#[derive(Debug, Clone, Serialize)]
struct PageAxis {
    name: String,
    values: Vec<f64>,
}

/// Neighboring states with the same outcomes.
#[derive(Debug, Clone, Serialize)]
struct PageRegion {
    /// A letter, or a word.
    name: String,
    /// The color of its part of the track.
    fill: &'static str,
    /// Its ends, and what changes there.
    borders: Vec<[String; 2]>,
}

/// A state that the page stops at, the number of its region and its name in the input.
#[derive(Debug, Clone)]
struct PageState {
    keyframe: Keyframe,
    region: Option<usize>,
    name: Option<String>,
}

/// Different texts, by number.
#[derive(Debug, Default)]
struct Interned {
    all: Vec<String>,
    known: HashMap<String, usize>,
}

impl Interned {
    fn number(&mut self, text: impl Into<String>) -> usize {
        *self.known.entry(text.into()).or_insert_with_key(|text| {
            self.all.push(text.clone());
            self.all.len() - 1
        })
    }
}

impl Page {
    fn new(
        title: String,
        axes: Vec<PageAxis>,
        regions: Vec<PageRegion>,
        states: &[PageState],
        Rendered { svg, windows }: Rendered,
        notes: Vec<String>,
    ) -> Self {
        let (mut parts, mut texts) = (Interned::default(), Interned::default());
        let scale = PageScale::of(states);
        let frames = states.iter().map(|state| PageFrame::new(state, scale.unit, &mut parts, &mut texts)).collect();
        let parts = parts.all.into_iter().filter_map(|part| RawValue::from_string(part).ok()).collect();
        Self { title, axes, regions, frames, parts, texts: texts.all, scale, windows, notes, svg }
    }
}
