//! Contact problems: redundant, degenerate, of extreme numbers, by G and by the dynamics.

use crate::answer::{ALL, accepted, check_analysis, check_json, keeps_index_theorem};
use crate::choices::Choices;
use crate::open;
use crate::support::rational::{self, to_f64};
use crate::watch::watched;
use dashu_ratio::RBig;
use heelstrike::Error;
use heelstrike::impact::{AnalysisOptions, ContactProblem, Friction, Mode, Outcome, Scratch, analyze};
use heelstrike::read::Problem;
use heelstrike::write::Report;
use serde::Serialize;
use serde_json::json;
use std::cell::RefCell;

crate::target!(any_contact_problem_is_answered_or_refused, 3_000, 0.6, check);

/// What a contact problem is built from, as `heelstrike solve` reads it.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Matrices {
    Delassus { delassus: Vec<Vec<f64>>, velocity_before: Vec<[f64; 2]> },
    Dynamics { mass_matrix: Vec<Vec<f64>>, contact_jacobian: Vec<Vec<f64>>, velocity: Vec<f64> },
}

#[derive(Debug)]
struct Case {
    matrices: Matrices,
    friction: Vec<Friction>,
    restitution: Vec<f64>,
    explain: bool,
}

/// How wild the numbers of a case are.
#[derive(Clone, Copy)]
enum Kind {
    Whole,
    Real,
    Any,
}

impl Kind {
    fn number(self, choices: &mut Choices) -> f64 {
        match self {
            Self::Whole => f64::from(choices.whole(3)),
            Self::Real => choices.real(),
            Self::Any => choices.number(),
        }
    }

    fn row(self, choices: &mut Choices, length: usize) -> Vec<f64> {
        (0..length).map(|_| self.number(choices)).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A A^T, symmetric to the last digit.
fn square(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    rows.iter().map(|a| rows.iter().map(|b| dot(a, b)).collect()).collect()
}

/// Two rows per contact; some are zero, and some those of another contact again.
fn rows(choices: &mut Choices, contacts: usize, columns: usize, kind: Kind) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for contact in 0..contacts {
        let mut pair = [kind.row(choices, columns), kind.row(choices, columns)];
        match choices.below(8) {
            6 if contact > 0 => {
                let other = choices.below(contact);
                pair = [rows[2 * other].clone(), rows[2 * other + 1].clone()];
                let turned = choices.pick(&[1.0, -1.0]);
                pair[0].iter_mut().for_each(|entry| *entry *= turned);
            }
            7 => pair[choices.below(2)].fill(0.0),
            _ => {}
        }
        if choices.once_in(8) {
            // A power of two changes no digit.
            let scale = 2f64.powi(choices.whole(20) * choices.pick(&[1, 9]));
            pair.iter_mut().flatten().for_each(|entry| *entry *= scale);
        }
        rows.extend(pair);
    }
    rows
}

impl Case {
    fn new(choices: &mut Choices) -> Self {
        let contacts = 1 + choices.below(4);
        let kind = choices.pick(&[Kind::Whole, Kind::Whole, Kind::Real, Kind::Any]);
        let friction = |choices: &mut Choices| match choices.below(8) {
            0 => Friction::ZERO,
            1..4 => Friction::Infinite,
            4 => Friction::Finite(choices.real().abs()),
            5 => Friction::Finite(10f64.powi(choices.whole(12))),
            6 => Friction::Finite(f64::from(choices.whole(8).abs()) / 4.0),
            _ if choices.once_in(8) => Friction::Finite(choices.number()),
            _ => Friction::Finite(choices.number().abs()),
        };
        let restitution = |choices: &mut Choices| match choices.below(8) {
            0..4 => 0.0,
            4 => 1.0,
            5 => 0.5,
            6 => choices.real().abs(),
            _ if choices.once_in(8) => choices.number(),
            _ => 10f64.powi(-choices.whole(300).abs()),
        };
        let friction = each(choices, contacts, friction);
        let restitution = each(choices, contacts, restitution);
        let columns = choices.below(2 * contacts + 3);
        let matrices = if choices.once_in(3) {
            let mut mass_matrix = square(&each(choices, columns, |choices| kind.row(choices, columns)));
            for (i, row) in mass_matrix.iter_mut().enumerate() {
                row[i] += choices.pick(&[1.0, 1.0, 0.125, 1e-9, 1e9]);
            }
            let contact_jacobian = rows(choices, contacts, columns, kind);
            Matrices::Dynamics { mass_matrix, contact_jacobian, velocity: kind.row(choices, columns) }
        } else {
            let rows = rows(choices, contacts, columns, kind);
            let own = kind.row(choices, columns);
            // Velocities of a motion, which dependent contacts share; or any, with contacts at rest among them.
            let moves = choices.once_in(2);
            let velocity = |choices: &mut Choices, row: &[f64]| match choices.below(4) {
                _ if moves => dot(row, &own),
                0 => 0.0,
                _ => kind.number(choices),
            };
            let mut velocity_before: Vec<[f64; 2]> =
                rows.chunks_exact(2).map(|pair| [velocity(choices, &pair[0]), velocity(choices, &pair[1])]).collect();
            if choices.once_in(8) {
                let scale = 2f64.powi(choices.whole(100) * choices.pick(&[1, 10]));
                velocity_before.iter_mut().flatten().for_each(|entry| *entry *= scale);
            }
            Matrices::Delassus { delassus: square(&rows), velocity_before }
        };
        Self { matrices, friction, restitution, explain: choices.once_in(2) }
    }

    fn problem(&self) -> Result<ContactProblem, Error> {
        let (friction, restitution) = (self.friction.clone(), self.restitution.clone());
        match &self.matrices {
            Matrices::Delassus { delassus, velocity_before } => {
                ContactProblem::new(delassus.concat(), velocity_before.clone(), friction, restitution)
            }
            Matrices::Dynamics { mass_matrix, contact_jacobian, velocity } => {
                ContactProblem::from_dynamics(mass_matrix, contact_jacobian, velocity, friction, restitution)
            }
        }
    }

    /// As `heelstrike solve` reads it.
    fn json(&self) -> String {
        let mut json = json!(self.matrices);
        let friction = |friction: &Friction| match friction {
            Friction::Finite(mu) => json!(mu),
            Friction::Infinite => json!("infinite"),
        };
        json["friction"] = self.friction.iter().map(friction).collect();
        json["restitution"] = json!(self.restitution);
        json.to_string()
    }

    /// Whether G is positive definite to the last digit; one that was computed is as far as its rank is whole.
    fn is_definite(&self) -> bool {
        let Matrices::Delassus { delassus, .. } = &self.matrices else { return true };
        let Some(mut rest) = rationals(delassus) else { return false };
        for k in 0..rest.len() {
            if rest[k][k] <= RBig::ZERO {
                return false;
            }
            let (above, below) = rest.split_at_mut(k + 1);
            for row in below {
                let factor = &row[k] / &above[k][k];
                row.iter_mut().zip(&above[k]).for_each(|(entry, pivot)| *entry -= &factor * pivot);
            }
        }
        true
    }

    /// G and c- to the last digit of f64; `None` if M is singular.
    fn rounded(&self) -> Option<(Vec<Vec<f64>>, Vec<f64>)> {
        match &self.matrices {
            Matrices::Delassus { delassus, velocity_before } => Some((delassus.clone(), velocity_before.concat())),
            Matrices::Dynamics { mass_matrix, contact_jacobian, velocity } => {
                let jacobian = rationals(contact_jacobian)?;
                let velocity = rationals(std::slice::from_ref(velocity))?.concat();
                let [_, delassus] = rational::delassus(&rationals(mass_matrix)?, &jacobian)?;
                let rounded = |row: &Vec<RBig>| row.iter().map(to_f64).collect();
                Some((delassus.iter().map(rounded).collect(), rounded(&rational::times(&jacobian, &velocity))))
            }
        }
    }
}

/// The same for every contact, or another for each.
fn each<T: Clone>(choices: &mut Choices, count: usize, draw: impl Fn(&mut Choices) -> T) -> Vec<T> {
    if choices.once_in(3) {
        return vec![draw(choices); count];
    }
    (0..count).map(|_| draw(choices)).collect()
}

fn rationals(rows: &[Vec<f64>]) -> Option<rational::Matrix> {
    rows.iter().map(|row| row.iter().map(|&entry| RBig::try_from(entry).ok()).collect()).collect()
}

fn check(bytes: &[u8]) -> bool {
    let case = Case::new(&mut Choices::new(bytes));
    let json = case.json();
    watched(&json, || answer(&case, &json))
}

thread_local! {
    static KEPT: RefCell<Scratch> = RefCell::default();
}

fn answer(case: &Case, json: &str) -> bool {
    let Some(problem) = accepted(case.problem(), json) else { return false };
    let contacts = problem.contacts();
    let Some(analysis) = accepted(analyze(&problem, case.explain.into()), json) else { return false };
    check_analysis(&analysis, contacts, json);
    let kept = keeps_index_theorem(&analysis, contacts) || open::is_far(json) || !case.is_definite();
    assert!(kept, "the indices do not sum to 1: {analysis:?}\n{json}");
    let asked = AnalysisOptions { rejections: case.explain.into(), ..AnalysisOptions::default() };
    let again = KEPT.with_borrow_mut(|kept| kept.analyze(&problem, &problem, asked));
    let same = again.as_ref().is_ok_and(|again| format!("{again:?}") == format!("{analysis:?}"));
    assert!(same, "reused memory gives another answer: {again:?}\n{analysis:?}\n{json}");
    if let Some((delassus, before)) = case.rounded()
        && !open::is_far(json)
    {
        for outcome in &analysis.outcomes {
            check_laws(case, &delassus, &before, outcome, json);
        }
    }
    let names = (0..contacts).map(|contact| format!("contact/{contact}")).collect();
    let mut line = Vec::new();
    Report::of_problem(&Problem { id: None, names, contact: problem }, &analysis, ALL).append_json(ALL, &mut line);
    check_json(&line, json);
    true
}

/// What rounding may make of an outcome, in the problem's own scale.
const ROUNDING: f64 = 1e-11;

/// Newton's equations, Signorini's complementarity and Coulomb's law of an outcome, by its numbers alone.
fn check_laws(case: &Case, delassus: &[Vec<f64>], before: &[f64], outcome: &Outcome, json: &str) {
    let context = || format!("{outcome:?}\n{json}");
    let rounding = match case.matrices {
        Matrices::Delassus { .. } if outcome.impulse_unique => ROUNDING,
        Matrices::Delassus { .. } => open::ROUNDING_OF_LEAST_IMPULSES,
        Matrices::Dynamics { .. } => open::ROUNDING_OF_DYNAMICS,
    };
    let (l, after) = (outcome.impulse.concat(), outcome.velocity_after.concat());
    let rows = 0..l.len();
    let mobility: Vec<f64> = rows.clone().map(|i| delassus[i][i].sqrt()).collect();
    let flow = |i: usize| delassus[i].iter().zip(&l).map(|(g, l)| g * l);
    let size = |i: usize| before[i].abs() + after[i].abs() + flow(i).map(f64::abs).sum::<f64>();
    let energy = |i: usize| if mobility[i] > 0.0 { size(i) / mobility[i] } else { 0.0 };
    let scale = rows.clone().map(energy).fold(0.0, f64::max);
    // Below the least normal number digits are lost, of impulses as well as of velocities.
    let lost = |i: usize| 4.0 * f64::MIN_POSITIVE * (1.0 + delassus[i].iter().map(|g| g.abs()).sum::<f64>());
    let speed = |i: usize| rounding * (scale * mobility[i]).max(before[i].abs()) + lost(i);
    let largest = rows.clone().map(|i| l[i].abs() * mobility[i]).fold(0.0, f64::max);
    let most = l.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
    let push = |i: usize| {
        let impulse = if mobility[i] > 0.0 { largest / mobility[i] } else { most };
        rounding * impulse + 4.0 * f64::MIN_POSITIVE
    };
    for i in rows {
        let error = (before[i] + flow(i).sum::<f64>() - after[i]).abs();
        assert!(error <= speed(i) || !size(i).is_finite(), "row {i} is off by {error:e}: {}", context());
    }
    if !outcome.decided {
        return;
    }
    for (contact, (&mode, &friction)) in outcome.modes.iter().zip(&case.friction).enumerate() {
        let (t, n) = (2 * contact, 2 * contact + 1);
        let xi = after[n] + case.restitution[contact] * before[n].min(0.0);
        let place = || format!("contact {contact}: {}", context());
        assert!(xi >= -speed(n) && l[n] >= -push(n), "{}", place());
        match mode {
            Mode::Separate => assert_eq!([l[t], l[n]], [0.0; 2], "{}", place()),
            Mode::Stick => assert!(xi <= speed(n) && after[t] == 0.0, "{}", place()),
            Mode::SlidePlus | Mode::SlideMinus => {
                let forward = mode.direction();
                assert!(xi <= speed(n) && forward * after[t] >= 0.0 && forward * l[t] <= push(t), "{}", place());
            }
        }
        match friction {
            Friction::Finite(mu) => {
                let slack = push(t) + mu * push(n);
                assert!(l[t].abs() <= mu * l[n] + slack, "outside its cone: {}", place());
                assert!(!mode.slides() || l[t].abs() >= mu * l[n] - slack, "slips early: {}", place());
            }
            Friction::Infinite => assert!(!mode.slides() || l[n].abs() <= push(n), "slips under load: {}", place()),
        }
    }
    let work: f64 = (0..l.len()).map(|i| -0.5 * l[i] * (before[i] + after[i])).sum();
    let size: f64 = (0..l.len()).map(|i| (l[i] * before[i]).abs() + (l[i] * after[i]).abs()).sum();
    let error = (outcome.energy_loss - work).abs();
    assert!(error <= 1e-12 * size + f64::MIN_POSITIVE || !size.is_finite(), "{work} is lost: {}", context());
}
