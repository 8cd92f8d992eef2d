//! Reads a contact problem given as matrices.

use super::state as read;
use crate::impact::{ContactProblem, Errors, Source, check_matrix_size};
use crate::read::json::{Node, Value};
use crate::scalar::{Ordered, Trigonometry};
use crate::state::Defaults;
use crate::{Error, Reason, Result};

/// A contact problem with its id and the names of its contacts.
#[derive(Debug, Clone)]
pub struct Problem {
    /// A JSON string or number.
    pub id: Option<serde_json::Value>,
    /// One name per contact.
    pub names: Vec<String>,
    /// The problem itself.
    pub contact: ContactProblem,
}

/// Fields that are suggested for a similar name: only long ones, because short names resemble each other.
const LONG: [&str; 7] =
    ["friction", "restitution", "delassus", "velocity_before", "mass_matrix", "contact_jacobian", "velocity"];

/// Names that other programs and formulas use for some of these fields.
const SYNONYMS: [(&str, &str); 6] = [
    ("mu", "friction"),
    ("friction_coefficient", "friction"),
    ("e", "restitution"),
    ("cor", "restitution"),
    ("coefficient_of_restitution", "restitution"),
    ("restitution_coefficient", "restitution"),
];

impl Problem {
    /// Reads a problem from one JSON object: `delassus` and `velocity_before`, or `mass_matrix`, `contact_jacobian` and
    /// `velocity`; `friction`, `restitution`, `id` and `names`. Other fields are ignored, unless their name resembles
    /// or means a long one of these that is missing.
    ///
    /// # Errors
    /// Returns an error for broken JSON, a misspelt field, an `uncertainty`, values of the wrong kind, shape or range,
    /// or a matrix that is no Delassus matrix.
    pub fn from_json(text: &str, defaults: &Defaults) -> Result<Self> {
        let tree = Value::parse(text)?;
        let root = Node::root(&tree, text, None);
        let fields: Vec<Node> = root.fields("field")?.collect();
        let field = |name: &str| fields.iter().find(|field| field.key() == name);
        let required = |name: &str| field(name).ok_or_else(|| root.missing(name));
        let id = field("id").map(Node::id).transpose()?;
        for other in fields.iter().filter(|field| !LONG.contains(&field.key())) {
            let is_meant = |known: &&&str| {
                let is_near = strsim::osa_distance(other.key(), known) <= 2;
                field(known).is_none() && (is_near || SYNONYMS.contains(&(other.key(), **known)))
            };
            if let Some(meant) = LONG.iter().find(is_meant) {
                let unknown = other.refuse(Reason::UnknownField(other.key().to_owned()));
                return Err(unknown.did_you_mean(meant, [*meant]));
            }
        }

        if let Some(uncertainty) = field("uncertainty") {
            let reason = Reason::Unsupported("a contact problem is taken as exact".into());
            let hint = "give the state it comes from to `impact`, with its uncertainty";
            return Err(uncertainty.refuse(reason).hint(hint));
        }

        let laws = |contacts: usize| -> Result<_> {
            check_matrix_size(contacts)?;
            let friction = match (field("friction"), defaults.friction) {
                (Some(field), _) => per_contact(field, contacts, read::friction)?,
                (None, Some(friction)) => vec![friction; contacts],
                (None, None) => {
                    let hint = "add \"friction\" to the problem, or give `friction`";
                    return Err(root.missing("friction").hint(hint));
                }
            };
            let restitution = field("restitution").map(|field| per_contact(field, contacts, read::restitution));
            let names = match field("names") {
                Some(field) => names(field, contacts)?,
                None if contacts == 1 => vec!["contact".to_owned()],
                None => (0..contacts).map(|contact| format!("contact/{contact}")).collect(),
            };
            Ok((friction, restitution.unwrap_or_else(|| Ok(vec![0.0; contacts]))?, names))
        };
        let (contact, names) = match (field("delassus"), field("mass_matrix")) {
            (Some(delassus), None) => {
                let velocity = required("velocity_before").map_err(|error| match field("velocity") {
                    Some(_) => error.hint(
                        "did you mean velocity_before, not velocity? it has [tangential, normal] of each contact",
                    ),
                    None => error,
                })?;
                let (delassus, velocity_before) = delassus_matrix(delassus, velocity)?;
                let (friction, restitution, names) = laws(velocity_before.len())?;
                (ContactProblem::new(delassus, velocity_before, friction, restitution), names)
            }
            (None, Some(mass_matrix)) => {
                let (jacobian, velocity) = (required("contact_jacobian")?, required("velocity")?);
                let rows = jacobian.matrix()?;
                if rows.len() % 2 != 0 {
                    let reason = format!("two rows per contact are needed, not {} in all", rows.len());
                    return Err(jacobian.refuse(Reason::Inconsistent(reason)));
                }
                let (mass_matrix, velocity) = (mass_matrix.matrix()?, velocity.vector()?);
                let (friction, restitution, names) = laws(rows.len() / 2)?;
                (ContactProblem::from_dynamics(&mass_matrix, &rows, &velocity, friction, restitution), names)
            }
            (Some(_), Some(both)) => {
                let reason = "the problem has both \"delassus\" and \"mass_matrix\"";
                return Err(both.refuse(Reason::Inconsistent(reason.into())).hint("leave one of them out"));
            }
            (None, None) => {
                let hint = "give \"delassus\" and \"velocity_before\", or \"mass_matrix\", \"contact_jacobian\" and \"velocity\"";
                let state = "this is a state, which `heelstrike impact` and `batch` read";
                return Err(root.missing("delassus").hint(if field("position").is_some() { state } else { hint }));
            }
        };
        // The place of an error about a matrix is the name of its field.
        let located = |error: Error| match error.place().and_then(|place| field(place.split('[').next()?)) {
            Some(field) => field.locate(error),
            None => error,
        };
        Ok(Self { id, names, contact: contact.map_err(located)? })
    }
}

/// Reads the entries of a Delassus matrix, row by row, and the velocities of its contacts.
fn delassus_matrix(delassus: &Node, velocity: &Node) -> Result<(Vec<f64>, Vec<[f64; 2]>)> {
    let pair = |entry: Node| entry.numbers("a list of 2 numbers, [tangential, normal]");
    let velocity: Vec<[f64; 2]> = velocity.entries()?.map(pair).collect::<Result<_>>()?;
    let rows = delassus.matrix()?;
    let (contacts, size, columns) = (velocity.len(), 2 * velocity.len(), rows.first().map_or(0, Vec::len));
    if rows.len() != size || columns != size {
        let found = format!("{} x {columns}", rows.len());
        let reason = format!(
            "the matrix of {contacts} contact{s} has {size} x {size} entries, not {found}",
            s = if contacts == 1 { "" } else { "s" }
        );
        let hint = "two rows and columns per contact, tangential and normal";
        return Err(delassus.refuse(Reason::Inconsistent(reason)).hint(hint));
    }
    Ok((rows.concat(), velocity))
}

impl Source for Problem {
    fn problem<T: Ordered + Trigonometry>(&self) -> ContactProblem<T> {
        self.contact.problem()
    }

    fn errors(&self) -> Errors<'_> {
        self.contact.errors()
    }

    fn is_exact(&self) -> bool {
        self.contact.is_exact()
    }

    fn contact_name(&self, contact: usize) -> String {
        self.names[contact].clone()
    }
}

/// Reads one value for all contacts, or a list with one for each.
fn per_contact<T: Clone>(field: &Node, contacts: usize, read: impl Fn(Node) -> Result<T>) -> Result<Vec<T>> {
    match field.entries() {
        Ok(_) => counted(field, contacts)?.map(read).collect(),
        Err(_) => Ok(vec![read(*field)?; contacts]),
    }
}

/// Reads different names, one per contact.
fn names(field: &Node, contacts: usize) -> Result<Vec<String>> {
    let mut names: Vec<String> = Vec::with_capacity(contacts);
    for entry in counted(field, contacts)? {
        let name = entry.text()?.to_owned();
        if names.contains(&name) {
            return Err(entry.refuse(Reason::Duplicate { what: "contact", name }));
        }
        names.push(name);
    }
    Ok(names)
}

/// Returns the entries of a list, one per contact.
fn counted<'n>(field: &'n Node<'n>, contacts: usize) -> Result<impl Iterator<Item = Node<'n>>> {
    let entries = field.entries()?;
    if entries.len() == contacts {
        return Ok(entries);
    }
    let plural = if contacts == 1 { "" } else { "s" };
    let reason = format!("{} entries for {contacts} contact{plural}", entries.len());
    Err(field.refuse(Reason::Inconsistent(reason)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Friction;

    #[test]
    fn fields_that_mean_missing_ones_are_refused() {
        let hint = |more: &str| {
            let text = format!(r#"{{"delassus": [[2, 1], [1, 2]], "velocity_before": [[0.5, -1]], {more}}}"#);
            let defaults = Defaults { friction: Some(Friction::Finite(0.9)), ..Defaults::default() };
            Problem::from_json(&text, &defaults).err().and_then(|error| error.remedy().map(str::to_owned))
        };
        assert_eq!(hint("\"mu\": 0.1").as_deref(), Some("did you mean friction?"));
        for meant in ["\"restitution_coefficient\": 0.5", "\"friction\": 1, \"e\": 0.5"] {
            assert_eq!(hint(meant).as_deref(), Some("did you mean restitution?"));
        }
        assert_eq!(hint("\"friction\": 0.1, \"mu\": 0.1, \"note\": 1"), None);
        let whose = "give the state it comes from to `impact`, with its uncertainty";
        assert_eq!(hint("\"uncertainty\": {\"friction\": 0.1}").as_deref(), Some(whose));
    }
}
