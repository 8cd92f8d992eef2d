//! Reads a contact problem given as matrices.

use super::state as read;
use crate::impact::problem::check_matrix_size;
use crate::impact::{ContactProblem, Errors, Source};
use crate::law::Friction;
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

impl Problem {
    /// Reads a problem from one JSON object: `delassus` and `velocity_before`, or `mass_matrix`, `contact_jacobian` and
    /// `velocity`; `friction`, `restitution`, `id` and `names`. Other fields are ignored.
    ///
    /// # Errors
    /// Broken JSON, values of the wrong kind, shape or range, a matrix that is no Delassus matrix.
    pub fn from_json(text: &str, defaults: &Defaults) -> Result<Self> {
        let tree = Value::parse(text)?;
        let root = Node::root(&tree, text);
        let fields = Fields::read(&root)?;
        let id = fields.id.map(|field| field.id()).transpose()?;

        let matrices = match (fields.delassus, fields.mass_matrix) {
            (Some(delassus), None) => Matrices::contact(&root, delassus, &fields)?,
            (None, Some(mass_matrix)) => Matrices::dynamics(&root, mass_matrix, &fields)?,
            (Some(_), Some(both)) => {
                let reason = "the problem has both \"delassus\" and \"mass_matrix\"";
                return Err(both.refuse(Reason::Inconsistent(reason.into())).hint("leave one of them out"));
            }
            (None, None) => {
                let hint = "give \"delassus\" and \"velocity_before\", or \"mass_matrix\", \"contact_jacobian\" and \"velocity\"";
                return Err(missing(&root, "delassus").hint(hint));
            }
        };

        let contacts = matrices.contacts();
        check_matrix_size(contacts)?;
        let friction = match (fields.friction, defaults.friction) {
            (Some(field), _) => per_contact(&field, contacts, read::friction)?,
            (None, Some(friction)) => vec![friction; contacts],
            (None, None) => {
                return Err(missing(&root, "friction").hint("add \"friction\" to the problem, or give `friction`"));
            }
        };
        let restitution = match fields.restitution {
            Some(field) => per_contact(&field, contacts, read::restitution)?,
            None => vec![0.0; contacts],
        };
        let names = match fields.names {
            Some(field) => names(&field, contacts)?,
            None if contacts == 1 => vec!["contact".to_owned()],
            None => (0..contacts).map(|contact| format!("contact/{contact}")).collect(),
        };
        let contact = matrices.problem(friction, restitution).map_err(|error| fields.locate(error))?;
        Ok(Self { id, names, contact })
    }
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

/// The fields of a problem, as far as they are given.
#[derive(Default)]
struct Fields<'n> {
    id: Option<Node<'n>>,
    delassus: Option<Node<'n>>,
    velocity_before: Option<Node<'n>>,
    mass_matrix: Option<Node<'n>>,
    contact_jacobian: Option<Node<'n>>,
    velocity: Option<Node<'n>>,
    friction: Option<Node<'n>>,
    restitution: Option<Node<'n>>,
    names: Option<Node<'n>>,
}

impl<'n> Fields<'n> {
    fn read(root: &'n Node<'n>) -> Result<Self> {
        let mut fields = Self::default();
        for field in root.fields("field")? {
            let place = match field.key() {
                "id" => &mut fields.id,
                "delassus" => &mut fields.delassus,
                "velocity_before" => &mut fields.velocity_before,
                "mass_matrix" => &mut fields.mass_matrix,
                "contact_jacobian" => &mut fields.contact_jacobian,
                "velocity" => &mut fields.velocity,
                "friction" => &mut fields.friction,
                "restitution" => &mut fields.restitution,
                "names" => &mut fields.names,
                _ => continue,
            };
            *place = Some(field);
        }
        Ok(fields)
    }
}

impl Fields<'_> {
    /// Puts an error of a matrix at the field of that name.
    fn locate(&self, error: Error) -> Error {
        let field = error.place().and_then(|place| {
            let fields = [self.delassus, self.mass_matrix, self.contact_jacobian, self.velocity, self.velocity_before];
            fields.into_iter().flatten().find(|field| place.split('[').next() == Some(field.key()))
        });
        match field {
            Some(field) => field.locate(error),
            None => error,
        }
    }
}

/// The two ways of giving a problem.
enum Matrices {
    Contact { delassus: Vec<f64>, velocity_before: Vec<[f64; 2]> },
    Dynamics { mass_matrix: Vec<Vec<f64>>, contact_jacobian: Vec<Vec<f64>>, velocity: Vec<f64> },
}

impl Matrices {
    fn contact(root: &Node, delassus: Node, fields: &Fields) -> Result<Self> {
        let velocity = fields.velocity_before.ok_or_else(|| missing(root, "velocity_before"))?;
        let entries = velocity.entries()?;
        let velocity_before: Vec<[f64; 2]> =
            entries.map(|entry| entry.numbers("a list of 2 numbers, [tangential, normal]")).collect::<Result<_>>()?;

        let rows = delassus.matrix()?;
        let size = 2 * velocity_before.len();
        let columns = rows.first().map_or(0, Vec::len);
        if rows.len() != size || columns != size {
            let found = format!("{} x {columns}", rows.len());
            let contacts = velocity_before.len();
            let reason = format!("{contacts} contacts need a Delassus matrix of {size} x {size}, not {found}");
            let hint = "two rows and columns per contact, tangential and normal";
            return Err(delassus.refuse(Reason::Inconsistent(reason)).hint(hint));
        }
        Ok(Self::Contact { delassus: rows.concat(), velocity_before })
    }

    fn dynamics(root: &Node, mass_matrix: Node, fields: &Fields) -> Result<Self> {
        let jacobian = fields.contact_jacobian.ok_or_else(|| missing(root, "contact_jacobian"))?;
        let velocity = fields.velocity.ok_or_else(|| missing(root, "velocity"))?;
        let contact_jacobian = jacobian.matrix()?;
        if contact_jacobian.len() % 2 != 0 {
            let reason = format!("two rows per contact are needed, not {} in all", contact_jacobian.len());
            return Err(jacobian.refuse(Reason::Inconsistent(reason)));
        }
        Ok(Self::Dynamics { mass_matrix: mass_matrix.matrix()?, contact_jacobian, velocity: velocity.vector()? })
    }

    fn contacts(&self) -> usize {
        match self {
            Self::Contact { velocity_before, .. } => velocity_before.len(),
            Self::Dynamics { contact_jacobian, .. } => contact_jacobian.len() / 2,
        }
    }

    fn problem(self, friction: Vec<Friction>, restitution: Vec<f64>) -> Result<ContactProblem> {
        match self {
            Self::Contact { delassus, velocity_before } => {
                ContactProblem::new(delassus, velocity_before, friction, restitution)
            }
            Self::Dynamics { mass_matrix, contact_jacobian, velocity } => {
                ContactProblem::from_dynamics(&mass_matrix, &contact_jacobian, &velocity, friction, restitution)
            }
        }
    }
}

/// One value for all contacts, or a list with one for each.
fn per_contact<T: Clone>(field: &Node, contacts: usize, read: impl Fn(Node) -> Result<T>) -> Result<Vec<T>> {
    if !field.is_list() {
        return Ok(vec![read(*field)?; contacts]);
    }
    let entries = field.entries()?;
    if entries.len() != contacts {
        return Err(wrong_count(field, entries.len(), contacts));
    }
    entries.map(read).collect()
}

/// Different names, one per contact.
fn names(field: &Node, contacts: usize) -> Result<Vec<String>> {
    let entries = field.entries()?;
    if entries.len() != contacts {
        return Err(wrong_count(field, entries.len(), contacts));
    }
    let mut names: Vec<String> = Vec::with_capacity(contacts);
    for entry in entries {
        let name = entry.text()?.to_owned();
        if names.contains(&name) {
            return Err(entry.refuse(Reason::Duplicate { what: "contact", name }));
        }
        names.push(name);
    }
    Ok(names)
}

fn wrong_count(field: &Node, found: usize, contacts: usize) -> Error {
    field.refuse(Reason::Inconsistent(format!("{found} entries for {contacts} contacts")))
}

fn missing(root: &Node, field: &str) -> Error {
    root.refuse(Reason::Missing(format!("\"{field}\"")))
}
