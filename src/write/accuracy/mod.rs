//! The record of error against run time.
//!
//! ```text
//!     CaseStudy, Comparison --> Accuracy --> JSON (its own fields), advice.rs, text.rs, picture.rs
//! ```

mod advice;
mod text;

use crate::accuracy::compliant::Comparison;
use crate::accuracy::{CaseStudy, Factorization, Method};
use serde::Serialize;

/// The results of every method on some cases.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Accuracy {
    /// The cases.
    pub studies: Vec<CaseStudy>,
    /// Compliant contact next to the rigid outcomes of one state.
    pub compliant: Option<Compliant>,
    /// Which method to use, by the times and errors of these cases; `None` if nothing was measured.
    pub advice: Option<String>,
}

/// Compliant contact, and the state that it was tried on.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compliant {
    /// The name of the state.
    pub name: String,
    /// The results.
    #[serde(flatten)]
    pub comparison: Comparison,
}

impl Accuracy {
    /// A record of these cases, and of compliant contact if it was compared.
    pub fn new(studies: Vec<CaseStudy>, compliant: Option<Compliant>) -> Self {
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
