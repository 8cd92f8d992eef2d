//! The result of a state in sustained contact: a [`Report`] with forces and accelerations under their own names.

use super::result::{ContactRecord, ErrorObject, LeftOutRecord, NearestRecord, Rejected, Report};
use crate::Mode;
use crate::impact::{Border, Family, OpenCombinations, Outcome, Range, Verdict};
use crate::pipeline::{SpringForce, Unrealized};
use crate::planar::{Pair, Vector};
use crate::read::table::CarriedValue;
use crate::state::Named;
use serde::Serialize;
use serde_json::Value;
use std::cmp::Ordering;

impl Report<'_> {
    /// Returns the result under the names of forces; `None` if it is that of an impact.
    pub fn forces<'s>(&'s self) -> Option<ForcesRecord<'s>> {
        let (sustained, free) = self.sustained?;
        let contacts = self.contacts.iter().zip(&sustained.slips).zip(free);
        let outcomes = |all: &'s [Outcome]| all.iter().map(ForceOutcome::of).collect();
        let rejected = self.rejected.as_ref().map(|all| all.iter().map(RejectedForces::of).collect());
        Some(ForcesRecord {
            id: self.id.as_deref(),
            line: self.line,
            verdict: self.verdict,
            proven: self.proven,
            contacts: contacts.map(|((contact, &slip), &free)| SustainedContact::of(contact, slip, free)).collect(),
            nearest: self.nearest.as_ref(),
            outcomes: self.outcomes.as_deref().map(outcomes),
            shock: (self.verdict == Some(Verdict::None)).then_some(sustained.shock.as_deref()),
            open: self.open,
            families: &self.families,
            rejected,
            gravity: sustained.gravity,
            torque: &sustained.driven.torque,
            springs: &sustained.driven.springs,
            unrealized: sustained.driven.unrealized,
            kinetic_energy: self.kinetic_energy,
            condition: self.condition,
            rank: self.rank,
            left_out: self.left_out.as_deref(),
            notes: &self.notes,
            coordinates: self.coordinates.as_deref(),
            mass_matrix: self.mass_matrix.as_deref(),
            contact_jacobian: self.contact_jacobian.as_deref(),
            delassus: self.delassus.as_deref(),
            carried: self.carried.as_ref(),
            error: self.error.as_ref(),
        })
    }
}

/// The result of a state in sustained contact.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "Forces")]
pub struct ForcesRecord<'a> {
    /// The user's name for the input.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::result::Id>"))]
    pub id: Option<&'a Value>,
    /// The line on which the input begins, from 1; present in a batch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// The answer in one word; absent if there is an `error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// Whether error bounds decide every combination; absent if there is an `error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proven: Option<bool>,
    /// The contacts that take part, in the order of all lists per contact.
    pub contacts: Vec<SustainedContact<'a>>,
    /// The lowest foot that does not touch; absent if every foot touches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest: Option<&'a NearestRecord<'a>>,
    /// Every outcome; absent if there is an `error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outcomes: Option<Vec<ForceOutcome<'a>>>,
    /// With the verdict `none`, the outcomes of the impact without approach by which the velocities jump; null if these
    /// are not decided.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-may-be-null" = true)))]
    pub shock: Option<Option<&'a [Outcome]>>,
    /// What an undecided state leaves open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open: Option<OpenCombinations>,
    /// Lists of modes with many accelerations, all of which are outcomes; absent if there are none.
    #[serde(skip_serializing_if = "<[Family]>::is_empty")]
    pub families: &'a [Family],
    /// Every other combination, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rejected: Option<Vec<RejectedForces<'a>>>,
    /// Gravity along -z of the world \[m/s^2\].
    pub gravity: f64,
    /// Torque or force at each joint, virtual springs included \[N m, N\].
    pub torque: &'a Named,
    /// The loads that the virtual springs require, in the order of the state; absent without springs.
    #[serde(rename = "virtual", skip_serializing_if = "<[SpringForce]>::is_empty")]
    pub springs: &'a [SpringForce],
    /// The springs' load on a floating base, which no joint can supply and is not applied; absent without springs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unrealized: Option<Unrealized>,
    /// Kinetic energy \[J\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kinetic_energy: Option<f64>,
    /// Condition number of the Delassus matrix scaled to a unit diagonal; null if it is singular.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-may-be-null" = true)))]
    pub condition: Option<Option<f64>>,
    /// Rank of the Delassus matrix.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
    /// Parts of the robot's file and of the scene that do not enter the analysis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<&'a [LeftOutRecord<'a>]>,
    /// Notes for the reader, in whole sentences.
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    pub notes: &'a [String],
    /// Names of the kept coordinates in the order of q, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<&'a [String]>,
    /// M, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_matrix: Option<&'a [Vec<f64>]>,
    /// J, rows tangential and normal per contact, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_jacobian: Option<&'a [Vec<f64>]>,
    /// G = J M^-1 J^T under the loop constraints, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delassus: Option<&'a [Vec<f64>]>,
    /// Columns of the input table that are copied unchanged.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<std::collections::BTreeMap<String, serde_json::Value>>"))]
    pub carried: Option<&'a Named<CarriedValue>>,
    /// The reason why there are no outcomes although the matrices are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<&'a ErrorObject>,
}

/// A contact that takes part.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SustainedContact<'a> {
    /// The URDF link that carries the shape.
    pub link: Option<&'a str>,
    /// Its name: that of its link, or link/0, link/1 ... if the link has several (link//0 if others are called link/0).
    pub name: &'a str,
    /// The contact point in the world \[m\].
    pub point: Option<Vector<f64>>,
    /// Unit normal of the ground, toward the robot.
    pub normal: Option<Vector<f64>>,
    /// Height above the ground along the normal \[m\].
    pub gap: Option<f64>,
    /// Its velocity, [tangential, normal] \[m/s\].
    pub velocity: Pair<f64>,
    /// "+" or "-" for a contact that slides along or against t; null for one at rest.
    pub slip: Option<&'static str>,
    /// Its acceleration without contact forces, [tangential, normal] \[m/s^2\].
    pub acceleration_free: Pair<f64>,
}

impl<'a> SustainedContact<'a> {
    fn of(contact: &'a ContactRecord, slip: Ordering, acceleration_free: Pair<f64>) -> Self {
        let &ContactRecord { ref link, ref name, point, normal, gap, velocity_before } = contact;
        Self {
            link: link.as_deref(),
            name,
            point,
            normal,
            gap,
            velocity: velocity_before,
            slip: match slip {
                Ordering::Less => Some("-"),
                Ordering::Equal => None,
                Ordering::Greater => Some("+"),
            },
            acceleration_free,
        }
    }
}

/// A consistent combination of modes.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForceOutcome<'a> {
    /// One mode per contact. If a contact already slides, `slide+` or `slide-` means that it keeps sliding.
    pub modes: &'a [Mode],
    /// Contact forces, [tangential, normal] per contact \[N\].
    pub force: &'a [Pair<f64>],
    /// Contact accelerations, [tangential, normal] per contact \[m/s^2\].
    pub contact_acceleration: &'a [Pair<f64>],
    /// Acceleration of the base \[m/s^2, rad/s^2\]; absent if the robot is bolted to the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_acceleration: Option<&'a Named>,
    /// Accelerations of the joints, braked ones included \[rad/s^2, m/s^2\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_acceleration: Option<&'a Named>,
    /// Force on point a of each loop, [x, z] in the world \[N\]; the opposite acts on b. Absent without loops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loop_force: Option<&'a [Vector]>,
    /// Power of the contact forces \[W\]; negative where friction takes energy.
    pub power: f64,
    /// False if other admissible forces give the same accelerations; `force` then has the least sum of squares.
    pub force_unique: bool,
    /// Least and greatest value of every entry of `force`, null without a bound; present if `force` is not unique.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_range: Option<&'a [Pair<Range>]>,
    /// |f_t| / f_n of each sticking contact that is pressed on the ground, as in an impact; null for others.
    pub friction_needed: &'a [Option<f64>],
    /// Sign of det A; null if it is not defined, as on a border.
    pub index: Option<i8>,
    /// The smallest slack of the outcome's inequalities, free of units; null if there is no inequality.
    pub margin: Option<f64>,
    /// The force inequalities that are exactly zero, and the modes beyond; present on a border.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub border: Option<&'a Border>,
    /// Whether the outcome is a corner of a family; absent if not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub family: bool,
    /// Whether error bounds show every sign, and every force and contact acceleration is right to 1e-10 of its scale.
    pub proven: bool,
    /// False if the combination is neither shown nor excluded; absent if true.
    #[serde(skip_serializing_if = "Clone::clone")]
    pub decided: bool,
}

impl<'a> ForceOutcome<'a> {
    fn of(outcome: &'a Outcome) -> Self {
        Self {
            modes: &outcome.modes,
            force: &outcome.impulse,
            contact_acceleration: &outcome.velocity_after,
            base_acceleration: outcome.base_velocity_after.as_ref(),
            joint_acceleration: outcome.joint_velocity_after.as_ref(),
            loop_force: outcome.loop_impulse.as_deref(),
            power: 0.0 - outcome.energy_loss,
            force_unique: outcome.impulse_unique,
            force_range: outcome.impulse_range.as_deref(),
            friction_needed: &outcome.friction_needed,
            index: outcome.index,
            margin: outcome.margin,
            border: outcome.border.as_ref(),
            family: outcome.family,
            proven: outcome.proven,
            decided: outcome.decided,
        }
    }
}

/// A combination of modes that is not an outcome.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RejectedForces<'a> {
    /// One mode per contact.
    pub modes: &'a [Mode],
    /// The reason, with the contact's name.
    pub because: &'a str,
    /// The smallest slack, negative; null if the combination has no solution.
    pub margin: Option<f64>,
    /// The forces that it would have needed \[N\].
    pub force: Option<&'a [Pair<f64>]>,
    /// The contact accelerations that it would have led to \[m/s^2\].
    pub contact_acceleration: Option<&'a [Pair<f64>]>,
}

impl<'a> RejectedForces<'a> {
    fn of(rejected: &'a Rejected) -> Self {
        Self {
            modes: &rejected.modes,
            because: &rejected.because,
            margin: rejected.margin,
            force: rejected.impulse.as_deref(),
            contact_acceleration: rejected.velocity_after.as_deref(),
        }
    }
}
