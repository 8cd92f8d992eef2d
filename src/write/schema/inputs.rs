//! What the readers of states, problems and studies accept, as types that a schema can be derived from.
//!
//! Nothing is read into these types; `tests/command/schema` compares them with the readers field by field.
#![expect(dead_code, reason = "the schemas are all that is wanted of them")]

use super::Id;
use schemars::JsonSchema;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

/// What is varied, and the state and the robot that vary with it.
#[derive(JsonSchema)]
pub(super) struct Study {
    /// One or two parameters by name.
    #[schemars(extend("minProperties" = 1, "maxProperties" = 2, "propertyNames" = {"pattern": NAME}))]
    parameters: BTreeMap<String, Parameter>,
    /// Numbers by name, which may need each other in any order.
    #[schemars(extend("propertyNames" = {"pattern": NAME}))]
    constants: Option<BTreeMap<String, f64>>,
    /// The state.
    state: State,
    /// What of the robot's file is other than there.
    robot: Option<Variation>,
}

/// What an expression can use as a name.
const NAME: &str = "^[A-Za-z_][A-Za-z0-9_]*$";

/// A number that is varied; of parameters it knows nothing, of constants all.
#[derive(JsonSchema)]
struct Parameter {
    /// Its least value.
    from: f64,
    /// Its greatest value.
    to: f64,
    /// How many samples are taken, both ends included.
    #[schemars(range(min = 2, max = 10_000_000))]
    steps: u64,
}

/// Numbers of a robot.
#[derive(JsonSchema)]
struct Variation {
    /// By link.
    links: Option<BTreeMap<String, LinkVariation>>,
    /// By joint.
    joints: Option<BTreeMap<String, JointVariation>>,
}

/// Numbers of a link.
#[derive(JsonSchema)]
struct LinkVariation {
    /// Its mass [kg].
    mass: Option<NotNegative>,
    /// Its CoG in the link's frame [m].
    com: Option<[f64; 3]>,
    /// Its moment of inertia about the CoG and the plane's normal [kg m^2].
    inertia: Option<NotNegative>,
    /// The radius of its round collision shapes [m].
    radius: Option<NotNegative>,
}

/// Numbers of a joint.
#[derive(JsonSchema)]
struct JointVariation {
    /// The place of its frame in the parent's [m].
    origin: Option<[f64; 3]>,
}

/// A state just before the impact; what is left out is 0.
#[derive(JsonSchema)]
pub(super) struct State {
    /// What the user calls it.
    id: Option<Id>,
    /// Where the robot is.
    position: Option<Coordinates>,
    /// How it moves: the derivatives of the position's entries.
    velocity: Option<Coordinates>,
    /// Friction, for all links or by link.
    friction: Option<ByLink<Friction>>,
    /// Newton's restitution, for all links or by link.
    restitution: Option<ByLink<Restitution>>,
    /// The ground.
    ground: Option<Ground>,
    /// The link whose lowest point stands on the ground at x = 0, instead of the base's x and z.
    stance: Option<String>,
    /// Joints that keep their velocity through the impact.
    #[schemars(extend("uniqueItems" = true))]
    held: Option<Vec<String>>,
    /// Inertia of the rotor at each joint [kg m^2].
    rotor_inertia: Option<BTreeMap<String, NotNegative>>,
    /// Contacts named by hand instead of detected.
    contacts: Option<Vec<Contact>>,
    /// Points that stay together, in place of the defaults.
    loops: Option<Vec<Loop>>,
    /// How far the numbers may be off: the result then tells whether the verdict holds.
    uncertainty: Option<Uncertainty>,
    /// Impulses that act on the robot at the impact.
    impulse: Option<Vec<AppliedImpulse>>,
}

/// Half-widths; what is left out is certain.
#[derive(JsonSchema)]
struct Uncertainty {
    /// Of all positions, or by name [m, rad].
    position: Option<HalfWidths>,
    /// Of all velocities, or by name [m/s, rad/s].
    velocity: Option<HalfWidths>,
    /// Of the friction of all links, or by link; infinite friction is certain.
    friction: Option<ByLink<NotNegative>>,
    /// Of the inertia of all rotors, or by joint [kg m^2].
    rotor_inertia: Option<Rotors>,
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
enum HalfWidths {
    Everywhere(NotNegative),
    ByName(NamedHalfWidths),
}

/// Half-widths by name.
#[derive(JsonSchema)]
struct NamedHalfWidths {
    /// Of the root link; with a stance x and z follow from the rest and have none.
    base: Option<BaseHalfWidths>,
    /// By joint [rad or m, and per second].
    joints: Option<BTreeMap<String, NotNegative>>,
}

/// Half-widths of the base.
#[derive(JsonSchema)]
struct BaseHalfWidths {
    /// Forward [m or m/s]; of a position without effect.
    x: Option<NotNegative>,
    /// Up [m or m/s]; of a position without effect.
    z: Option<NotNegative>,
    /// Nose down [rad or rad/s].
    pitch: Option<NotNegative>,
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
enum Rotors {
    Everywhere(NotNegative),
    ByJoint(BTreeMap<String, NotNegative>),
}

/// Coordinates or their derivatives by name.
#[derive(JsonSchema)]
struct Coordinates {
    /// Of the root link; a robot that is bolted to the world has none.
    base: Option<Base>,
    /// By joint [rad or m, and per second].
    joints: Option<BTreeMap<String, f64>>,
}

/// Entries of the base.
#[derive(JsonSchema)]
struct Base {
    /// Forward [m or m/s].
    x: Option<f64>,
    /// Up [m or m/s].
    z: Option<f64>,
    /// Nose down [rad or rad/s].
    pitch: Option<f64>,
}

/// A value for all links, or values by link, with "default" for all others.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "{T}ByLink")]
enum ByLink<T> {
    Everywhere(T),
    ByLink(BTreeMap<String, T>),
}

/// A value for all contacts, or a list with one for each.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "{T}PerContact")]
enum PerContact<T> {
    All(T),
    Each(Vec<T>),
}

/// A coefficient of friction.
#[derive(JsonSchema)]
#[serde(untagged)]
enum Friction {
    Finite(NotNegative),
    Infinite(Infinite),
}

#[derive(JsonSchema)]
#[schemars(inline)]
#[serde(rename_all = "lowercase")]
enum Infinite {
    Infinite,
}

/// A coefficient of restitution.
#[derive(JsonSchema)]
struct Restitution(#[schemars(range(min = 0.0, max = 1.0))] f64);

#[derive(JsonSchema)]
#[schemars(inline)]
struct NotNegative(#[schemars(range(min = 0.0))] f64);

/// The ground: level, a slope, or a profile.
#[derive(JsonSchema)]
#[schemars(extend("not" = {"required": ["slope", "profile"]}))]
struct Ground {
    /// Its slope, uphill toward +x [rad].
    #[schemars(extend("exclusiveMinimum" = -FRAC_PI_2, "exclusiveMaximum" = FRAC_PI_2))]
    slope: Option<f64>,
    /// Points [x, z] of rising x that segments join, solid below, and no ground beyond the ends [m].
    #[schemars(length(min = 2))]
    profile: Option<Vec<[f64; 2]>>,
}

/// A contact named by hand.
#[derive(JsonSchema)]
struct Contact {
    /// Its link.
    link: String,
    /// The point in the link's frame [m].
    offset: Option<[f64; 3]>,
    /// The radius of the circle about the point [m].
    radius: Option<NotNegative>,
}

/// Two points that stay together.
#[derive(JsonSchema)]
struct Loop {
    /// The point on which the loop's impulse acts.
    a: LinkPoint,
    /// The point on which the opposite impulse acts.
    b: LinkPoint,
}

/// A point of a link.
#[derive(JsonSchema)]
struct LinkPoint {
    /// The link.
    link: String,
    /// The point in the link's frame [m].
    offset: Option<[f64; 3]>,
}

/// An applied impulse.
#[derive(JsonSchema)]
struct AppliedImpulse {
    /// The link it acts on.
    link: String,
    /// Its point in the link's frame [m].
    offset: Option<[f64; 3]>,
    /// The impulse, [x, z] in the world [N s].
    vector: [f64; 2],
}

/// A contact problem as matrices: `delassus` and `velocity_before`, or `mass_matrix`, `contact_jacobian` and `velocity`.
/// Other fields are ignored.
#[derive(JsonSchema)]
#[schemars(extend("additionalProperties" = true, "oneOf" = [
    {"required": ["delassus", "velocity_before"], "not": {"required": ["mass_matrix"]}},
    {"required": ["mass_matrix", "contact_jacobian", "velocity"], "not": {"required": ["delassus"]}},
]))]
pub(super) struct Problem {
    /// What the user calls it.
    id: Option<Id>,
    /// G = J M^-1 J^T, two rows and columns per contact: tangential, normal [1/kg].
    delassus: Option<Vec<Vec<f64>>>,
    /// [tangential, normal] per contact [m/s].
    velocity_before: Option<Vec<[f64; 2]>>,
    /// M [kg, kg m, kg m^2].
    mass_matrix: Option<Vec<Vec<f64>>>,
    /// J, two rows per contact: tangential, normal.
    contact_jacobian: Option<Vec<Vec<f64>>>,
    /// v.
    velocity: Option<Vec<f64>>,
    /// Friction, for all contacts or for each.
    friction: Option<PerContact<Friction>>,
    /// Newton's restitution, for all contacts or for each.
    restitution: Option<PerContact<Restitution>>,
    /// A different name for each contact.
    #[schemars(extend("uniqueItems" = true))]
    names: Option<Vec<String>>,
}
