//! From a point in the space of parameters to the impact or the forces there.

use super::Study;
use super::regime::Regime;
use crate::budget::is_spent;
use crate::description::Description;
use crate::impact::{Analysis, Inequalities, InequalityScratch, Verdict};
use crate::law::Mode;
use crate::pipeline::{Aspect, Impact, Options, Pipeline, Touching, Unsolved};
use crate::robot::Reduction;
use crate::state::{Defaults, Scene, State};
use crate::{Error, Reason, Result, Robot};
use std::borrow::Cow;
use std::collections::VecDeque;
use std::sync::Arc;

/// A study of one robot.
#[derive(Debug, Clone)]
pub struct RobotStudy<'a> {
    /// The study: the parameters and the states.
    pub study: &'a Study<'a>,
    /// The robot's file. The study may vary its masses and lengths.
    pub description: &'a Description,
    /// How the robot is reduced to its plane.
    pub reduction: &'a Reduction,
    /// The robot as described by the file.
    pub robot: &'a Robot,
    /// Settings of the pipeline.
    pub options: Options,
    /// Values for states that do not give their own.
    pub defaults: Defaults,
}

/// Answers points of one study, in reused memory.
#[derive(Debug)]
pub struct Solver<'a> {
    pub(super) model: &'a RobotStudy<'a>,
    /// The pipeline for the robot of the file; `None` if the study varies the robot.
    pipeline: Option<Pipeline<'a>>,
    scratch: InequalityScratch,
    /// All regimes that were found so far.
    known: Vec<Arc<Regime>>,
    /// The quantities at the points that were evaluated last, because neighboring stretches share their ends.
    recent: VecDeque<(Vec<f64>, Option<Arc<Watched>>)>,
}

/// The quantities that are followed from point to point.
#[derive(Debug, Clone, PartialEq)]
pub struct Watched {
    /// Names of the closed contacts.
    pub contacts: Vec<String>,
    /// The inequalities of all combinations; empty if there are too many contacts.
    pub inequalities: Inequalities,
    /// Height of each foot above the contact tolerance \[m\].
    pub clearance: Vec<f64>,
    /// What touches at each contact, which its name does not show; empty for a map.
    pub touching: Vec<Touching>,
}

/// Properties of a region, from a point in it.
#[derive(Debug, Clone)]
pub(super) struct Inner {
    pub dependent: bool,
    pub verdict: Option<Verdict>,
    pub refused: Option<Error>,
}

/// The greatest number of contacts whose inequalities are followed: they have 4^n combinations.
pub const WATCHED_CONTACTS: usize = 4;

/// The note on a study whose state has an uncertainty.
const BOXES: &str = "the regions are those of the states as given: whether these hold within their uncertainty, the \
                     samples of JSON and tables say";

/// Returns the subject of a sentence, or the sentence without its numbers.
fn subject(sentence: &str) -> Vec<&str> {
    if let Some((subject, _)) = sentence.split_once(" = ") {
        return vec![subject];
    }
    let is_number = |word: &str| word.trim_matches([',', ';', ':', '"', '(', ')']).parse::<f64>().is_ok();
    sentence.split(' ').filter(|word| !is_number(word)).collect()
}

/// Number of points that are remembered: the nodes of an interval, of its halves and of its quarters.
const RECENT: usize = 17;

impl RobotStudy<'_> {
    /// Describes oddities of the states in the middle and at the ends of the ranges. Sentences that differ only in
    /// their numbers are listed once.
    pub(super) fn oddities(&self) -> Vec<String> {
        let mut solver = Solver::new(self);
        let mut found: Vec<String> = Vec::new();
        // Three places along each parameter.
        for at in 0..3_usize.pow(self.study.parameters().len() as u32) {
            let point = self.point(|index| 0.5 * (at / 3_usize.pow(index as u32) % 3) as f64);
            let odd = solver.at(&point, |robot, state, _| {
                let mut odd = state.oddities(robot);
                odd.extend(state.uncertainty.is_some().then(|| BOXES.to_owned()));
                // Cautions about a varied robot.
                let is_new = |caution: &&String| {
                    self.robot.reading.cautions.iter().all(|known| subject(known) != subject(caution))
                };
                odd.extend(robot.reading.cautions.iter().filter(is_new).cloned());
                Ok(odd)
            });
            // If a state is refused, its region gives the reason.
            for sentence in odd.unwrap_or_default() {
                if !found.iter().any(|known| subject(known) == subject(&sentence)) {
                    found.push(sentence);
                }
            }
        }
        found
    }

    /// Notes that the parameter of a study without borders affects neither the reduced robot nor the state nor its
    /// contact problem at some places, so that the impact seems not to depend on it.
    pub(super) fn idle_parameter(&self) -> Option<String> {
        let [parameter] = self.study.parameters() else { return None };
        if self.study.question() == Aspect::Forces || !self.study.unused().is_empty() {
            return None;
        }
        let mut solver = Solver::new(self);
        // The spacing is uneven, so that no long period fits it.
        let mut seen = [0.0, 0.271, 0.618, 1.0].map(|part| {
            let seen = solver.at(&self.point(|_| part), |robot, state, pipeline| {
                let Unsolved { contacts, problem, .. } = pipeline.unsolved(&state)?;
                let names: Vec<_> = contacts.into_iter().map(|contact| contact.name).collect();
                let Scene { rotor_inertia, impulses, .. } = state.scene;
                let reduced = (robot.bodies.clone(), robot.joints.clone());
                let scene = (state.uncertainty, rotor_inertia, impulses);
                Ok((reduced, state.position, state.velocity, scene, names, problem))
            });
            seen.ok().filter(|(.., names, _)| !names.is_empty())
        });
        let first = seen[0].take()?;
        let is_idle = seen[1..].iter().all(|other| other.as_ref() == Some(&first));
        is_idle.then(|| format!("nothing was found that depends on {}: has it an effect on an impact?", parameter.name))
    }

    /// Returns the point at a part of the range of each parameter, from 0 to 1.
    pub(super) fn point(&self, part: impl Fn(usize) -> f64) -> Vec<f64> {
        let parameters = self.study.parameters().iter().enumerate();
        parameters.map(|(index, parameter)| parameter.from + part(index) * parameter.range()).collect()
    }

    /// Returns the options for the question of the study.
    fn asked(&self) -> Options {
        Options { aspect: self.study.question(), ..self.options.clone() }
    }

    /// Returns whether the state has friction of its own, so that the one of `defaults` does not apply. Returns the
    /// error of the first sample if robot or state cannot be read there, in the middle and at the last sample.
    pub fn has_own_friction(&self) -> Result<bool> {
        let given = self.defaults.friction;
        self.readable(|state| state.scene.has_own_friction(given))
    }

    /// Returns whether the state names its contacts, so that the feet of the options are not used. Returns the same
    /// error as [`Self::has_own_friction`].
    pub fn has_own_contacts(&self) -> Result<bool> {
        self.readable(|state| state.scene.contacts.is_some() && !self.options.feet.is_empty())
    }

    fn readable(&self, holds: impl Fn(State) -> bool) -> Result<bool> {
        let mut solver = Solver::new(self);
        let mut read = |part: f64| solver.at(&self.point(|_| part), |_, state, _| Ok(holds(state)));
        read(0.0).or_else(|first| read(0.5).or_else(|_| read(1.0)).map_err(|_| first))
    }
}

impl<'a> Solver<'a> {
    /// Creates a solver without any answers.
    pub fn new(model: &'a RobotStudy<'a>) -> Self {
        let pipeline = (!model.study.varies_the_robot()).then(|| Pipeline::new(model.robot, model.asked()));
        let scratch = InequalityScratch::default();
        Self { model, pipeline, scratch, known: Vec::new(), recent: VecDeque::new() }
    }

    /// Asks about the state at a point. The robot or the state may be refused; every state is once a budget is spent.
    pub fn at<T>(
        &mut self,
        point: &[f64],
        ask: impl for<'p> FnOnce(&'p Robot, State, &mut Pipeline<'p>) -> Result<T>,
    ) -> Result<T> {
        let RobotStudy { study, description, reduction, robot, defaults, .. } = self.model;
        if is_spent() {
            return Err(Reason::BeyondBudget.into());
        }
        let names = study.names(point);
        if let Some(pipeline) = &mut self.pipeline {
            return ask(robot, study.state(&names, robot, defaults)?, pipeline);
        }
        let description: Cow<Description> = study.describe(&names, description)?;
        let robot = Robot::reduce(&description, reduction)?;
        let state = study.state(&names, &robot, defaults)?;
        ask(&robot, state, &mut Pipeline::new(&robot, self.model.asked()))
    }

    /// Returns the answer at a point, and ignores the state's uncertainty.
    pub fn answer(&mut self, point: &[f64]) -> Result<Box<Impact>> {
        self.at(point, |_, state, pipeline| pipeline.answer(&State { uncertainty: None, ..state }))
    }

    /// Returns the names of the contacts and the analysis at a point, with the rejected combinations of these `modes`.
    pub fn explained(&mut self, point: &[f64], modes: &[Vec<Mode>]) -> Result<(Vec<String>, Analysis)> {
        let impact = self.at(point, |_, state, pipeline| pipeline.answer_explaining(&state, modes))?;
        let names = impact.contacts.iter().map(|contact| contact.name.to_string()).collect();
        Ok((names, impact.into_analysis()?))
    }

    /// Returns properties of a region, found at a point in it. Its verdict is "no impact" only if nothing strikes at
    /// the `others`, too: contacts that slide on without an impulse have the same modes as those that strike.
    pub(super) fn inner(&mut self, point: &[f64], mut others: impl Iterator<Item = Vec<f64>>) -> Inner {
        let inner = self.inner_at(point);
        if inner.verdict != Some(Verdict::NoImpact) {
            return inner;
        }
        let strikes = |point: &Vec<f64>| {
            let found = self.at(point, |_, state, pipeline| Ok(pipeline.outcomes(&state)?.analyzed()?.verdict));
            found.is_ok_and(|verdict| verdict != Verdict::NoImpact)
        };
        others.find(strikes).map_or(inner, |point| self.inner_at(&point))
    }

    fn inner_at(&mut self, point: &[f64]) -> Inner {
        match self.explained(point, &[]) {
            Ok((contacts, Analysis { rank, verdict, .. })) => {
                let dependent = rank.is_some_and(|rank| rank < 2 * contacts.len());
                Inner { dependent, verdict: Some(verdict), refused: None }
            }
            Err(refused) => Inner { dependent: false, verdict: None, refused: Some(refused) },
        }
    }

    /// Returns the regime of a point.
    pub fn regime(&mut self, point: &[f64]) -> Arc<Regime> {
        let found = self.at(point, |_, state, pipeline| {
            let answer = pipeline.outcomes(&state);
            let regime = Regime::of(&answer);
            answer.into_iter().for_each(|impact| pipeline.recycle(impact));
            Ok(regime)
        });
        let regime = found.unwrap_or_else(|refused| Regime::of(&Err(refused)));
        if let Some(known) = self.known.iter().find(|known| ***known == regime) {
            return Arc::clone(known);
        }
        self.known.push(Arc::new(regime));
        Arc::clone(&self.known[self.known.len() - 1])
    }

    /// Returns the quantities that are followed; `None` if the point is refused.
    pub fn watched(&mut self, point: &[f64]) -> Option<Arc<Watched>> {
        if let Some((_, known)) = self.recent.iter().find(|(known, _)| known == point) {
            return known.clone();
        }
        let found = self.find_watched(point).map(Arc::new);
        self.recent.truncate(RECENT - 1);
        self.recent.push_front((point.to_vec(), found.clone()));
        found
    }

    fn find_watched(&mut self, point: &[f64]) -> Option<Watched> {
        let unsolved = self.at(point, |_, state, pipeline| Ok((pipeline.unsolved(&state)?, pipeline.tolerance())));
        let (unsolved, tolerance) = unsolved.ok()?;
        let inequalities = match unsolved.contacts.len() <= WATCHED_CONTACTS {
            true => Inequalities::of(&unsolved.problem, unsolved.errors(), &mut self.scratch),
            false => Inequalities::default(),
        };
        let Unsolved { contacts, clearance, touching, .. } = unsolved;
        Some(Watched {
            inequalities,
            contacts: contacts.into_iter().map(|contact| contact.name.to_string()).collect(),
            clearance: clearance.into_iter().map(|height| height - tolerance).collect(),
            // In a map, the band in which a foot stands on both corners is thinner than the curves that are drawn.
            touching: if self.model.study.parameters().len() == 1 { touching } else { Vec::new() },
        })
    }
}
