//! The regime of a point: the set of valid outcomes, or the refusal.

use crate::law::Mode;
use crate::pipeline::Impact;
use crate::{Error, Reason, Result};
use std::mem::{Discriminant, discriminant};

/// What happens at a point; all points of a region have the same.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Regime {
    /// The state is answered.
    Answered {
        /// Names of the closed contacts.
        contacts: Vec<String>,
        /// The modes of every outcome, in the order in which combinations are tried.
        outcomes: Vec<Vec<Mode>>,
        /// Combinations that no precision shows or excludes.
        undecided: Vec<Vec<Mode>>,
    },
    /// The state is refused.
    Refused {
        /// The kind of reason.
        reason: Discriminant<Reason>,
        /// The place inside the state.
        place: Option<String>,
    },
}

impl Regime {
    /// That of an answer.
    pub fn of(answer: &Result<Impact>) -> Self {
        let refused = |error: &Error| Self::Refused {
            reason: discriminant(error.reason()),
            place: error.place().map(str::to_owned),
        };
        let (impact, analysis) = match answer {
            Err(error) => return refused(error),
            Ok(impact) => match impact.analysed() {
                Err(error) => return refused(&error),
                Ok(analysis) => (impact, analysis),
            },
        };
        let list = |decided: bool| {
            let chosen = analysis.outcomes.iter().filter(|outcome| outcome.decided == decided);
            let mut list: Vec<Vec<Mode>> = chosen.map(|outcome| outcome.modes.clone()).collect();
            list.sort();
            list.dedup();
            list
        };
        Self::Answered {
            contacts: impact.contacts.iter().map(|contact| contact.name.clone()).collect(),
            outcomes: list(true),
            undecided: list(false),
        }
    }

    /// The modes of every outcome; `None` if the state is refused.
    pub fn outcomes(&self) -> Option<&[Vec<Mode>]> {
        match self {
            Self::Answered { outcomes, .. } => Some(outcomes),
            Self::Refused { .. } => None,
        }
    }

    /// Names of the closed contacts; empty if the state is refused.
    pub fn contacts(&self) -> &[String] {
        match self {
            Self::Answered { contacts, .. } => contacts,
            Self::Refused { .. } => &[],
        }
    }
}
