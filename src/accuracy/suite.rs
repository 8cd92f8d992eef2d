//! Named stiff and extreme cases: masses, lengths, poses, friction and speeds near the limits of f64.
//!
//! Every case must be answered with its condition, or refused with a reason; none may give NaN, panic or be dropped.

use super::robots;
use crate::Result;
use crate::impact::ContactProblem;
use crate::law::Friction;
use crate::planar::Vector;
use crate::robot::Robot;
use crate::state::{ByLink, NamedContact, Scene, State};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_6, PI};

/// A case of the suite.
#[derive(Debug, Clone)]
pub struct Case {
    /// The name, as in `chain of 100 links, folded`.
    pub name: String,
    /// What is analyzed.
    pub subject: CaseSubject,
    /// How the analysis must end.
    pub end: Expected,
}

/// What a case analyzes.
#[derive(Debug, Clone)]
pub enum CaseSubject {
    /// A robot's state.
    State(Box<(Robot, State)>),
    /// A contact problem given as matrices, without a robot.
    Problem(ContactProblem),
}

/// How the analysis of a case must end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expected {
    /// With every outcome and the condition.
    Answered,
    /// With a refusal, because the mass matrix is singular to the rounding of f64.
    Singular,
}

/// RAMone's hip angle that puts its foot straight below the hip while its knee is bent by a right angle \[rad\].
const RAMONE_HIP: f64 = 0.8729729102424726;

/// Returns all cases of the suite.
///
/// # Errors
/// Returns an error only if one of this crate's own robots is invalid.
pub fn cases() -> Result<Vec<Case>> {
    let mut suite = Suite::default();
    suite.masses()?;
    suite.chains();
    suite.sizes()?;
    suite.poses()?;
    suite.frictions()?;
    suite.speeds()?;
    suite.borders()?;
    suite.ill_conditioned()?;
    Ok(suite.0)
}

#[derive(Default)]
struct Suite(Vec<Case>);

impl Suite {
    fn state(&mut self, name: impl Into<String>, robot: Robot, state: impl FnOnce(&Robot) -> State) {
        self.ending(Expected::Answered, name, robot, state);
    }

    fn ending(&mut self, end: Expected, name: impl Into<String>, robot: Robot, state: impl FnOnce(&Robot) -> State) {
        let state = state(&robot);
        self.0.push(Case { name: name.into(), subject: CaseSubject::State(Box::new((robot, state))), end });
    }

    fn problem(&mut self, name: impl Into<String>, problem: ContactProblem) {
        self.0.push(Case { name: name.into(), subject: CaseSubject::Problem(problem), end: Expected::Answered });
    }

    fn masses(&mut self) -> Result<()> {
        for part in ["shank", "thigh", "torso"] {
            for factor in [1e-12, 1e-6, 1e6, 1e12] {
                let robot = robots::with_bodies(robots::ramone()?, |body| {
                    if body.name.contains(part) {
                        body.mass *= factor;
                        body.moment *= factor;
                    }
                });
                self.state(format!("{part} mass times {factor:e}"), robot, |robot| ramone(robot, 0.5));
            }
        }
        for (name, factor) in [("needle", 1e-12), ("point", 0.0)] {
            let robot = robots::with_bodies(robots::ramone()?, |body| body.moment *= factor);
            self.state(format!("{name} inertias"), robot, |robot| ramone(robot, 0.5));
        }
        // A leg whose point mass lies 1 nm from its hinge has almost no moment of inertia.
        for (name, com, end) in [("1 nm off", -1e-9, Expected::Answered), ("at", 0.0, Expected::Singular)] {
            let mut robot = robots::minimalistic()?;
            robot.bodies[1].com = Vector::new(0.0, com);
            self.ending(end, format!("a leg's point mass {name} its hinge"), robot, |robot| walker(robot, 1.4));
        }
        let robot = robots::with_massless_feet()?;
        let with = |scene| move |robot: &Robot| State { scene, ..with_feet(robot) };
        self.state("massless feet, held", robot.clone(), with(Scene { braked: vec![1, 2], ..standing(&robot, 2) }));
        let rotors = Scene { rotor_inertia: vec![0.0, 1e-6, 1e-6], ..standing(&robot, 2) };
        self.state("massless feet with rotors", robot.clone(), with(rotors));
        self.ending(Expected::Singular, "massless feet, loose", robot, with_feet);
        Ok(())
    }

    fn chains(&mut self) {
        for links in [10, 100, 1000] {
            for (pose, bend) in [("folded", 2.5), ("curved", 0.1), ("straight", 0.0)] {
                self.state(format!("chain of {links} links, {pose}"), robots::chain(links), |robot| {
                    let mut state = blank(robot);
                    for (index, angle) in state.position[3..].iter_mut().enumerate() {
                        *angle = if index % 2 == 0 || pose == "curved" { bend } else { -bend };
                    }
                    state.position[2] = 0.3;
                    state.velocity[..3].copy_from_slice(&[0.5, -1.0, 0.1]);
                    let ends = [(0, [0.0; 3]), (1, [0.0, 0.0, -1.0])];
                    let contact = |(link, offset)| NamedContact { link, offset, radius: 0.0 };
                    state.scene.contacts = Some(ends.map(contact).to_vec());
                    state
                });
            }
        }
    }

    fn sizes(&mut self) -> Result<()> {
        let ramone_mass = robots::ramone()?.mass();
        for (weight, kilograms) in [("a milligram", 1e-6), ("RAMone's weight", ramone_mass), ("a kiloton", 1e6)] {
            for (length, meters) in [("millimeters", 1e-3), ("meters", 1.0), ("kilometers", 1e3)] {
                let robot = robots::resized(robots::ramone()?, kilograms / ramone_mass, meters);
                self.state(format!("{weight}, {length}"), robot, |robot| ramone(robot, 0.5));
            }
        }
        Ok(())
    }

    fn poses(&mut self) -> Result<()> {
        for (name, joints) in [
            ("straight legs", [0.4, 0.0, -0.4, 0.0]),
            ("legs bent by 1e-8", [0.4, -1e-8, -0.4, -1e-8]),
            ("straight legs, coincident feet", [0.0; 4]),
            ("coincident feet", [0.4, -0.8, 0.4, -0.8]),
            ("feet 1e-8 apart", [0.4, -0.8, 0.4 + 1e-8, -0.8 - 2e-8]),
        ] {
            self.state(name, robots::ramone()?, |robot| {
                let mut state = ramone(robot, 0.0);
                state.position[3..].copy_from_slice(&joints);
                state.velocity[3..].copy_from_slice(&[0.1, 0.2, -0.3, 0.4]);
                state
            });
        }
        for (name, alpha) in [("a split", FRAC_PI_2), ("1e-9 before a split", FRAC_PI_2 - 1e-9)] {
            self.state(name, robots::walker(0.04)?, |robot| walker(robot, alpha));
            // With the legs in a split, point masses do not resist a rise of the hip. At 1e-9 rad before the split,
            // 1e-18 of the mass resists it, which is exactly zero in f64: M has a condition of 1e18, and an f64 answer
            // would have no digit.
            let name = format!("{name}, point masses");
            self.ending(Expected::Singular, name, robots::minimalistic()?, |robot| walker(robot, alpha));
        }
        // At this moment of inertia and angle all outcomes have a common border.
        for (name, angle) in [("degenerate walker", FRAC_PI_4), ("one ulp beside it", FRAC_PI_4.next_up())] {
            self.state(name, robots::walker(0.24)?, |robot| walker(robot, angle));
        }
        Ok(())
    }

    fn frictions(&mut self) -> Result<()> {
        let finite = [0.0, 1e-12, 1e5, 1e12].map(Friction::Finite);
        for friction in finite.into_iter().chain([Friction::Infinite]) {
            let name = match friction {
                Friction::Finite(mu) => format!("{mu:e}"),
                Friction::Infinite => "infinite".to_owned(),
            };
            let on = |mut state: State| {
                state.scene.friction = ByLink::everywhere(friction);
                state
            };
            self.state(format!("friction {name}, biped"), robots::minimalistic()?, |robot| on(walker(robot, 1.4)));
            self.state(format!("friction {name}, RAMone"), robots::ramone()?, |robot| on(ramone(robot, 0.5)));
        }
        Ok(())
    }

    fn speeds(&mut self) -> Result<()> {
        for (name, speed) in
            [("grazing contact", 0.0), ("approach at 1e-300 m/s", -1e-300), ("leaving at 1e-300 m/s", 1e-300)]
        {
            self.state(name, robots::block()?, |robot| {
                let mut state = blank(robot);
                state.velocity[..2].copy_from_slice(&[1.0, speed]);
                state.scene.friction = ByLink::everywhere(Friction::Finite(0.5));
                state
            });
        }
        for speed in [1e-100, 1e100] {
            self.state(format!("speeds times {speed:e}"), robots::ramone()?, |robot| {
                let mut state = ramone(robot, 0.5);
                state.velocity[2] *= speed;
                state
            });
        }
        Ok(())
    }

    fn borders(&mut self) -> Result<()> {
        // Borders between lift-off and sliding, sliding and stopping, one and three outcomes (paper, section 5).
        for (name, border) in [("lift-off", PI / 12.0), ("stop", FRAC_PI_6), ("three outcomes", 5.0 * PI / 12.0)] {
            for (side, angle) in [("before", border.next_down()), ("at", border), ("beyond", border.next_up())] {
                let name = format!("the f64 {side} the border to {name}");
                self.state(name, robots::minimalistic()?, |robot| walker(robot, angle));
            }
        }
        // G = 1 and c = (-1/2, -1): sticking needs a friction of exactly 1/2.
        for (side, mu) in [("below", 0.5f64.next_down()), ("at", 0.5), ("above", 0.5f64.next_up())] {
            let unit = vec![1.0, 0.0, 0.0, 1.0];
            let problem = ContactProblem::new(unit, vec![[-0.5, -1.0]], vec![Friction::Finite(mu)], vec![0.0])?;
            self.problem(format!("friction one ulp {side} the cone's edge").replace("one ulp at", "at"), problem);
        }
        Ok(())
    }

    fn ill_conditioned(&mut self) -> Result<()> {
        let near_one = 1.0 - f64::EPSILON / 2.0;
        self.problem("G of one contact, condition 2e16", given(vec![1.0, near_one, near_one, 1.0])?);
        self.problem("G of two contacts, condition 1e16", given(reflected([1.0, 1e-5, 1e-11, 1e-16]))?);
        self.problem("Hilbert G of two contacts", given(hilbert(4))?);
        self.problem("Hilbert G of six contacts, condition 1e16", given(hilbert(12))?);
        Ok(())
    }
}

/// A state at rest with all coordinates zero and infinite friction.
fn blank(robot: &Robot) -> State {
    let scene = Scene { friction: ByLink::everywhere(Friction::Infinite), ..Scene::default() };
    State { scene, ..State::zero(robot) }
}

/// The scene of a robot whose stance is `link`.
fn standing(robot: &Robot, link: usize) -> Scene {
    Scene { stance: Some(link), ..blank(robot).scene }
}

/// A two-legged walker at the paper's leg angle `alpha`, turning about its left foot at 1 rad/s.
fn walker(robot: &Robot, alpha: f64) -> State {
    let mut state = State { scene: standing(robot, 0), ..State::zero(robot) };
    state.position[2..4].copy_from_slice(&[-alpha, -2.0 * alpha]);
    state.velocity[2] = -1.0;
    state
}

/// The walker at alpha = 1.4 with a foot at the end of each leg.
fn with_feet(robot: &Robot) -> State {
    let mut state = walker(robot, 1.4);
    state.scene = standing(robot, 2);
    state.position[4..6].copy_from_slice(&[-1.4, 1.4]);
    state
}

/// RAMone at the paper's leg angle `alpha`, its knees bent by a right angle, turning about its left foot at 1 rad/s.
fn ramone(robot: &Robot, alpha: f64) -> State {
    let foot = robot.link("left_foot").unwrap_or_default();
    let mut state = State { scene: standing(robot, foot), ..State::zero(robot) };
    state.position[3..].copy_from_slice(&[RAMONE_HIP + alpha, -FRAC_PI_2, RAMONE_HIP - alpha, -FRAC_PI_2]);
    state.velocity[2] = -1.0;
    state
}

/// A problem with the given G, in which all contacts strike.
fn given(delassus: Vec<f64>) -> Result<ContactProblem> {
    let contacts = delassus.len().isqrt() / 2;
    let before = (0..contacts).map(|contact| [0.25 * contact as f64, -1.0]).collect();
    ContactProblem::new(delassus, before, vec![Friction::Finite(0.5); contacts], vec![0.0; contacts])
}

/// The matrix with eigenvalues `values` and the eigenvectors of the reflection I - 1/2 (1, 1, 1, 1)(1, 1, 1, 1)^T.
fn reflected(values: [f64; 4]) -> Vec<f64> {
    let vector = |k: usize, i: usize| if k == i { 0.5 } else { -0.5 };
    let entry = |i: usize, j: usize| (0..4).map(|k| vector(k, i) * vector(k, j) * values[k]).sum();
    (0..16).map(|at| entry(at / 4, at % 4)).collect()
}

fn hilbert(rows: usize) -> Vec<f64> {
    (0..rows * rows).map(|at| 1.0 / (1 + at / rows + at % rows) as f64).collect()
}
