//! Interactive pages: one HTML file with data, plots and the program that shows them. A page loads nothing else.
//!
//! ```text
//!     study, findings --[study]--┐
//!     Gait (a batch)  --[gait]---┴--> states, regions --[frame]--> Page --> HTML
//!     Picture --rendered--> SVG, windows of its panels ──────────────┘
//! ```
//!
//! A page shows one of many states at a time: the robot in its configuration and every outcome. Texts and collision
//! shapes that many states share are stored once. Numbers have as many digits as a screen shows.

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

/// The beginning of a page; the live page in `web/` begins with it, too.
const HEAD: &str = include_str!("head.html");
const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// The scripts; each uses only those before it.
const PROGRAM: [&str; 5] = [
    include_str!("robot.js"),
    include_str!("plots.js"),
    include_str!("answer.js"),
    include_str!("slider.js"),
    include_str!("page.js"),
];

/// The largest number of states on a page; longer lists are thinned at even intervals. The sides and middles of the
/// regions of a study are not counted.
pub const MOST: usize = 5000;

/// An interactive page in one file.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Page {
    title: String,
    /// One or two quantities by which the states are ordered.
    axes: Vec<PageAxis>,
    regions: Vec<PageRegion>,
    /// The states in the order of the axes; the last axis changes fastest.
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
    /// A letter or a word.
    name: String,
    /// The color of the region behind the slider.
    fill: &'static str,
    /// The place of each border and what changes there.
    borders: Vec<[String; 2]>,
}

/// A state of a page, the index of its region, and its name in the input.
#[derive(Debug, Clone)]
struct PageState {
    keyframe: Keyframe,
    region: Option<usize>,
    name: Option<String>,
}

/// Different texts and their numbers.
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
    /// Creates a page with the frames of `states` and this picture.
    fn of(states: &[PageState], weight: Weight, Rendered { svg, windows }: Rendered) -> Self {
        let (mut parts, mut texts) = (Interned::default(), Interned::default());
        let scale = PageScale::of(states, weight);
        let frames = states.iter().map(|state| PageFrame::new(state, scale.unit, &mut parts, &mut texts)).collect();
        let parts = parts.all.into_iter().filter_map(|part| RawValue::from_string(part).ok()).collect();
        let aspect = states.iter().find_map(|state| Some(state.keyframe.answer.as_ref().ok()?.aspect));
        let wording = Some(Wording::of(aspect.unwrap_or_default()).drawn);
        Self { frames, wording, parts, texts: texts.all, scale, windows, svg, ..Self::default() }
    }

    /// Creates a page of one state. The live page draws its data.
    pub fn of_state(title: String, keyframe: Keyframe) -> Self {
        let state = PageState { keyframe, region: None, name: None };
        Self { title, ..Self::of(&[state], Weight::SIZE, Rendered::default()) }
    }

    /// Returns the plots as SVG; empty without plots.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// Returns the page as HTML, with its scripts and its data.
    pub fn html(&self) -> String {
        // The title is text; its markup is escaped.
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
            // Inserted text is not searched for further placeholders.
            let (before, after) = rest.split_once(place).unwrap_or((rest, ""));
            html.extend([before, content]);
            rest = after;
        }
        html + rest
    }

    /// Returns the data as JSON without characters that have a meaning in HTML.
    fn data(&self) -> String {
        // Writing into memory cannot fail.
        let json = serde_json::to_string(self).unwrap_or_default();
        json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
    }
}
