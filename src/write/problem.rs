//! What a result adds to a contact problem that was given as matrices: notes and its Delassus matrix.

use crate::impact::Analysis;
use crate::read::Problem;
use std::borrow::Cow;

/// Beyond this condition the last digits alone decide whether a matrix is regular.
const ILL_CONDITIONED: f64 = 1e14;

/// What a reader of the analysis should know, in whole sentences.
pub(super) fn notes(problem: &Problem, analysis: &Analysis) -> Cow<'static, [String]> {
    let keep = "give mass_matrix, contact_jacobian and velocity to keep what rounding loses";
    let repaired = || {
        let rank = analysis.rank;
        format!(
            "the Delassus matrix is indefinite by its rounding: the nearest semidefinite one, of rank {rank}, was taken; {keep}"
        )
    };
    let ill = |condition: f64| {
        format!("the Delassus matrix has condition {condition:.1e} and may be singular except for rounding: {keep}")
    };
    let condition = analysis.condition.filter(|&condition| condition > ILL_CONDITIONED && problem.contact.is_given());
    let notes = problem.contact.is_repaired().then(repaired).into_iter();
    notes.chain(condition.map(ill)).chain(analysis.energy_note()).collect()
}

/// G, two rows and columns per contact.
pub(super) fn delassus(problem: &Problem) -> Vec<Vec<f64>> {
    let rows = 0..2 * problem.contact.contacts();
    rows.clone().map(|row| rows.clone().map(|column| problem.contact.delassus(row, column)).collect()).collect()
}
