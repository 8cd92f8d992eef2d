//! Painleve's uniform rod: its lower end slides backward along the ground, which drives it into the ground.
//!
//! ```text
//!     p = 1 + (l/k)^2 cos(theta) (cos(theta) - mu sin(theta)),   b_n = l omega^2 sin(theta) - g
//! ```

use super::biped::Claim;
use heelstrike::impact::Verdict;
use heelstrike::{Defaults, Options, Pipeline, Result, Robot, State};
use serde_json::json;

/// Half length l = 1 m and squared radius of gyration k^2 = 1/3 m^2.
const ROD: &str = r#"<robot name="rod"><link name="rod"><inertial><mass value="3"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>"#;
/// (l/k)^2.
const SLENDER: f64 = 3.0;
const GRAVITY: f64 = 9.81;
/// Rate of turn \[rad/s\], such that the end lifts off from an inclination of 0.93 on.
const OMEGA: f64 = 3.5;
/// Ranges of the map: inclinations \[rad\] and friction.
const THETA: [f64; 2] = [0.3, 1.5];
const FRICTION: [f64; 2] = [0.0, 4.0];

/// The outcomes of a state of the rod.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Lifts,
    SlidesOn,
    Two,
    Nothing,
}

/// One state of the map.
#[derive(Debug, Clone, Copy)]
pub struct RodCell {
    pub theta: f64,
    pub friction: f64,
    /// `None` if nothing is proven.
    pub found: Option<Kind>,
}

/// The rod over inclination and friction.
pub struct RodMap {
    pub cells: Vec<RodCell>,
}

fn pressure(theta: f64, friction: f64) -> f64 {
    let (sin, cos) = theta.sin_cos();
    1.0 + SLENDER * cos * (cos - friction * sin)
}

fn closed_form(theta: f64, friction: f64, omega: f64) -> Kind {
    match (pressure(theta, friction) > 0.0, omega * omega * theta.sin() > GRAVITY) {
        (true, true) => Kind::Lifts,
        (true, false) => Kind::SlidesOn,
        (false, true) => Kind::Two,
        (false, false) => Kind::Nothing,
    }
}

/// The outcomes that heelstrike proves; `None` if it proves nothing.
fn computed(robot: &Robot, theta: f64, friction: f64, omega: f64) -> Result<Option<Kind>> {
    let [x, z] = [-theta.cos(), -theta.sin()];
    let state = json!({
        "position": {"base": {"z": -z}},
        "velocity": {"base": {"x": -1.0 - z * omega, "z": x * omega, "pitch": omega}},
        "contacts": [{"link": "rod", "offset": [x, 0.0, z]}],
        "friction": friction,
    });
    let state = State::from_json(&state.to_string(), robot, &Defaults::default())?;
    let analysis = Pipeline::new(robot, Options::default()).forces(&state)?.into_analysis()?;
    let lifts = analysis.outcomes.first().is_some_and(|own| own.impulse == [[0.0; 2]]);
    Ok(match analysis.verdict {
        _ if !analysis.proven => None,
        Verdict::Unique if lifts => Some(Kind::Lifts),
        Verdict::Unique => Some(Kind::SlidesOn),
        Verdict::Ambiguous => Some(Kind::Two),
        Verdict::None => Some(Kind::Nothing),
        _ => None,
    })
}

fn places([from, to]: [f64; 2], steps: usize) -> impl Iterator<Item = f64> {
    (0..steps).map(move |step| from + (to - from) * step as f64 / (steps - 1) as f64)
}

impl RodMap {
    /// Answers a grid of `thetas` inclinations and `frictions` coefficients of friction.
    pub fn new(thetas: usize, frictions: usize) -> Result<Self> {
        let robot = Robot::from_urdf(ROD)?;
        let pairs = places(THETA, thetas).flat_map(|theta| places(FRICTION, frictions).map(move |own| (theta, own)));
        let cell =
            |(theta, friction)| Ok(RodCell { theta, friction, found: computed(&robot, theta, friction, OMEGA)? });
        Ok(Self { cells: pairs.map(cell).collect::<Result<_>>()? })
    }

    pub fn claims(&self) -> Result<Vec<Claim>> {
        let agree = |cell: &&RodCell| cell.found == Some(closed_form(cell.theta, cell.friction, OMEGA));
        let agreeing = self.cells.iter().filter(agree).count();
        let has = |kind| self.cells.iter().any(|cell| cell.found == Some(kind));
        let all = [Kind::Lifts, Kind::SlidesOn, Kind::Two, Kind::Nothing].into_iter().all(has);
        let (theta, friction) = least_friction()?;
        Ok(vec![
            (
                format!("the rod: {agreeing} of {} states as by the closed form, all four regions", self.cells.len()),
                agreeing == self.cells.len() && all,
            ),
            (
                format!("the least friction with a paradox: {friction} at tan(theta) = {}", theta.tan()),
                (friction - 4.0 / 3.0).abs() < 1e-10 && (theta.tan() - 2.0).abs() < 1e-4,
            ),
        ])
    }
}

/// The inclination and friction from which on a rod that does not turn may jam: the lowest point of the map's border.
fn least_friction() -> Result<(f64, f64)> {
    let robot = Robot::from_urdf(ROD)?;
    // The friction at the border for one inclination, by bisection.
    let border = |theta: f64| -> Result<f64> {
        let [mut low, mut high] = [1.0, 4.0];
        while high - low > 1e-14 {
            let middle = 0.5 * (low + high);
            let jams = computed(&robot, theta, middle, 0.0)? == Some(Kind::Nothing);
            if jams { high = middle } else { low = middle }
        }
        Ok(0.5 * (low + high))
    };
    let [mut from, mut to] = [0.8, 1.4];
    // Within 1e-6 rad of its minimum the border rises by no more than rounding.
    while to - from > 1e-6 {
        let third = (to - from) / 3.0;
        if border(from + third)? < border(to - third)? { to -= third } else { from += third }
    }
    let theta = 0.5 * (from + to);
    Ok((theta, border(theta)?))
}

/// The curves p = 0 and b_n = 0 over inclination and friction.
pub fn borders() -> [Vec<(f64, f64)>; 2] {
    let jams = |theta: f64| (1.0 + SLENDER * theta.cos() * theta.cos()) / (SLENDER * theta.cos() * theta.sin());
    let lifts = (GRAVITY / (OMEGA * OMEGA)).asin();
    let curve = places(THETA, 241).map(|theta| (theta, jams(theta))).filter(|(_, own)| *own <= FRICTION[1]);
    [curve.collect(), FRICTION.map(|friction| (lifts, friction)).to_vec()]
}
