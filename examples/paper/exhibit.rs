//! A figure's robot and study, or state, and what is found there.

use super::figures::{Figure, Input};
use heelstrike::Robot;
use heelstrike::description::Description;
use heelstrike::impact::Analysis;
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::robot::Reduction;
use heelstrike::state::{Defaults, State};
use heelstrike::sweep::{Findings, Map, RobotStudy, Study, Survey, Workers};
use std::error::Error;
use std::fs::read_to_string;
use std::path::PathBuf;
use std::thread::available_parallelism;

/// Where the studies are, and where pictures go unless another directory is given.
pub const HERE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/paper");
const ROBOTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/urdf");

impl Figure {
    /// Where its study or state is.
    pub fn path(&self) -> PathBuf {
        format!("{HERE}/{}.json", self.input.name()).into()
    }
}

/// The files of a figure.
pub struct Exhibit {
    figure: &'static Figure,
    text: String,
    description: Description,
    /// As the file has it.
    pub robot: Robot,
}

/// What a figure shows.
pub enum Found {
    /// The regions of a study.
    Regions(Findings),
    /// One state, its outcomes and everything that is none.
    Outcomes(Box<(State, Box<Impact>)>),
}

impl Exhibit {
    /// Reads the files of `figure`.
    ///
    /// # Errors
    /// Missing files, and a robot that is refused.
    pub fn read(figure: &'static Figure) -> Result<Self, Box<dyn Error>> {
        Self::read_with(figure, read_to_string(figure.path())?)
    }

    /// Reads the robot of `figure`, for another study or state than its own.
    ///
    /// # Errors
    /// A missing file, and a robot that is refused.
    pub fn read_with(figure: &'static Figure, text: String) -> Result<Self, Box<dyn Error>> {
        let description = Description::from_urdf(&read_to_string(format!("{ROBOTS}/{}.urdf", figure.robot))?)?;
        let robot = Robot::reduce(&description, &Reduction::default())?;
        Ok(Self { figure, text, description, robot })
    }

    /// The regions of a study, or the outcomes of a state.
    ///
    /// # Errors
    /// A study or a state that is refused.
    pub fn found(&self) -> heelstrike::Result<Found> {
        match self.figure.input {
            Input::Study(_) | Input::Explained(_) => self.study(Findings::of).map(Found::Regions),
            Input::State(_) => self.outcomes(),
        }
    }

    /// Asks about the study, with all cores.
    ///
    /// # Errors
    /// A study that is refused.
    pub fn study<T>(&self, ask: impl FnOnce(&RobotStudy, Workers) -> T) -> heelstrike::Result<T> {
        let study = Study::from_json(&self.text)?;
        let model = RobotStudy {
            study: &study,
            description: &self.description,
            reduction: &Reduction::default(),
            robot: &self.robot,
            options: self.options(),
            defaults: Defaults::default(),
        };
        model.has_own_friction()?;
        let threads = available_parallelism().map_or(1, usize::from);
        Ok(ask(&model, Workers { threads, done: &|| () }))
    }

    fn options(&self) -> Options {
        let explain_up_to = match self.figure.input {
            Input::Study(_) => 0,
            Input::Explained(_) | Input::State(_) => usize::MAX,
        };
        Options { explain_up_to, ..Options::default() }
    }

    fn outcomes(&self) -> heelstrike::Result<Found> {
        let state = State::from_json(&self.text, &self.robot, &Defaults::default())?;
        let impact = Pipeline::new(&self.robot, self.options()).impact(&state)?;
        Ok(Found::Outcomes(Box::new((state, impact))))
    }
}

impl Found {
    /// The regions along one parameter.
    ///
    /// # Errors
    /// Where something else was found.
    pub fn survey(&self) -> Result<&Survey, String> {
        match self {
            Self::Regions(Findings::Along(survey)) => Ok(survey),
            _ => Err("this is no study of one parameter".into()),
        }
    }

    /// The regions of two parameters.
    ///
    /// # Errors
    /// Where something else was found.
    pub fn map(&self) -> Result<&Map, String> {
        match self {
            Self::Regions(Findings::Map(map)) => Ok(map),
            _ => Err("this is no study of two parameters".into()),
        }
    }

    /// The outcomes of a state.
    ///
    /// # Errors
    /// Where something else was found, or none could be.
    pub fn analysis(&self) -> Result<&Analysis, String> {
        match self {
            Self::Outcomes(found) => found.1.analyzed().map_err(|error| error.to_string()),
            Self::Regions(_) => Err("this is no state".into()),
        }
    }
}
