//! Reads studies: parameters, and a state and a robot whose numbers are expressions of them.

use super::{state as read, variation};
use crate::budget::BudgetSpent;
use crate::description::Description;
use crate::pipeline::Aspect;
use crate::read::expression::{Names, is_name, names_in};
use crate::read::json::{Node, Value};
use crate::state::{Defaults, State};
use crate::{Error, Reason, Result, Robot};
use std::borrow::Cow;

/// The greatest number of samples in all.
const SAMPLE_LIMIT: usize = 1_000_000;

/// Names that are taken in the record and the rows of a sample, which also have the parameters' names.
const OF_SAMPLES: [&str; 2] = ["result", "region"];

/// The greatest number of constants; a study has some ten.
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
    question: Aspect,
    tree: Value<'t>,
    parameters: Vec<Parameter>,
    constants: Names,
}

/// A parameter of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// The name in expressions.
    pub name: String,
    /// The least value.
    pub from: f64,
    /// The greatest value.
    pub to: f64,
    /// The number of samples, both ends included; at least 2.
    pub steps: usize,
}

impl Parameter {
    /// Returns the value of a sample; `index` is from 0 to `steps` - 1.
    pub fn sample(&self, index: usize) -> f64 {
        match index + 1 == self.steps {
            true => self.to,
            false => self.from + (self.to - self.from) * (index as f64 / (self.steps - 1) as f64),
        }
    }

    /// Returns the length of the parameter's range.
    pub fn range(&self) -> f64 {
        self.to - self.from
    }
}

impl<'t> Study<'t> {
    /// Reads a study from one JSON object. Its state and robot are read, and may be refused, at each point.
    ///
    /// # Errors
    /// Returns an error with place, line and column for broken JSON, unknown or repeated fields, no parameter or more
    /// than two, an empty range, fewer than two samples or more than a million, and names that expressions cannot use.
    pub fn from_json(text: &'t str) -> Result<Self> {
        let tree = Value::parse(text)?;
        let root = Node::root(&tree, text, None);
        let [_, _, state, _, question] =
            root.object("Study", ["parameters", "constants", "state", "robot", "question"])?;
        let aspects = [("impact", Aspect::Impact), ("forces", Aspect::Forces)];
        let question = question.map(|field| field.choice("\"impact\" or \"forces\"", aspects)).transpose()?;
        let constants = constants(&tree, text)?;
        let with_constants = Node::root(&tree, text, Some(&constants));
        let example = "as in \"parameters\": {\"alpha\": {\"from\": 0, \"to\": 1, \"steps\": 50}}";
        let field = with_constants.field("parameters")?.ok_or_else(|| root.missing("parameters").hint(example))?;
        let parameters: Vec<_> =
            field.fields("parameter")?.map(|entry| parameter(root, entry, &constants)).collect::<Result<_>>()?;
        if !(1..=2).contains(&parameters.len()) {
            let reason = format!("a study varies one or two parameters, not {}", parameters.len());
            let hint = if parameters.is_empty() { example } else { "make the others constants" };
            return Err(field.refuse(Reason::Inconsistent(reason)).hint(hint));
        }
        let samples = parameters.iter().try_fold(1_usize, |all, parameter| all.checked_mul(parameter.steps));
        if samples.is_none_or(|samples| samples > SAMPLE_LIMIT) {
            return Err(field.refuse(Reason::TooMany { what: "samples", limit: SAMPLE_LIMIT }));
        }
        if state.is_none() {
            return Err(root.missing("state").hint("as in `impact`, with expressions where numbers stand"));
        }
        Ok(Self { text, question: question.unwrap_or_default(), parameters, constants, tree: tree.clone() })
    }

    /// Returns what is asked about each state.
    pub fn question(&self) -> Aspect {
        self.question
    }

    /// Returns the one or two parameters.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Returns the refusal of a study beyond its budget of work, located at the parameter with the most samples.
    pub fn beyond(&self, BudgetSpent(time): BudgetSpent) -> Error {
        let most = (0..self.parameters.len()).rev().max_by_key(|&at| self.parameters[at].steps).unwrap_or_default();
        let Parameter { name, from, to, steps } = &self.parameters[most];
        let seconds = time.as_secs_f64();
        // If there are few samples, their number is not the reason.
        let fewer = if *steps > 16 { format!("fewer than {steps} samples of {name}, ") } else { String::new() };
        // Contacts that are close together have nearly the same equations, which takes many digits to decide.
        let profile = ["state", "ground", "profile"].iter().try_fold(&self.tree, |value, field| value.get(field));
        let closer = match profile {
            Some(_) => ", a smaller `contact_tolerance`, so that fewer points of the profile touch at once",
            None => "",
        };
        self.refuse_steps(most, Reason::BeyondBudget).hint(format!(
            "{seconds} s of processor time were not enough: take {fewer}a narrower range of {name} than {from:?} to \
             {to:?}{closer}, or `budget: {:?}`",
            10.0 * seconds.max(1.0)
        ))
    }

    /// Refuses the number of samples of a parameter.
    pub(crate) fn refuse_steps(&self, parameter: usize, reason: Reason) -> Error {
        let root = Node::root(&self.tree, self.text, None);
        let refused = || {
            let field = root.field("parameters").ok()??;
            let entry = field.fields("parameter").ok()?.nth(parameter)?;
            let steps = entry.field("steps").ok()??;
            Some(steps.refuse(reason.clone()))
        };
        refused().unwrap_or_else(|| reason.clone().into())
    }

    /// Returns the parameters and constants that no expression uses; a parameter is used by the state or the robot.
    pub fn unused(&self) -> Vec<&str> {
        let unused = |name: &&str, parts: &[&str]| {
            !parts.iter().filter_map(|part| self.tree.get(part)).any(|part| uses(part, name))
        };
        let parameters = self.parameters.iter().map(|parameter| parameter.name.as_str());
        let parameters = parameters.filter(|name| unused(name, &["state", "robot"]));
        let constants = self.constants.iter();
        let constants = constants.filter(|name| unused(name, &["constants", "parameters", "state", "robot"]));
        parameters.chain(constants).collect()
    }

    /// Returns whether the study varies the robot itself.
    pub fn varies_the_robot(&self) -> bool {
        self.tree.get("robot").is_some()
    }

    /// Returns the values of parameters and constants at a point.
    pub(crate) fn names(&self, point: &[f64]) -> Names {
        let mut names = self.constants.clone();
        for (parameter, &value) in self.parameters.iter().zip(point) {
            names.set(&parameter.name, value);
        }
        names
    }

    /// Returns the state at the point where parameters and constants have these values.
    pub(crate) fn state(&self, names: &Names, robot: &Robot, defaults: &Defaults) -> Result<State> {
        let root = Node::root(&self.tree, self.text, Some(names));
        let field = root.field("state")?.ok_or_else(|| root.missing("state").hint("as in `impact`"))?;
        read::read(field, robot, defaults)
    }

    /// Returns the robot's description at the point where parameters and constants have these values.
    pub(crate) fn describe<'d>(&self, names: &Names, description: &'d Description) -> Result<Cow<'d, Description>> {
        match Node::root(&self.tree, self.text, Some(names)).field("robot")? {
            Some(field) => variation::applied(field, description).map(Cow::Owned),
            None => Ok(Cow::Borrowed(description)),
        }
    }
}

/// Reads the constants. Each may be an expression of others, in any order, because many JSON writers sort names.
fn constants(tree: &Value, text: &str) -> Result<Names> {
    let (mut constants, plain) = (Names::default(), Node::root(tree, text, None));
    let Some(field) = plain.field("constants")? else { return Ok(constants) };
    let mut open: Vec<String> = field.fields("constant")?.map(name).collect::<Result<_>>()?;
    if open.len() > CONSTANT_LIMIT {
        return Err(field.refuse(Reason::TooMany { what: "constants", limit: CONSTANT_LIMIT }));
    }
    while !open.is_empty() {
        let known = constants.clone();
        let root = Node::root(tree, text, Some(&known));
        let Some(field) = root.field("constants")? else { break };
        let is_open = |name: &str| open.iter().any(|open| open == name);
        let mut later = Vec::new();
        for entry in field.fields("constant")?.filter(|entry| is_open(entry.key())) {
            if entry.as_text().is_some_and(|text| names_in(text).any(is_open)) {
                later.push(entry.key().to_owned());
            } else {
                refuse_parameters(plain, entry, "constants")?;
                constants.set(entry.key(), entry.number()?);
            }
        }
        if later.len() == open.len() {
            let reason = format!("each of these constants needs another one, or itself: {}", later.join(", "));
            return Err(field.refuse(Reason::Inconsistent(reason)).hint("give one of them a number"));
        }
        open = later;
    }
    Ok(constants)
}

/// Refuses an expression that uses a parameter, even one named like pi or e, where values do not vary.
fn refuse_parameters(root: Node, entry: Node, what: &str) -> Result<()> {
    let used = |name: &&str| names_in(entry.as_text().unwrap_or_default()).any(|used| used == *name);
    let parameters = root.field("parameters").ok().flatten();
    let parameters = parameters.iter().flat_map(|field| field.fields("parameter").into_iter().flatten());
    let Some(name) = parameters.map(|parameter| parameter.key()).find(used) else { return Ok(()) };
    let reason = Reason::Inconsistent(format!("{name} is a parameter, and {what} do not vary"));
    Err(entry.refuse(reason).hint("write it into the state, or rename the parameter"))
}

/// Reads `{"from", "to", "steps"}`.
fn parameter(root: Node, entry: Node, constants: &Names) -> Result<Parameter> {
    let name = name(entry)?;
    if constants.iter().any(|constant| constant == name) {
        let error = entry.refuse_name(entry.key(), Reason::Duplicate { what: "name", name });
        return Err(error.hint("it is a constant already"));
    }
    if OF_SAMPLES.contains(&name.as_str()) {
        let reason = Reason::Inconsistent(format!("\"{name}\" is a field or column of every sample"));
        return Err(entry.refuse_name(&name, reason).hint("give the parameter another name"));
    }
    let [from, to, steps] = entry.object("Parameter", ["from", "to", "steps"])?;
    let example = "a parameter is {\"from\": 0, \"to\": 1, \"steps\": 50}";
    let given = |field: Option<_>, name| field.ok_or_else(|| entry.missing(name).hint(example));
    let end = |part: Node| refuse_parameters(root, part, "ends of ranges").and_then(|()| part.number());
    let (from, to) = (end(given(from, "from")?)?, end(given(to, "to")?)?);
    let steps = samples(given(steps, "steps")?)?;
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
    Err(part.refuse(Reason::OutOfRange { what, allowed: "a whole number from 2 to 1000000", value }))
}

fn name(entry: Node) -> Result<String> {
    let name = entry.key();
    if is_name(name) {
        return Ok(name.to_owned());
    }
    let reason = format!("\"{name}\" is no name that an expression can use");
    Err(entry.refuse_name(name, Reason::Inconsistent(reason)).hint("take letters, digits and _, no digit first"))
}

/// Returns whether an expression in `value` uses the name; keys do not count.
fn uses(value: &Value, name: &str) -> bool {
    match value {
        Value::Text(text) => names_in(text).any(|used| used == name),
        Value::List(entries) => entries.iter().any(|entry| uses(entry, name)),
        Value::Object(fields) => fields.iter().any(|(_, value)| uses(value, name)),
        Value::Null | Value::Bool | Value::Number(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unused_parameter_is_listed() {
        let text = r#"{"parameters": {"a": {"from": 0, "to": 1, "steps": 2}, "b": {"from": 0, "to": 1, "steps": 2}},
            "state": {"position": {"base": {"z": "sin(2*a)"}}, "stance": "leg_b"}}"#;
        assert_eq!(Study::from_json(text).expect("a study").unused(), ["b"]);
    }

    #[test]
    fn what_does_not_vary_uses_no_parameter() {
        for (constant, to) in [("2*e", "1"), ("1", "e - 1"), ("1", "e + c")] {
            let text = format!(
                r#"{{"constants": {{"c": "{constant}"}}, "parameters": {{"e": {{"from": 0, "to": "{to}", "steps": 3}}}}, "state": {{}}}}"#
            );
            let Err(error) = Study::from_json(&text) else { panic!("{text}") };
            assert!(error.to_string().contains("e is a parameter, and "), "{error}");
        }
    }

    #[test]
    fn constants_refer_to_each_other_in_any_order() {
        let text = r#"{"constants": {"h": "l/4", "l": "2*one", "one": 1}, "parameters": {"a": {"from": "-h", "to": "pi", "steps": 3}}, "state": {}}"#;
        let study = Study::from_json(text).expect("a study");
        let [parameter] = study.parameters() else { panic!("one") };
        assert_eq!((parameter.from, parameter.to, parameter.steps), (-0.5, std::f64::consts::PI, 3));
        assert_eq!((parameter.sample(0), parameter.sample(2)), (-0.5, std::f64::consts::PI));
    }
}
