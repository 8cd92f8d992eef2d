//! States of one robot as text.

use crate::answer::{ALL, accepted, check_state};
use crate::choices::{Choices, field_names};
use crate::watch::watched;
use heelstrike::Robot;
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::read::documents::{documents, utf8};
use heelstrike::state::{Defaults, LinkPoint, NamedLoop, State};
use std::cell::RefCell;
use std::sync::LazyLock;

crate::target!(any_state_is_answered_or_refused, 5_000, 0.2, check);

static RAMONE: LazyLock<Robot> =
    LazyLock::new(|| Robot::from_urdf(include_str!("../../urdf/ramone.urdf")).expect("a robot"));

/// Words that mean something in a state.
static WORDS: LazyLock<String> = LazyLock::new(|| {
    field_names()
        + r" default infinite left_hip left_knee right_hip right_knee left_foot right_foot left_shank torso
    null 1e999 -0.0 1e-320 \u0000 é"
});

pub fn options() -> Options {
    Options { explain_up_to: 3, matrices: ALL.matrices, ..Options::default() }
}

thread_local! {
    static KEPT: RefCell<Pipeline<'static>> = RefCell::new(Pipeline::new(&RAMONE, options()));
}

fn check(bytes: &[u8]) -> bool {
    let mut choices = Choices::new(bytes);
    let text = choices.text(&STATES, &WORDS, |choices| state_of(&RAMONE, choices));
    let case = String::from_utf8_lossy(&text);
    watched(&case, || KEPT.with_borrow_mut(|kept| answer(&text, kept, &case)))
}

const STATES: [&str; 3] =
    [include_str!("../../examples/ramone.json"), include_str!("../../examples/ramone_paper.json"), FULL];

/// A state with every field.
const FULL: &str = r#"{"id": 17, "position": {"base": {"x": 0.1, "z": 0.44, "pitch": 0.2}, "joints": {"left_hip": 0.7, "left_knee": -1.5}},
 "velocity": {"base": {"x": 0.1, "z": -0.2, "pitch": 1.0}, "joints": {"right_hip": -0.25, "right_knee": 3e-1}},
 "friction": {"default": 0.8, "left_foot": "infinite"}, "restitution": {"default": 0.25, "right_foot": 1},
 "ground": {"slope": 0.1}, "held": ["left_hip"], "rotor_inertia": {"left_knee": 0.01},
 "contacts": [{"link": "left_foot", "offset": [0, 0, -0.1], "radius": 0.02}, {"link": "right_foot"}],
 "impulse": [{"link": "torso", "offset": [0, 0, 0.1], "vector": [1, -2]}]}"#;

fn answer(bytes: &[u8], kept: &mut Pipeline, case: &str) -> bool {
    let Some(text) = accepted(utf8(bytes), case) else { return false };
    let read = |text: &str| State::from_json(text, &RAMONE, &Defaults::default());
    let mut answered = false;
    for document in documents(text) {
        let state = read(document.text).map_err(|error| document.locate(error));
        let Some(state) = accepted(state, case) else { continue };
        let written = state.to_json(&RAMONE).unwrap_or_else(|error| panic!("not written: {error}\n{case}"));
        // A state that is written does not depend on whether others are placed or have loops.
        let end = LinkPoint { link: 0, offset: [0.0; 3] };
        let others = Defaults { place_lowest: true, loops: vec![NamedLoop { a: end, b: end }], ..Defaults::default() };
        let again = State::from_json(&written, &RAMONE, &others);
        assert_eq!(again.ok().as_ref(), Some(&state), "written, it reads as another state\n{case}");
        answered |= check_state(&state, &RAMONE, kept, &options(), case);
    }
    answered
}

/// The text of a state of `robot`, mostly a good one.
pub fn state_of(robot: &Robot, choices: &mut Choices) -> String {
    let links: Vec<&str> = robot.links().iter().map(|link| link.name.as_str()).collect();
    let joints: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    let shaped = robot.links().iter().filter(|link| !link.shapes.is_empty()).map(|link| link.name.as_str()).collect();
    Writer { choices, links, shaped, joints }.state()
}

struct Writer<'c, 'a, 'b> {
    choices: &'c mut Choices<'b>,
    links: Vec<&'a str>,
    /// Those that have shapes.
    shaped: Vec<&'a str>,
    joints: Vec<&'a str>,
}

impl Writer<'_, '_, '_> {
    fn state(&mut self) -> String {
        let stance = self.choices.once_in(2);
        let mut fields = vec![format!("\"friction\": {}", self.by_link(Self::friction))];
        for name in ["position", "velocity"] {
            let base = if stance { &["pitch"][..] } else { &["x", "z", "pitch"] };
            let base = self.some(base);
            let joints = self.some(&self.joints.clone());
            fields.push(format!("\"{name}\": {{\"base\": {base}, \"joints\": {joints}}}"));
        }
        if stance {
            let mostly = !self.shaped.is_empty() && !self.choices.once_in(8);
            let link = if mostly { quoted(self.choices.pick(&self.shaped)) } else { self.link() };
            fields.push(format!("\"stance\": {link}"));
        }
        if self.choices.once_in(3) {
            fields.push(format!("\"restitution\": {}", self.by_link(Self::restitution)));
        }
        if self.choices.once_in(4) {
            fields.push(format!("\"ground\": {}", self.ground()));
        }
        if self.choices.once_in(4) && !self.joints.is_empty() {
            fields.push(format!("\"held\": [{}]", quoted(self.choices.pick(&self.joints))));
        }
        if self.choices.once_in(4) {
            fields.push(format!("\"rotor_inertia\": {}", self.some(&self.joints.clone()).replace('-', "")));
        }
        if !self.choices.once_in(3) {
            let most = self.choices.pick(&[2, 2, 3, 3, 4]);
            let contacts: Vec<String> = (0..=self.choices.below(most)).map(|_| self.contact("radius")).collect();
            fields.push(format!("\"contacts\": [{}]", contacts.join(", ")));
        }
        if self.choices.once_in(6) {
            fields.push(format!("\"impulse\": [{}]", self.contact("vector")));
        }
        if self.choices.once_in(8) {
            // A point is always at itself; other points meet where the legs lie on each other.
            let a = self.link();
            let b = if self.choices.once_in(2) { a.clone() } else { self.link() };
            fields.push(format!("\"loops\": [{{\"a\": {{\"link\": {a}}}, \"b\": {{\"link\": {b}}}}}]"));
        }
        if self.choices.once_in(16) {
            let field = self.choices.pick(&WORDS.split_whitespace().collect::<Vec<_>>());
            let value = self.choices.pick(&["null", "[]", "{}", "true", "\"\"", "[[[]]]", "{\"a\": {}}", "1e999"]);
            fields.push(format!("{}: {value}", quoted(field)));
        }
        format!("{{{}}}", fields.join(", "))
    }

    fn number(&mut self) -> String {
        match self.choices.below(32) {
            0..16 => format!("{:?}", self.choices.real()),
            31 => self.choices.pick(&["1e999", "-0", "1e-400", "0.1e1", "123456789012345678901234567890"]).to_owned(),
            _ => {
                let number = self.choices.number();
                format!("{:?}", if number.is_finite() { number } else { 0.0 })
            }
        }
    }

    fn some(&mut self, names: &[&str]) -> String {
        let mut entries = Vec::new();
        for name in names {
            if !self.choices.once_in(4) {
                entries.push(format!("{}: {}", quoted(name), self.number()));
            }
        }
        format!("{{{}}}", entries.join(", "))
    }

    fn link(&mut self) -> String {
        quoted(self.choices.pick(&self.links))
    }

    fn friction(&mut self) -> String {
        match self.choices.below(4) {
            0 => "\"infinite\"".into(),
            1 => "0".into(),
            2 => format!("{:?}", self.choices.real().abs()),
            _ if self.choices.once_in(8) => self.number(),
            _ => self.number().trim_start_matches('-').to_owned(),
        }
    }

    /// A slope, or steps about the world's origin, now and then in the wrong order.
    fn ground(&mut self) -> String {
        if !self.choices.once_in(3) {
            return format!("{{\"slope\": {}}}", self.number());
        }
        let (mut x, mut points) = (-3.0, Vec::new());
        for _ in 0..2 + self.choices.below(6) {
            points.push(format!("[{x:?}, {}]", if self.choices.once_in(2) { "0".to_owned() } else { self.number() }));
            x += self.choices.pick(&[1.0, 1.0, 1e-6, 0.3, 4.0, 1e-300, -1.0]);
        }
        format!("{{\"profile\": [{}]}}", points.join(", "))
    }

    fn restitution(&mut self) -> String {
        let own = format!("{:?}", self.choices.real().abs());
        self.choices.pick(&["0", "1", "0.5", &own, "1e-300"]).to_owned()
    }

    fn by_link(&mut self, value: fn(&mut Self) -> String) -> String {
        let all = value(self);
        if !self.choices.once_in(3) {
            return all;
        }
        format!("{{\"default\": {all}, {}: {}}}", self.link(), value(self))
    }

    fn contact(&mut self, last: &str) -> String {
        let (link, offset) = (self.link(), [self.number(), self.number(), self.number()]);
        let zero = self.choices.once_in(2);
        let offset = if zero { "[0, 0, 0]".into() } else { format!("[{}]", offset.join(", ")) };
        let value = if last == "vector" { format!("[{}, {}]", self.number(), self.number()) } else { "0.25".into() };
        format!("{{\"link\": {link}, \"offset\": {offset}, \"{last}\": {value}}}")
    }
}

fn quoted(name: &str) -> String {
    serde_json::Value::from(name).to_string()
}
