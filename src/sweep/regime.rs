//! The regime of a point: the set of valid outcomes, or the refusal.

use crate::law::Mode;
use crate::pipeline::Impact;
use crate::{Error, Reason, Result};
use std::mem::{Discriminant, discriminant};

/// The regime of a point. All points of a region have the same regime.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
#[non_exhaustive]
pub enum Regime {
    /// The state is answered.
    Answered {
        /// Names of the closed contacts.
        contacts: Vec<String>,
        /// The modes of every outcome, in the order in which combinations are tried.
        outcomes: Vec<Vec<Mode>>,
        /// Combinations that no precision proves or excludes.
        undecided: Vec<Vec<Mode>>,
    },
    /// The state is refused, with a reason of this kind.
    Refused {
        reason: Discriminant<Reason>,
        /// The place in the state.
        place: Option<String>,
    },
}

impl Regime {
    /// Returns the regime of an answer.
    pub fn of(answer: &Result<Box<Impact>>) -> Self {
        let analyzed = answer.as_ref().map_err(Error::clone).and_then(|impact| Ok((impact, impact.analyzed()?)));
        let (impact, analysis) = match analyzed {
            Ok(analyzed) => analyzed,
            Err(error) => {
                let place = error.place().map(str::to_owned);
                return Self::Refused { reason: discriminant(error.reason()), place };
            }
        };
        let open = analysis.outcomes.iter().filter(|outcome| !outcome.decided);
        let mut undecided: Vec<Vec<Mode>> = open.map(|outcome| outcome.modes.clone()).collect();
        undecided.sort();
        let contacts = impact.contacts.iter().map(|contact| contact.name.to_string()).collect();
        Self::Answered { contacts, outcomes: analysis.modes(), undecided }
    }

    /// Returns the modes of every outcome; `None` if the state is refused.
    pub fn outcomes(&self) -> Option<&[Vec<Mode>]> {
        let Self::Answered { outcomes, .. } = self else { return None };
        Some(outcomes)
    }

    /// Returns the names of the closed contacts; empty if the state is refused.
    pub fn contacts(&self) -> &[String] {
        let Self::Answered { contacts, .. } = self else { return &[] };
        contacts
    }
}
