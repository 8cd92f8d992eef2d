//! An interactive page: one file of HTML with its data, its plots and the program that shows them; nothing is loaded.
//!
//! ```text
//!     study, findings --[study]--┐
//!     Gait (a batch)  --[gait]---┴--> states, regions --[frame]--> Page --> HTML
//!     Picture --rendered--> SVG, windows of its panels ──────────────┘
//! ```
//!
//! A page stops at states with the robot in its configuration and every outcome. Texts and collision shapes that many
//! states share are in the data once; numbers have the digits that a screen shows.

mod frame;
mod study;
mod gait;

pub use gait::Gait;
pub use study::Stops;

use super::Keyframe;
use super::plot::{PlotWindow, Rendered};
use crate::error::visible;
use crate::write::words::{DrawnNames, Wording};
use frame::{PageFrame, PageScale, Weight};
use serde::Serialize;
use serde_json::value::RawValue;
use std::collections::HashMap;

/// The beginning of this page and of the live one.
const HEAD: &str = include_str!("head.html");
const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// In the order in which they need each other.
const PROGRAM: [&str; 5] = [
    include_str!("robot.js"),
    include_str!("plots.js"),
    include_str!("answer.js"),
    include_str!("slider.js"),
    include_str!("page.js"),
];

/// The most states that a page stops at; of more it takes every second, third ... one.
pub const MOST: usize = 5000;

/// A page to turn and step through, in one file.
#[derive(Debug, Clone, Default, Serialize)]
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
    wording: Option<DrawnNames>,
    windows: Vec<PlotWindow>,
    notes: Vec<String>,
    #[serde(skip)]
    svg: String,
}

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
        *self.known.entry(visible(&text.into()).into_owned()).or_insert_with_key(|text| {
            self.all.push(text.clone());
            self.all.len() - 1
        })
    }
}

impl Page {
    /// The frames of a page; `svg` is its picture.
    fn of(states: &[PageState], weight: Weight, Rendered { svg, windows }: Rendered) -> Self {
        let (mut parts, mut texts) = (Interned::default(), Interned::default());
        let scale = PageScale::of(states, weight);
        let frames = states.iter().map(|state| PageFrame::new(state, scale.unit, &mut parts, &mut texts)).collect();
        let parts = parts.all.into_iter().filter_map(|part| RawValue::from_string(part).ok()).collect();
        let aspect = states.iter().find_map(|state| Some(state.keyframe.answer.as_ref().ok()?.aspect));
        let wording = Some(Wording::of(aspect.unwrap_or_default()).drawn);
        Self { frames, wording, parts, texts: texts.all, scale, windows, svg, ..Self::default() }
    }

    /// A page of one state, whose data is drawn by a page that asks for it.
    pub fn of_state(title: String, keyframe: Keyframe) -> Self {
        let state = PageState { keyframe, region: None, name: None };
        Self { title, ..Self::of(&[state], Weight::Size, Rendered::default()) }
    }

    /// Its plots.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The whole page as HTML, with its scripts and data in it.
    pub fn html(&self) -> String {
        // As text of HTML.
        let title = self.title.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let parts: [(&str, &str); 7] = [
            ("{head}", HEAD),
            ("{title}", &title),
            ("{style}", STYLE),
            ("{heading}", &title),
            ("{plots}", &self.svg),
            ("{data}", &self.data()),
            ("{program}", &PROGRAM.concat()),
        ];
        let (mut html, mut rest) = (String::new(), TEMPLATE);
        for (place, content) in parts {
            // Inserted text is never searched for further places.
            let (before, after) = rest.split_once(place).unwrap_or((rest, ""));
            html.extend([before, content]);
            rest = after;
        }
        html + rest
    }

    /// The data as JSON in which no sign means anything to HTML.
    fn data(&self) -> String {
        // Writing into memory cannot fail.
        let json = serde_json::to_string(self).unwrap_or_default();
        json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
    }
}
