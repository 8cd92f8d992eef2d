//! The page's questions and the core's answers.

use heelstrike::budget::SharedBudget;
use heelstrike::draw::page::{Page, Stops};
use heelstrike::draw::{Forward, Keyframe, sweep};
use heelstrike::planar::Vector;
use heelstrike::robot::{Base, Reduction};
use heelstrike::sweep::{Findings, RobotStudy, Workers};
use heelstrike::write::sweep::Regions;
use heelstrike::write::{ErrorObject, Palette, Refused, Subject, text, titled};
use heelstrike::{
    Budget, Defaults, Description, Detail, Error, Inspection, Options, Pipeline, Reason, Report, Result, Robot, State,
    Study,
};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Limit on the time of an answer, by the clock of [`budget`].
const LONGEST: Duration = Duration::from_secs(1);

/// Time by which that clock advances at each reading, about the time of the work between two readings.
const READING: Duration = Duration::from_millis(2);

/// Up to this many contacts the text says why the other combinations fail.
const SUMMED_UP: usize = 6;

/// Robots and states that come with the page.
const EXAMPLES: [[&str; 3]; 3] = [
    ["RAMone", include_str!("../../urdf/ramone.urdf"), include_str!("../../examples/ramone.json")],
    [
        "Minimalistic walker",
        include_str!("../../urdf/minimalistic.urdf"),
        include_str!("../../examples/minimalistic.json"),
    ],
    ["Block that jams", include_str!("../../urdf/block.urdf"), include_str!("../../examples/block_jams.json")],
];

/// A question of the page.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Question {
    Examples(()),
    /// The text of a URDF file.
    Robot(String),
    Impact(Asked),
    Sweep(Asked),
}

/// A state, or a study with one parameter, and how far from the ground a foot still touches \[m\].
#[derive(Debug, Deserialize)]
struct Asked {
    of: Box<RawValue>,
    tolerance: Option<f64>,
}

/// What was read of a robot, the limits of its coordinates, and a state to begin with.
#[derive(Serialize)]
struct Read<'a> {
    robot: Inspection<'a>,
    text: String,
    limits: Vec<Option<[f64; 2]>>,
    state: Option<Box<RawValue>>,
}

/// The JSON and text that `heelstrike impact` writes, the state with all of its coordinates, the place of its root, and
/// its drawing.
#[derive(Serialize)]
struct Answered {
    result: Option<Box<RawValue>>,
    text: String,
    state: Option<Box<RawValue>>,
    /// The root's origin in the world \[m\].
    base: Option<Vector<f64>>,
    page: Page,
}

#[derive(Serialize)]
struct Swept<'a> {
    text: String,
    svg: &'a str,
    page: &'a Page,
}

/// A robot as its file has it, and reduced to its plane.
struct Model {
    description: Description,
    reduction: Reduction,
    robot: Robot,
}

thread_local! {
    static MODEL: RefCell<Option<Model>> = const { RefCell::new(None) };
}

/// The answer to a question, or why there is none, as JSON.
pub fn answer(question: &[u8]) -> Vec<u8> {
    let refused = |error: &Error| json(&serde_json::json!({"error": ErrorObject::new(error)}));
    match serde_json::from_slice(question) {
        Ok(question) => MODEL.with_borrow_mut(|model| asked(model, question)).unwrap_or_else(|error| refused(&error)),
        Err(error) => refused(&Error::new(Reason::Inconsistent(error.to_string()))),
    }
}

fn asked(model: &mut Option<Model>, question: Question) -> Result<Vec<u8>> {
    let missing = || Error::new(Reason::Missing("a robot".into()));
    match (question, model) {
        (Question::Examples(()), _) => Ok(json(&EXAMPLES)),
        (Question::Robot(urdf), model) => Ok(json(&model.insert(Model::read(&urdf)?).in_words()?)),
        (_, None) => Err(missing()),
        (Question::Impact(asked), Some(model)) => Ok(json(&model.impact(asked.of.get(), options(asked.tolerance)))),
        (Question::Sweep(asked), Some(model)) => model.sweep(asked.of.get(), options(asked.tolerance)),
    }
}

/// A value as JSON; writing into memory cannot fail.
fn json(value: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec(value).unwrap_or_default()
}

fn raw(text: String) -> Option<Box<RawValue>> {
    RawValue::from_string(text).ok()
}

fn options(contact_tolerance: Option<f64>) -> Options {
    Options { contact_tolerance, explain_up_to: SUMMED_UP, budget: Some(budget()), ..Options::default() }
}

/// The budget of an answer. WebAssembly gives the core no clock, so this one counts its readings.
fn budget() -> Budget {
    static READ: AtomicU64 = AtomicU64::new(0);
    let clock = || READING.saturating_mul(u32::try_from(READ.fetch_add(1, Ordering::Relaxed)).unwrap_or(u32::MAX));
    Budget { time: LONGEST, clock }
}

impl Model {
    /// Reads a robot without meshes, which are files that the page does not have.
    fn read(urdf: &str) -> Result<Self> {
        let (description, reduction) = (Description::from_urdf(urdf)?, Reduction::default());
        let robot = Robot::reduce(&description, &reduction)?;
        Ok(Self { description, reduction, robot })
    }

    /// What was read, and a state in which the robot falls on its lowest foot.
    fn in_words(&self) -> Result<Read<'_>> {
        let Self { robot, .. } = self;
        let inspection = Inspection::new(robot, &[]);
        let state = match robot.base() {
            Base::Floating => r#"{"place": "lowest", "velocity": {"base": {"z": -1}}, "friction": 0.6}"#,
            Base::Fixed => r#"{"friction": 0.6}"#,
        };
        let state = State::from_json(state, robot, &Defaults::default())?.to_json(robot)?;
        let text = inspection.text(&Palette::default(), false);
        let limits = robot.joints().iter().map(|joint| joint.limits).collect();
        Ok(Read { robot: inspection, text, limits, state: raw(state) })
    }

    /// The answer to a state, or a refusal as `heelstrike impact` writes it.
    fn impact(&self, text: &str, options: Options) -> Answered {
        let answered =
            State::from_json(text, &self.robot, &Defaults::default()).and_then(|state| self.answered(&state, options));
        answered.unwrap_or_else(|error| {
            let refused = Refused::new(State::id_in(text), 1, &error);
            let words = refused.error.to_string();
            let page = Page::of_state(self.robot.name().to_owned(), Keyframe::refused(error));
            Answered { result: raw(serde_json::json!(refused).to_string()), text: words, state: None, base: None, page }
        })
    }

    fn answered(&self, state: &State, options: Options) -> Result<Answered> {
        let (robot, detail) = (&self.robot, Detail::default());
        let impact = Pipeline::new(robot, options).answer(state)?;
        let report = Report::of_state(robot, state, &impact, detail)?;
        let mut result = Vec::new();
        report.append_json(detail, &mut result);
        let page = Page::of_state(titled(robot.name(), &state.id), Keyframe::of_impact(robot, &[], state, &impact));
        Ok(Answered {
            result: raw(String::from_utf8_lossy(result.trim_ascii_end()).into_owned()),
            text: text(&report, &Subject::of_state(robot, state, &impact), detail, &Palette::default()),
            state: raw(state.to_json(robot)?),
            base: robot.bodies().first().map(|_| impact.placement.world(0, Vector::zero())),
            page,
        })
    }

    fn sweep(&self, text: &str, options: Options) -> Result<Vec<u8>> {
        let Self { description, reduction, robot } = self;
        let study = &Study::from_json(text)?;
        Findings::check_memory(study)?;
        let options = Options { budget: None, ..options };
        let model = RobotStudy { study, description, reduction, robot, options, defaults: Defaults::default() };
        model.has_own_friction()?;
        let workers = Workers { threads: 1, done: &|| {} };
        let swept = || {
            let findings = Findings::of(&model, workers);
            let text = Regions::new(study, &findings).text(robot.name(), &Palette::default());
            let rendered = sweep::of(&model, &findings, Forward::Along, workers).render().unwrap_or_default();
            let page =
                Page::of_study(&model, &findings, &Stops::new(&model, &findings), rendered, Forward::Along, workers);
            json(&Swept { text, svg: page.svg(), page: &page })
        };
        SharedBudget::new(budget()).within(swept).map_err(|spent| study.beyond(spent))
    }
}
