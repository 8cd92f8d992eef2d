//! A figure's robot and study, or state, and what is found there.

use crate::figures::{Figure, Input};
use heelstrike::Robot;
use heelstrike::description::Description;
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::robot::Reduction;
use heelstrike::state::{Defaults, State};
use heelstrike::sweep::{Findings, Map, Model, Study, Survey, Workers};
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
    robot: Robot,
}

/// What a figure shows.
pub enum Found {
    /// Regions along one parameter.
    Along(Survey),
    /// Regions of two parameters.
    Map(Map),
    /// One state's outcomes and everything that is none.
    State(Box<Impact>),
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
            Input::Study(_) => self.regions(),
            Input::State(_) => self.outcomes(),
        }
    }

    fn regions(&self) -> heelstrike::Result<Found> {
        let study = Study::from_json(&self.text)?;
        let model = Model {
            study: &study,
            description: &self.description,
            reduction: &Reduction::default(),
            robot: &self.robot,
            options: Options::default(),
            defaults: Defaults::default(),
        };
        model.readable()?;
        let threads = available_parallelism().map_or(1, usize::from);
        Ok(match Findings::of(&model, Workers { threads, done: &|| () }) {
            Findings::Along(survey) => Found::Along(survey),
            Findings::Map(map) => Found::Map(map),
        })
    }

    fn outcomes(&self) -> heelstrike::Result<Found> {
        let state = State::from_json(&self.text, &self.robot, &Defaults::default())?;
        let options = Options { explain_up_to: usize::MAX, ..Options::default() };
        Pipeline::new(&self.robot, options).impact(&state).map(Box::new).map(Found::State)
    }
}
