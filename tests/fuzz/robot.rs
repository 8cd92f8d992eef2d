//! Robots as text, and a state of each that is read.

use crate::answer::{accepted, check_json, check_state};
use crate::choices::Choices;
use crate::state::{options, state_of};
use crate::watch::watched;
use heelstrike::Robot;
use heelstrike::pipeline::Pipeline;
use heelstrike::read::documents::utf8;
use heelstrike::state::{Defaults, State};
use heelstrike::write::{Inspection, Palette, append_line};

crate::target!(any_urdf_is_answered_or_refused, 2_000, 0.1, check);

/// Words that mean something in a URDF.
const WORDS: &str = "
    robot link joint inertial origin mass inertia collision visual geometry sphere box cylinder capsule mesh axis
    parent child limit mimic name type value xyz rpy ixx iyy izz ixy ixz iyz radius size length fixed revolute
    continuous prismatic planar floating 0 -1 NaN inf 1e999 1e-320 1e308 1.5707963267948966 left_foot torso &amp;
    &#0; <!-- xmlns";

const ROBOTS: [&str; 5] = [
    include_str!("../../urdf/block.urdf"),
    include_str!("../../urdf/minimalistic.urdf"),
    include_str!("../../urdf/pdw.urdf"),
    include_str!("../../urdf/ramone.urdf"),
    include_str!("../data/robots/rabbit/five_link_walker.urdf"),
];

fn check(bytes: &[u8]) -> bool {
    let mut choices = Choices::new(bytes);
    let text = choices.text(&ROBOTS, WORDS, robot_text);
    let case = String::from_utf8_lossy(&text).into_owned();
    let state = choices.rest();
    watched(&case, || answer(&text, state, &case))
}

fn answer(bytes: &[u8], state: &[u8], case: &str) -> bool {
    let Some(robot) = accepted(utf8(bytes).and_then(Robot::from_urdf), case) else { return false };
    let inspection = Inspection::new(&robot, &[]);
    let mut line = Vec::new();
    append_line(&mut line, &inspection);
    check_json(&line, case);
    assert!(!inspection.text(&Palette::default(), false).is_empty(), "{case}");

    let state = state_of(&robot, &mut Choices::new(state));
    let case = format!("{state}\n{case}");
    watched(&case, || {
        let state = accepted(State::from_json(&state, &robot, &Defaults::default()), &case);
        let check = |state| check_state(&state, &robot, &mut Pipeline::new(&robot, options()), &options(), &case);
        state.is_some_and(check)
    })
}

/// A tree of a few links, mostly a good one.
fn robot_text(choices: &mut Choices) -> String {
    let mut text = String::from("<robot name=\"r\">\n");
    for link in 0..=choices.below(6) {
        let inertial = if choices.once_in(4) {
            String::new()
        } else {
            let (mass, moment) = (positive(choices), positive(choices));
            let origin = pose(choices);
            format!(
                "<inertial>{origin}<mass value=\"{mass:?}\"/><inertia ixx=\"1\" iyy=\"{moment:?}\" izz=\"1\"/></inertial>"
            )
        };
        text += &format!("<link name=\"l{link}\">{inertial}");
        // Few feet: with many at once the combinations take their time.
        for _ in 0..choices.below(if link < 3 { 3 } else { 1 }) {
            let [a, b, c] = [positive(choices), positive(choices), positive(choices)];
            let shape = match choices.below(6) {
                0..3 => format!("<sphere radius=\"{a:?}\"/>"),
                3 => format!("<box size=\"{a:?} {b:?} {c:?}\"/>"),
                4 => format!("<cylinder radius=\"{a:?}\" length=\"{b:?}\"/>"),
                _ => format!("<capsule radius=\"{a:?}\" length=\"{b:?}\"/>"),
            };
            text += &format!("<collision>{}<geometry>{shape}</geometry></collision>", pose(choices));
        }
        text += "</link>\n";
        if link > 0 {
            let kind = if choices.once_in(16) {
                choices.pick(&["planar", "floating", "spherical"])
            } else {
                choices.pick(&["continuous", "continuous", "revolute", "prismatic", "fixed"])
            };
            let parent = choices.below(link);
            // Of prismatic joints: forward or up; of others: along the normal.
            let axes = if kind == "prismatic" { ["1 0 0", "0 0 -1", "3 0 4"] } else { ["0 1 0", "0 -2 0", "0 1 1e-9"] };
            let axis =
                if choices.once_in(16) { choices.pick(&["1 2 3", "1 0 0", "0 1 0.08"]) } else { choices.pick(&axes) };
            let mimicked = choices.below(link + 1);
            let mimic = format!("<mimic joint=\"j{mimicked}\" offset=\"0.1\"/>");
            let mimic = if choices.once_in(16) { &mimic } else { "" };
            text += &format!(
                "<joint name=\"j{link}\" type=\"{kind}\">{}<parent link=\"l{parent}\"/><child link=\"l{link}\"/>\
                 <axis xyz=\"{axis}\"/>{mimic}</joint>\n",
                pose(choices)
            );
        }
    }
    text + "</robot>"
}

fn positive(choices: &mut Choices) -> f64 {
    match choices.below(8) {
        0 => 0.0,
        1 => choices.number().abs(),
        2 => 1.0,
        _ => choices.real().abs(),
    }
}

fn pose(choices: &mut Choices) -> String {
    if choices.once_in(2) {
        return String::new();
    }
    // A part that lies far away makes the robot large and its contact tolerance coarse: then all feet touch.
    let number = |choices: &mut Choices| if choices.once_in(200) { choices.number() } else { choices.real() };
    let [x, y, z] = [number(choices), number(choices), number(choices)];
    let any = choices.once_in(16);
    let rpy = choices.pick(if any {
        &["1.5707963267948966 0 0", "0.1 0.2 0.3", "1e300 0 0"]
    } else {
        &["0 0 0", "0 0.5 0", "0 -3 0"]
    });
    format!("<origin xyz=\"{x:?} {y:?} {z:?}\" rpy=\"{rpy}\"/>")
}
