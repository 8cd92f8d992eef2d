//! An interactive page: one file of HTML with its data, its plots and the program that shows them; nothing is loaded.
//!
//! ```text
//!     study, findings --[study]--┐
//!     Gait (a batch)  --[gait]---┴--> stills, regions --[frame, part]--> Page --[html]--> HTML
//!     Picture --rendered--> SVG, windows of its panels ────────────────────┘
//! ```
//!
//! A page stops at stills: states with the robot where it is and every outcome. What many of them share (texts, collision
//! shapes) stands in the data once; numbers have the digits that a screen shows.

mod frame;
mod gait;
mod html;
mod number;
mod part;
mod study;
mod texts;

pub use gait::Gait;
pub use study::Stops;

use super::Keyframe;
use super::plot::{PlotWindow, Rendered};
use frame::{Frame, Scale};
use part::{Part, Parts};
use serde::Serialize;
use texts::Texts;

/// The most states that a page stops at; of more it takes every second, third ... one.
pub const STILLS: usize = 5000;

/// What a page shows.
#[derive(Debug, Clone, Serialize)]
pub struct Page {
    title: String,
    /// One or two: what the stills are ordered by.
    axes: Vec<Axis>,
    regions: Vec<Region>,
    /// In the order of the axes, the last of which changes fastest.
    frames: Vec<Frame>,
    parts: Vec<Part>,
    texts: Vec<String>,
    scale: Scale,
    windows: Vec<PlotWindow>,
    notes: Vec<String>,
    #[serde(skip)]
    svg: String,
}

/// What stills are ordered by.
#[derive(Debug, Clone, Serialize)]
struct Axis {
    name: String,
    values: Vec<f64>,
}

/// Neighbouring stills with the same outcomes.
#[derive(Debug, Clone, Serialize)]
struct Region {
    /// A letter, or a word.
    name: String,
    /// The color of its part of the track.
    fill: &'static str,
    /// Where it ends, and what turns there.
    borders: Vec<[String; 2]>,
}

/// A state that the page stops at.
#[derive(Debug, Clone)]
struct Still {
    keyframe: Keyframe,
    /// In which region it is, if it is in one.
    region: Option<usize>,
    /// What the user calls it.
    name: Option<String>,
}

impl Page {
    fn new(
        title: String,
        axes: Vec<Axis>,
        regions: Vec<Region>,
        stills: &[Still],
        Rendered { svg, windows }: Rendered,
        notes: Vec<String>,
    ) -> Self {
        let (mut parts, mut texts) = (Parts::default(), Texts::default());
        let scale = Scale::of(stills);
        let frames = stills.iter().map(|still| Frame::new(still, scale.unit, &mut parts, &mut texts)).collect();
        let (parts, texts) = (parts.all, texts.all);
        Self { title, axes, regions, frames, parts, texts, scale, windows, notes, svg }
    }
}
