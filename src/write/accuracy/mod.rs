//! Error against run time: what is written of it.
//!
//! ```text
//!     Study, Comparison --> Accuracy --> JSON (its own fields), advice.rs, text.rs, picture.rs
//! ```

mod advice;
#[cfg(feature = "plot")]

mod text;

use crate::accuracy::compliant::Comparison;
use crate::accuracy::{Factorization, Method, Study};
use serde::Serialize;

/// What every method makes of some cases.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Accuracy {
    /// The cases.
    pub studies: Vec<Study>,
    /// Compliant contact beside the rigid outcomes of one state.
    pub compliant: Option<Compliant>,
    /// What to use when, by the times and errors of these cases; none where none was measured.
    pub advice: Option<String>,
}

/// Compliant contact, and the state that it was tried on.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compliant {
    /// What the state is called.
    pub name: String,
    /// What came of it.
    #[serde(flatten)]
    pub comparison: Comparison,
}

impl Accuracy {
    /// The cases, and perhaps compliant contact.
    pub fn new(studies: Vec<Study>, compliant: Option<Compliant>) -> Self {
        Self { advice: advice::advice(&studies), studies, compliant }
    }
}

pub(crate) fn name_of(method: &Method) -> String {
    match method.factorization {
        Some(factorization) => format!("{}, {}", method.number, in_words(factorization)),
        None => method.number.to_owned(),
    }
}

fn in_words(factorization: Factorization) -> &'static str {
    match factorization {
        Factorization::SparseLtl => "sparse LTL",
        Factorization::DenseCholesky => "dense Cholesky",
        Factorization::ArticulatedBodies => "articulated bodies",
    }
}
