//! Finds every outcome of the rigid frictional impact of a planar legged robot.
//!
//! A foot strikes the ground. Most simulators assume that it sticks and return one answer. In some states, no outcome
//! in which the foot sticks exists, and the other foot slides at any friction. In other states, several outcomes are
//! equally valid. This crate reads a robot's URDF and a state just before the impact. It finds all outcomes with their
//! modes, impulses and velocities, and states whether the answer is unique, ambiguous or absent.
//!
//! # Data flow
//!
//! ```text
//!     URDF text --[description]--> links and joints, checked --[robot]--> Robot: planar floating-base tree
//!     JSON state --[read]--------> q, v and Scene (ground, friction, restitution, braked joints, applied impulses)
//!     Robot + braked joints --[dynamics::plan]--> Plan: flat arrays for the hot path
//!     Plan + q --[dynamics]--> poses, mass matrix M, contact Jacobian J, Delassus matrix G = J M^-1 J^T
//!     poses + ground --[contact]--> closed contacts
//!     G, c, friction, restitution --[impact, by law]--> every outcome, verdict
//!     Robot + State --[pipeline]--> Impact --[write, draw]--> JSON, text, picture
//!     CSV, recordings --[read, gait, batch]--> many states, touchdowns --[write]--> NDJSON, CSV
//!     Study of one or two parameters --[sweep]--> regions, borders --[write, draw]--> JSON, CSV, text, picture, page
//! ```
//!
//! The types that most programs need are re-exported below. The documentation of each is in its own module. A module
//! uses only the modules that `docs/architecture.md` lists above it.
//!
//! # The impact
//!
//! ```text
//!     M (v+ - v-) = J^T L          c = J v          c+ = c- + G L        (an applied impulse p adds J_p^T p on the right)
//!     with loops:  K v = 0,  M (v+ - v-) = J^T L + K^T l,  G = J (M^-1 - M^-1 K^T W^-1 K M^-1) J^T,  W = K M^-1 K^T
//! ```
//!
//! | symbol | JSON | meaning | unit |
//! | --- | --- | --- | --- |
//! | q | `position` | x, z, pitch of the root link, then the joints in the file's order | m, rad |
//! | v | `velocity` | dq/dt, entry by entry | m/s, rad/s |
//! | M | `mass_matrix` | joint-space inertia | kg, kg m, kg m^2 |
//! | J | `contact_jacobian` | two rows per contact: tangential, normal | |
//! | G | `delassus` | inverse inertia seen by the contacts | 1/kg |
//! | c | `velocity_before`, `velocity_after` | contact velocity, [tangential, normal] | m/s |
//! | L | `impulse` | contact impulse, [tangential, normal] | N s |
//! | K | `loops` | velocity of a loop's point a against its point b | |
//! | l | `loop_impulse` | impulse on a, opposite on b, in the world's axes | N s |
//! | mu | `friction` | Coulomb coefficient, 0 to infinite | |
//! | e | `restitution` | Newton's coefficient, 0 to 1 | |
//!
//! Each contact separates, sticks, slides along +t or slides along -t. Every consistent combination of these modes is
//! an outcome. The theory is from C. D. Remy, "Ambiguous collision outcomes and sliding with infinite friction in
//! models of legged systems", IJRR 2017, called "the paper" throughout. "Featherstone 2008" is R. Featherstone, *Rigid
//! Body Dynamics Algorithms*.
//!
//! # Frames and signs
//!
//! `x` points forward along the ground, `z` up. `pitch` and the angles of bodies are right-handed about the plane's
//! normal n = up x forward (+y in the x-z plane): a positive pitch dips the nose. Joint coordinates keep the URDF's own
//! sign. A contact's normal points from the ground to the robot. Its tangent t is the normal turned clockwise, which is
//! +x on level ground. The module `planar` is the only place that implements this handedness.
//!
//! # Example
//!
//! ```
//! use heelstrike::{Defaults, Options, Pipeline, Robot, State};
//!
//! # fn main() -> heelstrike::Result<()> {
//! let urdf = r#"<robot name="ball"><link name="ball">
//!     <inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
//!     <collision><geometry><sphere radius="0.5"/></geometry></collision>
//! </link></robot>"#;
//! let robot = Robot::from_urdf(urdf)?;
//! let state = r#"{"position": {"base": {"z": 0.5}}, "velocity": {"base": {"z": -1.0}}, "friction": 0.8}"#;
//! let state = State::from_json(state, &robot, &Defaults::default())?;
//! let impact = Pipeline::new(&robot, Options::default()).impact(&state)?;
//! let outcomes = impact.into_analysis()?.outcomes;
//! assert_eq!(outcomes.len(), 1);
//! assert_eq!(outcomes[0].impulse, [[0.0, 2.0]]);
//! # Ok(())
//! # }
//! ```

#[doc = include_str!("../docs/guarantees.md")]
pub mod guarantees {}

#[doc = include_str!("../docs/reductions.md")]
pub mod left_out {}

pub mod error;
pub mod budget;
pub mod scalar;
pub mod planar;
pub mod law;
pub mod reductions;
pub mod description;
pub mod robot;
pub mod state;
pub mod dynamics;
pub mod contact;
pub mod impact;
pub mod pipeline;
pub mod gait;
pub mod read;
pub mod sweep;
#[cfg(feature = "accuracy")]
pub mod accuracy;
pub mod write;
pub mod draw;
pub mod batch;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;

pub use budget::Budget;
pub use contact::Contact;
pub use description::Description;
pub use error::{Error, Reason, Result};
pub use impact::{Analysis, ContactProblem, Outcome, Rejection, Verdict, analyze};
pub use law::{Friction, Inequality, Mode};
pub use pipeline::{Impact, Options, Pipeline};
pub use read::Study;
pub use robot::Robot;
pub use state::{Defaults, Ground, Scene, State};
pub use sweep::Survey;
pub use write::{Detail, Inspection, Report};
