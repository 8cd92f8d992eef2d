//! Robots for studies.

use heelstrike::Robot;
use heelstrike::description::Description;
use heelstrike::pipeline::Options;
use heelstrike::robot::Reduction;
use heelstrike::state::Defaults;
use heelstrike::sweep::{RobotStudy, Study};

/// A robot with the description from which a study varies it.
pub struct Subject {
    pub name: &'static str,
    pub description: Description,
    pub reduction: Reduction,
    pub robot: Robot,
}

impl Subject {
    pub fn new(name: &'static str, urdf: &str) -> Self {
        let description = Description::from_urdf(urdf).expect("a robot's description");
        let reduction = Reduction::default();
        let robot = Robot::reduce(&description, &reduction).expect("a robot");
        Self { name, description, reduction, robot }
    }

    /// The study of this robot.
    pub fn model<'a>(&'a self, study: &'a Study<'a>) -> RobotStudy<'a> {
        RobotStudy {
            study,
            description: &self.description,
            reduction: &self.reduction,
            robot: &self.robot,
            options: Options::default(),
            defaults: Defaults::default(),
        }
    }
}
