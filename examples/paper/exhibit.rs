//! A figure's robot with its study or state, and what is found there.

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

/// Directory of the studies, and of the pictures unless another one is given.
pub const HERE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/paper");
const ROBOTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/urdf");

impl Figure {
    /// Path of the figure's study or state.
    pub fn path(&self) -> PathBuf {
        format!("{HERE}/{}.json", self.input.name()).into()
    }
}

/// The files of a figure.
pub struct Exhibit {
    figure: &'static Figure,
    text: String,
    description: Description,
    /// The robot as its file has it.
    pub robot: Robot,
}

/// What a figure shows.
pub enum Found {
    /// The regions of a study.
    Regions(Findings),
    /// One state with its outcomes and rejections.
    Outcomes(Box<(State, Box<Impact>)>),
}

impl Exhibit {
    /// Reads the files of `figure`.
    ///
    /// # Errors
    /// Returns an error if a file is missing or the robot is refused.
    pub fn read(figure: &'static Figure) -> Result<Self, Box<dyn Error>> {
        Self::read_with(figure, read_to_string(figure.path())?)
    }

    /// Reads the robot of `figure`, for the study or state in `text`.
    ///
    /// # Errors
    /// Returns an error if the file is missing or the robot is refused.
    pub fn read_with(figure: &'static Figure, text: String) -> Result<Self, Box<dyn Error>> {
        let description = Description::from_urdf(&read_to_string(format!("{ROBOTS}/{}.urdf", figure.robot))?)?;
        let robot = Robot::reduce(&description, &Reduction::default())?;
        Ok(Self { figure, text, description, robot })
    }

    /// The regions of a study, or the outcomes of a state.
    ///
    /// # Errors
    /// Returns an error if the study or the state is refused.
    pub fn found(&self) -> heelstrike::Result<Found> {
        match self.figure.input {
            Input::Study(_) | Input::Explained(_) => self.study(Findings::of).map(Found::Regions),
            Input::State(_) => self.outcomes(),
        }
    }

    /// Calls `ask` with the study and a worker for each core.
    ///
    /// # Errors
    /// Returns an error if the study is refused.
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
    /// Returns an error if something else was found.
    pub fn survey(&self) -> Result<&Survey, String> {
        match self {
            Self::Regions(Findings::Along(survey)) => Ok(survey),
            _ => Err("this is no study of one parameter".into()),
        }
    }

    /// The regions of two parameters.
    ///
    /// # Errors
    /// Returns an error if something else was found.
    pub fn map(&self) -> Result<&Map, String> {
        match self {
            Self::Regions(Findings::Map(map)) => Ok(map),
            _ => Err("this is no study of two parameters".into()),
        }
    }

    /// The outcomes of a state.
    ///
    /// # Errors
    /// Returns an error if something else was found, or the state has no analysis.
    pub fn analysis(&self) -> Result<&Analysis, String> {
        match self {
            Self::Outcomes(found) => found.1.analyzed().map_err(|error| error.to_string()),
            Self::Regions(_) => Err("this is no state".into()),
        }
    }
}
