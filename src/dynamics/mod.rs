//! Rigid-body dynamics of the planar tree, generic over the number type [`Real`](crate::scalar::Real).
//!
//! ```text
//!     kinematics --> crba (M) --> ltl (M = L^T D L) ──┐
//!          ├──────── jacobian (J, c = J v) ───────────┴──> delassus (G = J M^-1 J^T), velocity change by impulses
//!          ├──────── bias (b: gravity, velocity products; sigma) ─> accelerations of coordinates and contacts
//!          ├──────── springs ──────────────────────────────> torques that imitate virtual springs
//!          ├──────── loops (K) ──────────────────────────────> G under the loop constraints, loop impulses
//!          └──────── articulated ──> balance (error bounds) ─> G and velocity change without M, for long robots
//! ```
//!
//! Every function reads a [`Plan`](crate::dynamics::plan::Plan) and writes into a [`Workspace`].

pub mod plan;
mod ltl;
mod articulated_inertia;
mod workspace;
mod kinematics;
mod crba;
mod jacobian;
mod delassus;
mod articulated;
mod stretch;
mod balance;
mod bounds;
mod bias;
mod springs;
mod loops;

pub use articulated::{add_articulated_impulse, articulated_acceleration, articulated_delassus, articulated_inertias};
pub use articulated_inertia::ArticulatedInertia;
pub use balance::has_balance;
pub use bias::{bias, demands};
pub use bounds::{Reach, RoundingBounds};
pub use crba::{factorize, mass_diagonal, mass_matrix};
pub use delassus::{PointImpulse, add_impulse, delassus};
pub use jacobian::{ContactPoint, Motion, contact_jacobian, kinetic_energy, point_velocity};
pub use kinematics::kinematics;
pub use loops::{
    Closed, Constraints, Loop, close, eliminate_loops, follow_exactly, independent_rows, loop_impulse, orthogonalize,
    spent_energy,
};
pub use ltl::LtlFactor;
pub use springs::{SpringLoad, SpringPoint};
pub use stretch::Arm;
pub use workspace::{LoopRows, Workspace};

#[cfg(test)]
mod tests {
    //! Each algorithm is compared with an independent one on random branching trees with revolute and prismatic joints.

    use super::jacobian::walk;
    use super::*;
    use crate::dynamics::plan::{Configuration, Plan};
    use crate::planar::{Rotation, Vector};
    use crate::robot::{Axis, Base, Body, Joint, MimicJoint, ParentJoint, Robot};
    use crate::scalar::{Ball, DoubleDouble, Interval, Magnitude, Ordered, Real, Trigonometry};
    use crate::state::SpringLaw;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;
    use proptest::sample::Index;
    use std::cmp::Ordering;
    use std::ops::Range;

    fn point() -> impl Strategy<Value = [f64; 2]> {
        prop::array::uniform2(-1.0..1.0f64)
    }

    prop_compose! {
        fn joint_and_body()(
            parent in any::<Index>(),
            origin in point(),
            slides in prop::bool::weighted(0.2),
            angle in -3.0..3.0f64,
            mass in 0.01..2.0f64,
            com in prop::array::uniform2(-0.5..0.5f64),
            moment in 0.0..0.1f64,
        ) -> (Index, Joint, Body) {
            let axis = match slides {
                true => Axis::Prismatic { direction: Vector::new(angle.cos(), angle.sin()) },
                false => Axis::Revolute { sign: angle.signum() },
            };
            let joint = Joint { name: String::new(), parent: 0, child: 0, origin: origin.into(), axis, limits: None };
            (parent, joint, Body { name: String::new(), joint: None, mass, com: com.into(), moment })
        }
    }

    /// A tree with `joints` joints. With `mimics`, each joint but the first may be a mimic joint. The parent of a body
    /// is one of the `reach` bodies before it: a small `reach` makes long branches.
    fn tree(joints: Range<usize>, reach: usize, mimics: bool) -> impl Strategy<Value = Robot> {
        let ratio = prop::option::weighted(0.25, (any::<Index>(), -2.0..2.0f64, -1.0..1.0f64));
        let parts = prop::collection::vec((joint_and_body(), ratio), joints);
        (parts, prop::bool::weighted(0.2)).prop_map(move |(mut parts, bolted)| {
            parts.iter_mut().enumerate().filter(|(at, _)| *at == 0 || !mimics).for_each(|(_, part)| part.1 = None);
            let moving = parts.iter().filter(|(_, ratio)| ratio.is_none()).count();
            let com = Vector::new(0.1, -0.2);
            let root = Body { name: String::new(), joint: None, mass: 1.0, com, moment: 0.05 };
            let mut robot = Robot {
                name: "tree".into(),
                base: if bolted { Base::Fixed } else { Base::Floating },
                bodies: vec![root],
                joints: Vec::new(),
                links: Vec::new(),
                mimic_joints: Vec::new(),
                left_out: Vec::new(),
                reading: Default::default(),
            };
            for ((place, joint, body), ratio) in parts {
                let child = robot.bodies.len();
                let parent = child - 1 - place.index(child.min(reach));
                let joint = Joint { parent, child, ..joint };
                let joint = match ratio {
                    None => {
                        robot.joints.push(joint);
                        ParentJoint::Joint(robot.joints.len() - 1)
                    }
                    Some((other, multiplier, offset)) => {
                        let mimicked = other.index(moving);
                        robot.mimic_joints.push(MimicJoint { joint, mimicked, multiplier, offset });
                        ParentJoint::Mimic(robot.mimic_joints.len() - 1)
                    }
                };
                robot.bodies.push(Body { joint: Some(joint), ..body });
            }
            robot
        })
    }

    #[derive(Debug, Clone)]
    struct Case {
        robot: Robot,
        position: Vec<f64>,
        velocity: Vec<f64>,
        /// For each contact point: the body, and the point in the body's frame.
        places: Vec<(Index, [f64; 2])>,
    }

    /// A small tree and a state, with all numbers of order one.
    fn case(mimics: bool) -> impl Strategy<Value = Case> {
        case_of(tree(1..8, usize::MAX, mimics))
    }

    fn case_of(robot: impl Strategy<Value = Robot>) -> impl Strategy<Value = Case> {
        robot.prop_flat_map(|robot| {
            let numbers = prop::collection::vec(-3.0..3.0f64, robot.dofs());
            let places = prop::collection::vec((any::<Index>(), point()), 1..4);
            (Just(robot), numbers.clone(), numbers, places).prop_map(|(robot, position, velocity, places)| Case {
                robot,
                position,
                velocity,
                places,
            })
        })
    }

    impl Case {
        fn points<T: Real>(&self, radius: f64, ground: Rotation<T>) -> Vec<ContactPoint<T>> {
            let point = |&(body, center): &(Index, [f64; 2])| ContactPoint {
                body: body.index(self.robot.bodies.len()),
                center: Vector::from(center).map(T::from_f64),
                radius: T::from_f64(radius),
                ground,
            };
            self.places.iter().map(point).collect()
        }

        fn placed<T: Trigonometry>(&self, plan: &Plan<T>) -> Workspace<T> {
            let (mut configuration, mut workspace) = (Configuration::default(), Workspace::default());
            configuration.set(plan, &self.position);
            kinematics(plan, &configuration, &mut workspace);
            workspace
        }

        /// Computes everything up to the Delassus matrix.
        fn computed<T: Trigonometry>(&self, plan: &Plan<T>, points: &[ContactPoint<T>]) -> Workspace<T> {
            let mut workspace = self.placed(plan);
            mass_matrix(plan, &mut workspace);
            factorize(plan, &mut workspace);
            let velocity: Vec<T> = self.velocity.iter().map(|&entry| T::from_f64(entry)).collect();
            contact_jacobian(plan, points, &velocity, None, &mut workspace);
            delassus(plan, &mut workspace);
            workspace
        }

        fn by_bodies<T: Trigonometry>(&self, plan: &Plan<T>, points: &[ContactPoint<T>]) -> Workspace<T> {
            let mut workspace = self.placed(plan);
            articulated_inertias(plan, &mut workspace);
            articulated_delassus(plan, points, &mut workspace);
            workspace
        }

        /// Computes the bounds of `points` except that of the Delassus matrix.
        fn bounds(&self, plan: &Plan, points: &[ContactPoint]) -> RoundingBounds {
            let (mut bounds, mut configuration) = (RoundingBounds::default(), Configuration::default());
            configuration.set(plan, &self.position);
            let length = |point: &ContactPoint| point.center.x.abs() + point.center.z.abs() + point.radius;
            let arms = points.iter().map(|point| Arm { body: point.body, length: length(point) });
            bounds.stretch(plan, &configuration, arms);
            bounds.velocities(plan, &self.velocity, None, |_| false);
            bounds
        }
    }

    /// Returns the largest error of `found` against `exact`, each entry relative to sqrt(G_ii G_jj).
    fn error_of(found: &[f64], exact: &[Interval]) -> f64 {
        let rows = found.len().isqrt();
        let error = |at: usize| {
            let scale = (found[at / rows * (rows + 1)] * found[at % rows * (rows + 1)]).sqrt();
            (exact[at] - Interval::from_f64(found[at])).to_f64().abs() / scale
        };
        (0..found.len()).map(error).fold(0.0, f64::max)
    }

    #[test]
    fn negative_moments_on_fixed_joints_have_no_bound() {
        type Exact = Ball<DoubleDouble>;
        let body = |mass: f64, moment: f64, joint: Option<ParentJoint>| Body {
            name: String::new(),
            joint,
            mass,
            com: Vector::zero(),
            moment,
        };
        let fixed = ParentJoint::Fixed { parent: 0, origin: Vector::zero() };
        let parts = [-0.9999999, 0.2, 0.1].map(|moment| body(1e-3, moment, Some(fixed)));
        let robot = Robot {
            name: "fixed".into(),
            base: Base::Floating,
            bodies: [body(1.0, 0.7, None)].into_iter().chain(parts).collect(),
            joints: Vec::new(),
            links: Vec::new(),
            mimic_joints: Vec::new(),
            left_out: Vec::new(),
            reading: Default::default(),
        };
        fn contact<T: Real>() -> [ContactPoint<T>; 1] {
            let center = Vector::new(0.3, -1.0).map(T::from_f64);
            [ContactPoint { body: 0, center, radius: T::zero(), ground: Rotation::identity() }]
        }
        let case = Case { robot, position: vec![0.0; 3], velocity: vec![0.0; 3], places: Vec::new() };
        let plan = Plan::new(&case.robot, &[], &[]);
        let (workspace, mut bounds) = (case.computed(&plan, &contact()), case.bounds(&plan, &contact()));
        let exact = case.computed::<Exact>(&Plan::new(&case.robot, &[], &[]), &contact());
        bounds.delassus(&plan, &workspace);
        // The moments nearly cancel each other, and with them the digits of their sum.
        let off = exact.delassus[0] - Exact::from_f64(workspace.delassus[0]);
        assert!(off.to_f64().abs() > 1e-11 * workspace.delassus[0] && bounds.delassus == f64::INFINITY, "{off:?}");
    }

    type SpringCase = ([(Index, [f64; 2]); 2], [SpringLaw; 3], bool);

    impl Case {
        /// Returns the loads by column, the accelerations by coordinate and those of the contacts, under gravity and
        /// one spring. If `steady`, all bodies count as not rotating. `solve` replaces the loads by accelerations.
        fn accelerated<T: Real>(
            &self,
            plan: &Plan<T>,
            points: &[ContactPoint<T>],
            mut workspace: Workspace<T>,
            (ends, laws, steady): SpringCase,
            solve: impl FnOnce(&mut [T], &Workspace<T>),
        ) -> (Vec<T>, Vec<T>, Vec<[T; 2]>) {
            let velocity: Vec<T> = self.velocity.iter().map(|&entry| T::from_f64(entry)).collect();
            bias(plan, &velocity, T::from_f64(9.81), &vec![steady; plan.bodies.len()], &mut workspace);
            let end = |(body, point): (Index, [f64; 2])| {
                SpringPoint::Body(body.index(self.robot.bodies.len()), Vector::from(point).map(T::from_f64))
            };
            let spring = (ends.map(end), laws);
            let generalized = SpringLoad::of(spring, plan, &self.position, &velocity, &workspace).generalized;
            let loads = plan.coordinates.iter().zip(&workspace.bias).map(|(&coordinate, &bias)| {
                if coordinate < self.robot.base_dofs() { -bias } else { generalized[coordinate] - bias }
            });
            let loads: Vec<T> = loads.collect();
            let mut column = loads.clone();
            solve(&mut column, &workspace);
            let mut acceleration = vec![T::zero(); velocity.len()];
            plan.coordinates.iter().zip(&column).for_each(|(&coordinate, &entry)| acceleration[coordinate] = entry);
            let of_contact = |point: &ContactPoint<T>| {
                let total = point_velocity(plan, point.body, point.arm(&workspace), &acceleration, &workspace);
                point.axes().map(|axis| axis.dot(total + point.drift(&workspace)))
            };
            let contacts = points.iter().map(of_contact).collect();
            (loads, acceleration, contacts)
        }
    }

    fn dense(plan: &Plan, lower: &[f64]) -> DMatrix<f64> {
        let nv = plan.columns();
        DMatrix::from_fn(nv, nv, |i, j| lower[i.max(j) * nv + i.min(j)])
    }

    /// v in the order of the plan's columns.
    fn by_column(plan: &Plan, v: &[f64]) -> DVector<f64> {
        DVector::from_iterator(plan.columns(), plan.coordinates.iter().map(|&coordinate| v[coordinate]))
    }

    proptest! {
        #[test]
        fn mass_matrix_gives_bodies_kinetic_energy(case in case(true)) {
            let plan = Plan::new(&case.robot, &[], &vec![0.25; case.robot.joints.len()]);
            let workspace = case.computed(&plan, &[]);
            let column = by_column(&plan, &case.velocity);
            let by_matrix = 0.5 * column.dot(&(dense(&plan, &workspace.mass_matrix) * &column));
            let by_bodies = kinetic_energy(&plan, &case.velocity, &workspace, &mut Vec::new());
            let factor = &workspace.factor;
            let lower = DMatrix::from_fn(plan.columns(), plan.columns(), |row, column| match row.cmp(&column) {
                Ordering::Greater => factor.row(row)[column],
                Ordering::Equal => 1.0,
                Ordering::Less => 0.0,
            });
            let diagonal = DMatrix::from_diagonal(&DVector::from_fn(plan.columns(), |k, _| factor.pivot(k)));
            let mass = dense(&plan, &workspace.mass_matrix);
            let product = lower.transpose() * diagonal * lower;
            prop_assert!((&product - &mass).amax() <= 1e3 * f64::EPSILON * mass.amax(), "{product} {mass}");
            // Both are sums of some hundred terms as large as the energy.
            prop_assert!((by_matrix - by_bodies).abs() <= 1e3 * f64::EPSILON * by_bodies.max(1.0), "{by_matrix} {by_bodies}");
        }

        #[test]
        fn delassus_is_the_answer_to_unit_impulses(case in case(true), slope in -1.0..1.0f64) {
            let (plan, contacts) = (Plan::new(&case.robot, &[], &[]), case.points(0.1, Rotation::by(-slope)));
            let workspace = case.computed(&plan, &contacts);
            let (nv, rows) = (plan.columns(), 2 * contacts.len());
            let jacobian = DMatrix::from_row_iterator(rows, nv, (0..rows).flat_map(|row| workspace.jacobian_row(row)));
            let mass = dense(&plan, &workspace.mass_matrix);
            let inverse = mass.clone().cholesky().expect("positive definite").inverse();
            let by_matrices = &jacobian * &inverse * jacobian.transpose();
            let found = DMatrix::from_row_slice(rows, rows, &workspace.delassus);
            let values = mass.symmetric_eigenvalues();
            // The error of the dense inverse grows with the condition number of M.
            let tolerance = 1e2 * f64::EPSILON * (values.max() / values.min()) * by_matrices.amax().max(1.0);
            prop_assert!((&found - &by_matrices).amax() <= tolerance, "{found} {by_matrices}");
            let speeds = &jacobian * by_column(&plan, &case.velocity);
            for (row, speed) in speeds.iter().enumerate() {
                let contact = contacts[row / 2];
                let (axis, arm) = (contact.axes()[row % 2], contact.arm(&workspace));
                let mut change = vec![0.0; case.velocity.len()];
                let impulse = PointImpulse { body: contact.body, arm, vector: axis };
                add_impulse(&plan, &workspace, impulse, &mut Vec::new(), &mut change);
                let at = point_velocity(&plan, contact.body, arm, &change, &workspace);
                prop_assert!((axis.dot(at) - found[(row, row)]).abs() <= tolerance);
                // A sum of at most eleven products of order ten.
                prop_assert!((speed - workspace.contact_velocity[row / 2][row % 2]).abs() < 1e4 * f64::EPSILON);
            }
        }

        #[test]
        fn bias_moves_no_coordinate(case in case(true), gravity in 0.0..20.0f64) {
            type Exact = Ball<DoubleDouble>;
            let plan = Plan::new(&case.robot, &[], &[]);
            let mut workspace = case.computed(&plan, &[]);
            bias(&plan, &case.velocity, gravity, &[], &mut workspace);
            // Positions along q + v t at three times close together; their second difference gives the accelerations of
            // points.
            let exact_plan = Plan::<Exact>::new(&case.robot, &[], &[]);
            let step = f64::exp2(-27.0);
            let places = |time: f64| {
                let (mut configuration, mut workspace) = (Configuration::default(), Workspace::default());
                configuration.set(&exact_plan, &case.position);
                for body in exact_plan.bodies.iter().filter(|body| plan.floating || body.parent.is_some()) {
                    let rate = case.velocity.get(body.coordinate).copied().unwrap_or(0.0);
                    let shift = time * rate * body.mimic.map_or(1.0, |mimic| mimic.multiplier);
                    configuration.turns[body.place] = configuration.turns[body.place].then(Rotation::by(shift));
                    configuration.displacement[body.place] = configuration.displacement[body.place] + Exact::from_f64(shift);
                }
                kinematics(&exact_plan, &configuration, &mut workspace);
                workspace
            };
            let ways = [-step, 0.0, step].map(places);
            let accelerated = |index: usize, local: Vector<f64>| {
                let [before, at, after] = [0, 1, 2].map(|way: usize| {
                    let arms = exact_plan.way_to_root(index).map(|(body, _)| ways[way].arm[body]);
                    arms.fold(ways[way].rotation[index].apply(local.map(Exact::from_f64)), |sum, arm| sum + arm)
                });
                let second = |entry: Exact| entry.to_f64() / (step * step);
                (before - at + after - at).map(second)
            };
            // The difference has terms of order v^2 of a few hundred each. Its error is of order v^4 step^2.
            let tolerance = 1e-9;
            let mut forces = vec![0.0; plan.columns()];
            for (index, body) in case.robot.bodies.iter().enumerate() {
                let com = accelerated(index, body.com);
                let point = ContactPoint { body: index, center: body.com, radius: 0.5, ground: Rotation::identity() };
                let off = point.drift(&workspace) - com;
                prop_assert!(off.length() < tolerance * com.length().max(1.0), "{off:?} {com:?}");
                let arm = workspace.rotation[index].apply(body.com);
                walk(&plan, index, arm, &case.velocity, &workspace, |column, unit| {
                    forces[column] += body.mass * unit.dot(com + Vector::new(0.0, gravity));
                });
            }
            for (found, expected) in workspace.bias.iter().zip(&forces) {
                prop_assert!((found - expected).abs() < 1e2 * tolerance * expected.abs().max(1.0), "{found} {expected}");
            }
        }

        #[test]
        fn articulated_bodies_give_delassus(
            mut case in case(false),
            massless in any::<Index>(),
            braked in prop::option::weighted(0.3, any::<Index>()),
            rotor in prop_oneof![Just(0.0), 0.01..1.0f64],
            impulse in point(),
        ) {
            // A link between revolute joints may be massless.
            let massless = massless.index(case.robot.bodies.len());
            let beside = |joint: &&Joint| joint.parent == massless || joint.child == massless;
            let mut beside = case.robot.joints.iter().filter(beside);
            let revolute = |joint: &Joint| joint.axis.is_revolute();
            if massless > 0 && beside.clone().count() > 1 && beside.all(revolute) {
                let body = &mut case.robot.bodies[massless];
                (body.mass, body.moment) = (0.0, 0.0);
            }
            let braked: Vec<usize> = braked.iter().map(|braked| braked.index(case.robot.joints.len())).collect();
            let plan = Plan::new(&case.robot, &braked, &vec![rotor; case.robot.joints.len()]);
            let contacts = case.points(0.1, Rotation::by(0.3));
            let by_mass = case.computed(&plan, &contacts);
            let mut workspace = by_mass.clone();
            articulated_inertias(&plan, &mut workspace);
            articulated_delassus(&plan, &contacts, &mut workspace);
            let nv = plan.columns();
            let diagonal: Vec<f64> = (0..nv).map(|i| by_mass.factor.pivot(i)).collect();
            let condition = (0..nv).map(|i| (by_mass.mass_matrix[i * nv + i] / diagonal[i]).abs()).fold(1.0, f64::max);
            prop_assume!(condition < 1e10);
            // Both algorithms lose a few hundred roundings, magnified by the cancellation in the pivots.
            let near = |a: &[f64], b: &[f64]| {
                let size = a.iter().fold(1.0, |size: f64, entry| size.max(entry.abs()));
                a.len() == b.len()
                    && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 300.0 * f64::EPSILON * condition * size)
            };
            prop_assert!(near(&by_mass.delassus, &workspace.delassus), "{:?} {:?}", by_mass.delassus, workspace.delassus);
            prop_assert!(near(by_mass.half.as_flattened(), workspace.half.as_flattened()));
            prop_assert!(near(&diagonal, &workspace.pivots), "{diagonal:?} {:?}", workspace.pivots);

            let impulse = PointImpulse { body: contacts[0].body, arm: contacts[0].arm(&workspace), vector: impulse.into() };
            let (mut expected, mut found) = (case.velocity.clone(), case.velocity.clone());
            add_impulse(&plan, &by_mass, impulse, &mut Vec::new(), &mut expected);
            add_articulated_impulse(&plan, &workspace, impulse, &mut Vec::new(), &mut Vec::new(), &mut found);
            prop_assert!(near(&expected, &found), "{expected:?} {found:?}");
        }

        #[test]
        fn f64_numbers_keep_within_their_bounds(case in case(true)) {
            type Exact = Ball<DoubleDouble>;
            let (plan, contacts) = (Plan::new(&case.robot, &[], &[]), case.points(0.0, Rotation::identity()));
            let workspace = case.computed(&plan, &contacts);
            let mut bounds = case.bounds(&plan, &contacts);
            bounds.delassus(&plan, &workspace);
            prop_assume!(bounds.delassus.is_finite());

            let points = case.points(0.0, Rotation::identity());
            let exact = case.computed::<Exact>(&Plan::new(&case.robot, &[], &[]), &points);
            let rows = 2 * contacts.len();
            // A lower bound on the distance between the f64 and the exact number.
            let off = |found: f64, exact: Exact| ((exact - Exact::from_f64(found)).to_f64()).abs() - exact.error();
            for i in 0..rows {
                for j in 0..rows {
                    let [found, one, other] = [(i, j), (i, i), (j, j)].map(|(i, j)| workspace.delassus[i * rows + j]);
                    let allowed = bounds.delassus * (one * other).sqrt();
                    prop_assert!(off(found, exact.delassus[i * rows + j]) <= allowed, "G[{i}][{j}]: {allowed:e}");
                }
                let (found, exact) = (workspace.contact_velocity[i / 2][i % 2], exact.contact_velocity[i / 2][i % 2]);
                prop_assert!(off(found, exact) <= bounds.velocity[i / 2][i % 2]);
            }
        }

        #[test]
        fn no_pose_exceeds_the_greatest_ease(
            mut case in case(true),
            rotor in 0.0..0.1f64,
            unit in prop_oneof![Just(1.0), Just(1e-200)],
        ) {
            for body in &mut case.robot.bodies {
                (body.mass, body.moment) = (unit * body.mass, unit * body.moment);
            }
            let plan = Plan::new(&case.robot, &[], &vec![unit * rotor; case.robot.joints.len()]);
            let (workspace, bounds) = (case.computed(&plan, &[]), case.bounds(&plan, &[]));
            let nv = plan.columns();
            let left = |i: usize| workspace.factor.pivot(i) / workspace.mass_matrix[i * nv + i];
            prop_assume!((0..nv).all(|i| left(i) > 1e-6));
            for (column, greatest) in bounds.greatest_ease.iter().enumerate() {
                let mut inverse = vec![0.0; nv];
                inverse[column] = 1.0;
                workspace.factor.solve(&plan, &mut inverse);
                prop_assert!(inverse[column] <= greatest * greatest * (1.0 + 1e-9), "{column}: {inverse:?} {greatest}");
            }
        }

        /// Uses trees with mimic joints and a virtual spring, and compares with balls of double-doubles.
        #[test]
        fn f64_accelerations_keep_within_their_bounds(
            case in case(true),
            ends in prop::array::uniform2((any::<Index>(), point())),
            law in prop::array::uniform4(-3.0..3.0f64),
            steady in any::<bool>(),
        ) {
            type Exact = Ball<DoubleDouble>;
            let [stiffness, damping, target, constant] = law;
            let laws = [SpringLaw { stiffness, damping, target, constant }; 3];
            let (plan, contacts) = (Plan::new(&case.robot, &[], &[]), case.points(0.0, Rotation::identity()));
            let mut bounds = case.bounds(&plan, &contacts);
            let workspace = case.computed(&plan, &contacts);
            bounds.delassus(&plan, &workspace);
            prop_assume!(bounds.delassus.is_finite());
            let (_, acceleration, found) =
                case.accelerated(&plan, &contacts, workspace.clone(), (ends, laws, steady), |column, workspace| {
                    workspace.factor.solve(&plan, column);
                });
            let exact_plan = Plan::<Exact>::new(&case.robot, &[], &[]);
            let points = case.points(0.0, Rotation::identity());
            let exact = case.computed(&exact_plan, &points);
            let (.., exact) = case.accelerated(&exact_plan, &points, exact, (ends, laws, steady), |column, workspace| {
                workspace.factor.solve(&exact_plan, column);
            });
            let stretched_plan = Plan::<Magnitude>::new(&case.robot, &[], &[]);
            let mut stretched = Workspace::default();
            bounds.stretched_poses(&stretched_plan, &mut stretched);
            let points: Vec<_> = bounds.stretched_points().collect();
            let (loads, _, whole) =
                case.accelerated(&stretched_plan, &points, stretched, (ends, laws, steady), |column, _| {
                    for (entry, &coordinate) in column.iter_mut().zip(&plan.coordinates) {
                        *entry = Magnitude::from_f64(acceleration[coordinate]);
                    }
                });
            let (_, allowed) = bounds.accelerations(&plan, &acceleration, &workspace, (&loads, 1), &whole);
            for (index, allowed) in allowed.into_iter().enumerate() {
                for axis in 0..2 {
                    let off = (exact[index][axis] - Exact::from_f64(found[index][axis])).to_f64().abs();
                    prop_assert!(off - exact[index][axis].error() <= allowed[axis], "{off:e} {allowed:?}");
                    prop_assert!(allowed[axis] < 1e-3, "{allowed:?}");
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn long_chains_keep_within_their_balance(
            mut case in case_of(tree(1..60, 3, false)),
            slides in any::<bool>(),
            braked in prop::option::weighted(0.3, any::<Index>()),
            rotor in prop_oneof![Just(0.0), 1e-3..1.0f64],
            light in -6..1i32,
            slope in -1.0..1.0f64,
        ) {
            for (at, body) in case.robot.bodies.iter_mut().enumerate() {
                let factor = if at % 3 == 1 { libm::exp10(f64::from(light)) } else { 1.0 };
                (body.mass, body.moment) = (body.mass * factor, (body.moment + 1e-4) * factor);
            }
            if !slides {
                case.robot.joints.iter_mut().for_each(|joint| joint.axis = Axis::Revolute { sign: 1.0 });
            }
            let braked: Vec<usize> = braked.iter().map(|braked| braked.index(case.robot.joints.len())).collect();
            let rotors = vec![rotor; case.robot.joints.len()];
            let plan = Plan::new(&case.robot, &braked, &rotors);
            prop_assert!(has_balance(&plan));
            let points = case.points(0.1, Rotation::by(slope));
            let workspace = case.by_bodies(&plan, &points);
            let mut bounds = case.bounds(&plan, &points);
            bounds.articulated_delassus(&plan, &points, &workspace);
            let error = Interval::scope(512, || {
                let plan = Plan::<Interval>::new(&case.robot, &braked, &rotors);
                let exact = case.by_bodies(&plan, &case.points(0.1, Rotation::by(slope)));
                error_of(&workspace.delassus, &exact.delassus)
            });
            let likely = bounds.likely[0] * bounds.delassus;
            prop_assert!(error.is_nan() || error <= likely, "{error:e} > {likely:e}");
            prop_assert!(likely <= bounds.delassus);
        }
    }
}
