//! Reads studies: parameters, and a state and a robot whose numbers are expressions of them.

use super::format::fields_of;
use super::state as read;
use super::variation;
use crate::description::Description;
use crate::read::expression::{Names, is_name, names_in};
use crate::read::json::{Node, Value};
use crate::state::{Defaults, State};
use crate::{Error, Reason, Result, Robot};
use std::borrow::Cow;

/// The most samples of all parameters together.
const SAMPLE_LIMIT: usize = 10_000_000;

/// The most constants; a study has some ten.
const CONSTANT_LIMIT: usize = 256;

/// A study of one or two parameters.
///
/// ```
/// # fn main() -> heelstrike::Result<()> {
/// let text = r#"{"parameters": {"alpha": {"from": 0.1, "to": 1.5, "steps": 15}},
///                "state": {"position": {"base": {"pitch": "-alpha"}, "joints": {"hip": "-2*alpha"}},
///                          "velocity": {"base": {"pitch": -1}}, "stance": "left_leg", "friction": "infinite"}}"#;
/// let study = heelstrike::Study::from_json(text)?;
/// assert_eq!(study.parameters()[0].name, "alpha");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Study<'t> {
    text: &'t str,
    tree: Value<'t>,
    parameters: Vec<Parameter>,
    constants: Names,
}

/// A parameter of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name in expressions.
    pub name: String,
    /// Its least value.
    pub from: f64,
    /// Its greatest value.
    pub to: f64,
    /// How many samples are taken, both ends included; at least 2.
    pub steps: usize,
}

impl Parameter {
    /// The value of a sample, from 0 to `steps` - 1.
    pub fn sample(&self, index: usize) -> f64 {
        match index + 1 == self.steps {
            true => self.to,
            false => self.from + (self.to - self.from) * (index as f64 / (self.steps - 1) as f64),
        }
    }

    /// The length of its range.
    pub fn range(&self) -> f64 {
        self.to - self.from
    }
}

impl<'t> Study<'t> {
    /// Reads a study from one JSON object. Its state and robot are read, and refused, at each point.
    ///
    /// # Errors
    /// Broken JSON, unknown or duplicate fields, no parameter or more than two, a range that is empty, fewer than two
    /// samples or more than ten million, names that expressions cannot use. The error gives place, line and column in
    /// `text`.
    pub fn from_json(text: &'t str) -> Result<Self> {
        let tree = Value::parse(text)?;
        let root = Node::root(&tree, text);
        let mut constants = Names::default();
        for field in root.fields("field")? {
            match field.key() {
                "constants" => read_constants(&tree, text, &mut constants)?,
                "parameters" | "state" | "robot" => {}
                _ => return Err(field.unknown_field(&fields_of("Study"))),
            }
        }
        let with_constants = Node::root_with(&tree, text, &constants);
        let field = with_constants.fields("field")?.find(|field| field.key() == "parameters");
        let field = field.ok_or_else(|| {
            missing(root, "parameters", "as in \"parameters\": {\"alpha\": {\"from\": 0, \"to\": 1, \"steps\": 50}}")
        })?;
        let parameters =
            field.fields("parameter")?.map(|entry| parameter(entry, &constants)).collect::<Result<Vec<_>>>()?;
        if !(1..=2).contains(&parameters.len()) {
            let reason = format!("a study varies one or two parameters, not {}", parameters.len());
            return Err(field.refuse(Reason::Inconsistent(reason)).hint("make the others constants"));
        }
        let samples = parameters.iter().try_fold(1_usize, |all, parameter| all.checked_mul(parameter.steps));
        if samples.is_none_or(|samples| samples > SAMPLE_LIMIT) {
            return Err(field.refuse(Reason::TooMany { what: "samples", limit: SAMPLE_LIMIT }));
        }
        if !root.fields("field")?.any(|field| field.key() == "state") {
            return Err(missing(root, "state", "as in `impact`, with expressions where numbers stand"));
        }
        Ok(Self { text, parameters, constants, tree: tree.clone() })
    }

    /// One or two parameters.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Parameters that no expression of the state or the robot uses.
    pub fn unused(&self) -> Vec<&str> {
        let mut texts = Vec::new();
        if let Value::Object(fields) = &self.tree {
            let read = fields.iter().filter(|(key, _)| matches!(key.as_ref(), "state" | "robot"));
            read.for_each(|(_, value)| texts_in(value, &mut texts));
        }
        let names = self.parameters.iter().map(|parameter| parameter.name.as_str());
        names.filter(|name| !texts.iter().any(|text| names_in(text).any(|used| used == *name))).collect()
    }

    /// Whether the robot itself is varied.
    pub fn varies_the_robot(&self) -> bool {
        let root = Node::root(&self.tree, self.text);
        root.fields("field").is_ok_and(|mut fields| fields.any(|field| field.key() == "robot"))
    }

    /// The values of parameters and constants at a point.
    pub(crate) fn names(&self, point: &[f64]) -> Names {
        let mut names = self.constants.clone();
        for (parameter, &value) in self.parameters.iter().zip(point) {
            names.set(&parameter.name, value);
        }
        names
    }

    /// The state at a point.
    ///
    /// # Errors
    /// As [`State::from_json`], and expressions without a value.
    pub(crate) fn state(&self, names: &Names, robot: &Robot, defaults: &Defaults) -> Result<State> {
        let root = Node::root_with(&self.tree, self.text, names);
        let field = root.fields("field")?.find(|field| field.key() == "state");
        let field = field.ok_or_else(|| missing(root, "state", "as in `impact`"))?;
        read::read(field, robot, defaults)
    }

    /// The robot's description at a point.
    ///
    /// # Errors
    /// Unknown links, joints and fields, numbers that no body can have, and expressions without a value.
    pub(crate) fn describe<'d>(&self, names: &Names, description: &'d Description) -> Result<Cow<'d, Description>> {
        let root = Node::root_with(&self.tree, self.text, names);
        match root.fields("field")?.find(|field| field.key() == "robot") {
            Some(field) => variation::applied(field, description).map(Cow::Owned),
            None => Ok(Cow::Borrowed(description)),
        }
    }
}

/// Each constant may be an expression of the others, in any order, because many JSON writers sort names.
fn read_constants(tree: &Value, text: &str, constants: &mut Names) -> Result<()> {
    let plain = Node::root(tree, text);
    let Some(field) = plain.fields("field")?.find(|field| field.key() == "constants") else { return Ok(()) };
    let mut open: Vec<String> = field.fields("constant")?.map(name).collect::<Result<_>>()?;
    if open.len() > CONSTANT_LIMIT {
        return Err(field.refuse(Reason::TooMany { what: "constants", limit: CONSTANT_LIMIT }));
    }
    while !open.is_empty() {
        let known = constants.clone();
        let root = Node::root_with(tree, text, &known);
        let Some(field) = root.fields("field")?.find(|field| field.key() == "constants") else { break };
        let needs = |entry: &Node, names: &[String]| {
            entry.as_text().is_some_and(|text| names_in(text).any(|used| names.iter().any(|name| name == used)))
        };
        let mut later = Vec::new();
        for entry in field.fields("constant")?.filter(|entry| open.iter().any(|name| name == entry.key())) {
            match needs(&entry, &open) {
                true => later.push(entry.key().to_owned()),
                false => {
                    constants.set(entry.key(), entry.number().map_err(|error| beside_parameters(plain, entry, error))?)
                }
            }
        }
        if later.len() == open.len() {
            let reason = format!("each of these constants needs another one, or itself: {}", later.join(", "));
            return Err(field.refuse(Reason::Inconsistent(reason)).hint("give one of them a number"));
        }
        open = later;
    }
    Ok(())
}

/// The refusal of a constant, with a hint if it uses a parameter.
fn beside_parameters(root: Node, entry: Node, error: Error) -> Error {
    let parameters = root.fields("field").ok().and_then(|mut fields| fields.find(|field| field.key() == "parameters"));
    let Some(field) = parameters else { return error };
    let Ok(mut parameters) = field.fields("parameter") else { return error };
    let text = entry.as_text().unwrap_or_default();
    match parameters.find(|parameter| names_in(text).any(|used| used == parameter.key())) {
        Some(parameter) => error
            .hint(format!("{} is a parameter, and constants do not vary: write it into the state", parameter.key())),
        None => error,
    }
}

/// `{"from", "to", "steps"}`.
fn parameter(entry: Node, constants: &Names) -> Result<Parameter> {
    let name = name(entry)?;
    if constants.iter().any(|constant| constant == name) {
        return Err(entry
            .refuse_name(entry.key(), Reason::Duplicate { what: "name", name })
            .hint("it is a constant already"));
    }
    let (mut from, mut to, mut steps) = (None, None, None);
    for part in entry.fields("field")? {
        match part.key() {
            "from" => from = Some(part.number()?),
            "to" => to = Some(part.number()?),
            "steps" => steps = Some(samples(part)?),
            _ => return Err(part.unknown_field(&fields_of("Parameter"))),
        }
    }
    let example = "a parameter is {\"from\": 0, \"to\": 1, \"steps\": 50}";
    let from = from.ok_or_else(|| missing(entry, "from", example))?;
    let to = to.ok_or_else(|| missing(entry, "to", example))?;
    let steps = steps.ok_or_else(|| missing(entry, "steps", example))?;
    if from >= to || !(to - from).is_finite() {
        let reason = Reason::Inconsistent(format!("the range from {from:?} to {to:?} is empty or endless"));
        return Err(entry.refuse(reason).hint("\"from\" has to be less than \"to\""));
    }
    let parameter = Parameter { name, from, to, steps };
    if parameter.sample(1) <= from || parameter.sample(steps - 2) >= to {
        let reason = format!("the range from {from:?} to {to:?} has no room for {steps} different samples");
        return Err(entry.refuse(Reason::Inconsistent(reason)).hint("take fewer of them, or a wider range"));
    }
    Ok(parameter)
}

fn samples(part: Node) -> Result<usize> {
    let value = part.number()?;
    if value.fract() == 0.0 && (2.0..=SAMPLE_LIMIT as f64).contains(&value) {
        return Ok(value as usize);
    }
    let what = "the number of samples".into();
    Err(part.refuse(Reason::OutOfRange { what, allowed: "a whole number from 2 to 10000000", value }))
}

fn name(entry: Node) -> Result<String> {
    let name = entry.key();
    if is_name(name) {
        return Ok(name.to_owned());
    }
    let reason = format!("\"{name}\" is no name that an expression can use");
    Err(entry.refuse_name(name, Reason::Inconsistent(reason)).hint("take letters, digits and _, no digit first"))
}

/// All strings in a value that are no keys.
fn texts_in<'v>(value: &'v Value, texts: &mut Vec<&'v str>) {
    match value {
        Value::Text(text) => texts.push(text),
        Value::List(entries) => entries.iter().for_each(|entry| texts_in(entry, texts)),
        Value::Object(fields) => fields.iter().for_each(|(_, value)| texts_in(value, texts)),
        Value::Null | Value::Bool | Value::Number(_) => {}
    }
}

fn missing(node: Node, what: &str, hint: &str) -> Error {
    node.refuse(Reason::Missing(format!("\"{what}\""))).hint(hint)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_that_nothing_names_is_told() {
        let text = r#"{"parameters": {"a": {"from": 0, "to": 1, "steps": 2}, "b": {"from": 0, "to": 1, "steps": 2}},
            "state": {"position": {"base": {"z": "sin(2*a)"}}, "stance": "leg_b"}}"#;
        assert_eq!(Study::from_json(text).expect("a study").unused(), ["b"]);
    }

    #[test]
    fn constants_are_expressions_of_each_other_in_any_order() {
        let text = r#"{"constants": {"h": "l/4", "l": "2*one", "one": 1}, "parameters": {"a": {"from": "-h", "to": "pi", "steps": 3}}, "state": {}}"#;
        let study = Study::from_json(text).expect("a study");
        let [parameter] = study.parameters() else { panic!("one") };
        assert_eq!((parameter.from, parameter.to, parameter.steps), (-0.5, std::f64::consts::PI, 3));
        assert_eq!((parameter.sample(0), parameter.sample(2)), (-0.5, std::f64::consts::PI));
    }
}
