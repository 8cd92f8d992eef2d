//! Rigid-body dynamics of the planar tree, written once over [`Real`](crate::scalar::Real).
//!
//! ```text
//!     kinematics --> crba (M) --> ltl (M = L^T D L) ──┐
//!          ├──────── jacobian (J, c = J v) ───────────┴──> delassus (G = J M^-1 J^T), effect of impulses on v
//!          ├──────── loops (K) ──────────────────────────────> G without what loops do not let move, their impulses
//!          └──────── articulated ────────────────────────> the same G and effect, without M
//! ```
//!
//! Every function reads a [`Plan`](crate::dynamics::plan::Plan) and writes into a [`Workspace`].

pub mod plan;
mod ltl;
mod articulated_inertia;
mod workspace;
mod contact_point;
mod kinematics;
mod crba;
mod jacobian;
mod energy;
mod delassus;
mod loops;
mod articulated;
mod bounds;

pub use articulated::{add_articulated_impulse, articulated_delassus, articulated_inertias};
pub use articulated_inertia::ArticulatedInertia;
pub use bounds::{Arm, Bounds};
pub use contact_point::ContactPoint;
pub use crba::{factorize, mass_matrix};
pub use delassus::{add_impulse, delassus};
pub use energy::kinetic_energy;
pub use jacobian::{contact_jacobian, point_velocity};
pub use kinematics::kinematics;
pub use loops::{
    Closed, Constraints, Loop, close, eliminate_loops, independent_rows, loop_impulse, orthogonalize, spent_energy,
};
pub use ltl::LtlFactor;
pub use workspace::{LoopRows, Workspace};

#[cfg(test)]
mod tests {
    //! Each algorithm against an independent one, on random branching trees with revolute and prismatic joints.

    use super::*;
    use crate::dynamics::plan::{Configuration, Plan};
    use crate::planar::{Rotation, Vector};
    use crate::robot::{Axis, Base, Body, Joint, MimicJoint, ParentJoint, Robot};
    use crate::scalar::{Ball, DoubleDouble, Ordered, Real};
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    fn body(joint: Option<ParentJoint>, mass: f64, com: Vector<f64>, moment: f64) -> Body {
        Body { name: String::new(), joint, mass, com, moment }
    }

    prop_compose! {
        fn joint_and_body()(
            parent in any::<prop::sample::Index>(),
            origin in prop::array::uniform2(-1.0..1.0f64),
            slides in prop::bool::weighted(0.2),
            angle in -3.0..3.0f64,
            mass in 0.01..2.0f64,
            com in prop::array::uniform2(-0.5..0.5f64),
            moment in 0.0..0.1f64,
        ) -> (prop::sample::Index, Vector<f64>, Axis, f64, Vector<f64>, f64) {
            let axis = if slides {
                Axis::Prismatic { direction: Vector::new(angle.cos(), angle.sin()) }
            } else {
                Axis::Revolute { sign: angle.signum() }
            };
            (parent, origin.into(), axis, mass, com.into(), moment)
        }
    }

    prop_compose! {
        fn tree()(parts in prop::collection::vec(joint_and_body(), 1..8), bolted in prop::bool::weighted(0.2)) -> Robot {
            let mut robot = Robot {
                name: "tree".into(),
                base: if bolted { Base::Fixed } else { Base::Floating },
                bodies: vec![body(None, 1.0, Vector::new(0.1, -0.2), 0.05)],
                joints: Vec::new(),
                links: Vec::new(),
                mimic_joints: Vec::new(),
                left_out: Vec::new(),
                reading: Default::default(),
            };
            for (parent, origin, axis, mass, com, moment) in parts {
                let parent = parent.index(robot.bodies.len());
                robot.bodies.push(body(Some(ParentJoint::Joint(robot.joints.len())), mass, com, moment));
                robot.joints.push(Joint { name: String::new(), parent, child: robot.bodies.len() - 1, origin, axis });
            }
            robot
        }
    }

    type Follows = (prop::sample::Index, f64, f64);

    /// The tree with some of its joints, never the first, following others.
    fn tied(mut robot: Robot, follows: &[Option<Follows>]) -> Robot {
        let follows = |joint: usize| follows[joint].filter(|_| joint > 0);
        let leaders = (0..robot.joints.len()).filter(|&joint| follows(joint).is_none()).count();
        for (joint, own) in std::mem::take(&mut robot.joints).into_iter().enumerate() {
            let Joint { name, parent, child, origin, axis } = own;
            robot.bodies[child].joint = Some(if let Some((leader, multiplier, offset)) = follows(joint) {
                let leader = leader.index(leaders);
                robot.mimic_joints.push(MimicJoint {
                    name,
                    mimicked: leader,
                    multiplier,
                    offset,
                    parent,
                    child,
                    origin,
                    axis,
                });
                ParentJoint::Mimic(robot.mimic_joints.len() - 1)
            } else {
                robot.joints.push(Joint { name, parent, child, origin, axis });
                ParentJoint::Joint(robot.joints.len() - 1)
            });
        }
        robot
    }

    /// A robot, a configuration and two velocities, all of order one.
    fn of(robot: impl Strategy<Value = Robot>) -> impl Strategy<Value = (Robot, Vec<f64>, Vec<f64>)> {
        robot.prop_flat_map(|robot| {
            let dofs = robot.dofs();
            let numbers = || prop::collection::vec(-3.0..3.0f64, dofs);
            (Just(robot), numbers(), numbers())
        })
    }

    /// A tree in which some joints follow others.
    fn case() -> impl Strategy<Value = (Robot, Vec<f64>, Vec<f64>)> {
        let follows = (any::<prop::sample::Index>(), -2.0..2.0f64, -1.0..1.0f64);
        let follows = prop::collection::vec(prop::option::weighted(0.25, follows), 7);
        of((tree(), follows).prop_map(|(robot, follows)| tied(robot, &follows)))
    }

    fn computed(robot: &Robot, q: &[f64], held: &[usize], rotors: &[f64]) -> (Plan, Workspace) {
        let (plan, mut posture, mut workspace) =
            (Plan::new(robot, held, rotors), Configuration::default(), Workspace::default());
        posture.set(&plan, q);
        kinematics(&plan, &posture, &mut workspace);
        mass_matrix(&plan, &mut workspace);
        factorize(&plan, &mut workspace);
        (plan, workspace)
    }

    fn dense(plan: &Plan, lower: &[f64]) -> DMatrix<f64> {
        let nv = plan.columns();
        DMatrix::from_fn(nv, nv, |i, j| lower[i.max(j) * nv + i.min(j)])
    }

    /// v by column of the plan.
    fn by_column(plan: &Plan, v: &[f64]) -> DVector<f64> {
        DVector::from_iterator(plan.columns(), plan.coordinates().iter().map(|&coordinate| v[coordinate]))
    }

    proptest! {
        #[test]
        fn mass_matrix_gives_the_kinetic_energy_of_the_bodies((robot, q, v) in case()) {
            let rotors = vec![0.25; robot.joints.len()];
            let (plan, workspace) = computed(&robot, &q, &[], &rotors);
            let column = by_column(&plan, &v);
            let by_matrix = 0.5 * column.dot(&(dense(&plan, &workspace.mass_matrix) * &column));
            let by_bodies = kinetic_energy(&plan, &v, &workspace);
            // Both sum up to some hundred terms of the energy's own size.
            prop_assert!((by_matrix - by_bodies).abs() <= 1e3 * f64::EPSILON * by_bodies.max(1.0), "{by_matrix} {by_bodies}");
        }

        #[test]
        fn factor_multiplies_back_to_the_mass_matrix((robot, q, _) in case()) {
            let (plan, workspace) = computed(&robot, &q, &[], &[]);
            let nv = plan.columns();
            let entry = |i: usize, j: usize| workspace.factor.entry(i, j);
            let lower = DMatrix::from_fn(nv, nv, |i, j| if i == j { 1.0 } else if j < i { entry(i, j) } else { 0.0 });
            let diagonal = DMatrix::from_fn(nv, nv, |i, j| if i == j { workspace.factor.pivot(i) } else { 0.0 });
            let mass = dense(&plan, &workspace.mass_matrix);
            let back = lower.transpose() * diagonal * lower;
            // Backward error of the factorization: a few eps of the largest entry per column.
            prop_assert!((&back - &mass).amax() <= 64.0 * f64::EPSILON * mass.amax(), "{back} {mass}");
        }

        #[test]
        fn delassus_is_the_answer_to_unit_impulses(
            (robot, q, v) in case(),
            centres in prop::collection::vec((any::<prop::sample::Index>(), prop::array::uniform2(-1.0..1.0f64)), 1..4),
            slope in -1.0..1.0f64,
        ) {
            let (plan, mut workspace) = computed(&robot, &q, &[], &[]);
            let ground = Rotation::by(-slope);
            let contacts: Vec<ContactPoint> = centres
                .iter()
                .map(|(body, centre)| ContactPoint {
                    body: body.index(robot.bodies.len()), centre: (*centre).into(), radius: 0.1, ground,
                })
                .collect();
            contact_jacobian(&plan, &contacts, &v, None, &mut workspace);
            delassus(&plan, &mut workspace);
            let (nv, rows) = (plan.columns(), 2 * contacts.len());
            let jacobian = DMatrix::from_row_slice(rows, nv, &workspace.contact_jacobian);
            let inverse = dense(&plan, &workspace.mass_matrix).cholesky().expect("positive definite").inverse();
            let by_matrices = &jacobian * &inverse * jacobian.transpose();
            let found = DMatrix::from_row_slice(rows, rows, &workspace.delassus);
            let condition = {
                let values = dense(&plan, &workspace.mass_matrix).symmetric_eigenvalues();
                values.max() / values.min()
            };
            // The dense inverse loses the condition of M.
            let tolerance = 1e2 * f64::EPSILON * condition * by_matrices.amax().max(1.0);
            prop_assert!((&found - &by_matrices).amax() <= tolerance, "{found} {by_matrices}");
            for (index, contact) in contacts.iter().enumerate() {
                for (row, axis) in contact.axes().into_iter().enumerate() {
                    let mut change = vec![0.0; v.len()];
                    let point = (contact.body, contact.arm(&workspace));
                    add_impulse(&plan, &workspace, point, axis, &mut Vec::new(), &mut change);
                    let at = point_velocity(&plan, contact.body, point.1, &change, &workspace);
                    let own = workspace.delassus[(2 * index + row) * rows + 2 * index + row];
                    prop_assert!((axis.dot(at) - own).abs() <= tolerance);
                }
            }
            let speeds = &jacobian * by_column(&plan, &v);
            for (index, speed) in workspace.contact_velocity.iter().enumerate() {
                // A sum of at most eleven products of order ten.
                prop_assert!((speeds[2 * index] - speed[0]).abs() < 1e4 * f64::EPSILON);
                prop_assert!((speeds[2 * index + 1] - speed[1]).abs() < 1e4 * f64::EPSILON);
            }
        }

        #[test]
        fn articulated_bodies_give_the_delassus_matrix_without_the_mass_matrix(
            (robot, q, v) in of(tree()),
            centres in prop::collection::vec((any::<prop::sample::Index>(), prop::array::uniform2(-1.0..1.0f64)), 1..4),
            held in prop::option::weighted(0.3, any::<prop::sample::Index>()),
            rotor in prop_oneof![Just(0.0), 0.01..1.0f64],
            impulse in prop::array::uniform2(-1.0..1.0f64),
        ) {
            let held: Vec<usize> = held.iter().map(|held| held.index(robot.joints.len())).collect();
            let (plan, mut workspace) = computed(&robot, &q, &held, &vec![rotor; robot.joints.len()]);
            let contacts: Vec<ContactPoint> = centres
                .iter()
                .map(|(body, centre)| ContactPoint {
                    body: body.index(robot.bodies.len()), centre: (*centre).into(), radius: 0.1, ground: Rotation::by(0.3),
                })
                .collect();
            contact_jacobian(&plan, &contacts, &v, None, &mut workspace);
            delassus(&plan, &mut workspace);
            let by_mass = workspace.clone();
            articulated_inertias(&plan, &mut workspace);
            articulated_delassus(&plan, &contacts, &mut workspace);
            let nv = plan.columns();
            let condition = (0..nv)
                .map(|i| by_mass.mass_matrix[i * nv + i] / by_mass.factor.pivot(i))
                .fold(1.0, f64::max);
            // Either way loses a few hundred roundings, magnified by what cancels in the pivots.
            let near = |a: &[f64], b: &[f64]| {
                let size = a.iter().fold(1.0, |size: f64, entry| size.max(entry.abs()));
                a.len() == b.len()
                    && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 300.0 * f64::EPSILON * condition * size)
            };
            prop_assert!(near(&by_mass.delassus, &workspace.delassus), "{:?} {:?}", by_mass.delassus, workspace.delassus);
            prop_assert!(near(&by_mass.half, &workspace.half));
            let diagonal: Vec<f64> = (0..nv).map(|i| by_mass.factor.pivot(i)).collect();
            prop_assert!(near(&diagonal, &workspace.pivots), "{diagonal:?} {:?}", workspace.pivots);

            let point = (contacts[0].body, contacts[0].arm(&workspace));
            let (mut expected, mut found) = (v.clone(), v.clone());
            add_impulse(&plan, &by_mass, point, impulse.into(), &mut Vec::new(), &mut expected);
            let scratch = (&mut Vec::new(), &mut Vec::new());
            add_articulated_impulse(&plan, &workspace, point, impulse.into(), scratch, &mut found);
            prop_assert!(near(&expected, &found), "{expected:?} {found:?}");
        }

        #[test]
        fn no_f64_number_is_farther_from_the_exact_one_than_its_bound(
            (robot, q, v) in case(),
            centres in prop::collection::vec((any::<prop::sample::Index>(), prop::array::uniform2(-1.0..1.0f64)), 1..4),
        ) {
            type Exact = Ball<DoubleDouble>;
            let place = |index: &prop::sample::Index| index.index(robot.bodies.len());
            let (plan, mut workspace) = computed(&robot, &q, &[], &[]);
            let ground = Rotation { cos: 1.0, sin: 0.0 };
            let contacts: Vec<ContactPoint> = centres
                .iter()
                .map(|(body, centre)| ContactPoint { body: place(body), centre: (*centre).into(), radius: 0.0, ground })
                .collect();
            contact_jacobian(&plan, &contacts, &v, None, &mut workspace);
            delassus(&plan, &mut workspace);
            let (mut bounds, mut posture) = (Bounds::default(), Configuration::default());
            posture.set(&plan, &q);
            let arm = |(body, [x, z]): &(prop::sample::Index, [f64; 2])| Arm { body: place(body), length: x.abs() + z.abs() };
            bounds.stretch(&plan, &posture, centres.iter().map(arm));
            bounds.velocities(&plan, &v, None, |_| false);
            bounds.delassus(&plan, &workspace);
            prop_assume!(bounds.delassus.is_finite());

            let plan = Plan::<Exact>::new(&robot, &[], &[]);
            let (mut posture, mut exact) = (Configuration::default(), Workspace::default());
            posture.set(&plan, &q);
            kinematics(&plan, &posture, &mut exact);
            mass_matrix(&plan, &mut exact);
            factorize(&plan, &mut exact);
            let ground = Rotation::identity();
            let number = |entry: f64| Exact::from_f64(entry);
            let contacts: Vec<ContactPoint<Exact>> = contacts
                .iter()
                .map(|own| ContactPoint { body: own.body, centre: own.centre.map(number), radius: number(0.0), ground })
                .collect();
            let rates: Vec<Exact> = v.iter().map(|&entry| number(entry)).collect();
            contact_jacobian(&plan, &contacts, &rates, None, &mut exact);
            delassus(&plan, &mut exact);
            let rows = 2 * contacts.len();
            // How far the f64 may be from the exact number, and at least is.
            let off = |found: f64, exact: Exact| ((exact - number(found)).to_f64()).abs() - exact.error();
            for i in 0..rows {
                for j in 0..rows {
                    let [own, one, other] = [(i, j), (i, i), (j, j)].map(|(i, j)| workspace.delassus[i * rows + j]);
                    let allowed = bounds.delassus * (one * other).sqrt();
                    prop_assert!(off(own, exact.delassus[i * rows + j]) <= allowed, "G[{i}][{j}]: {allowed:e}");
                }
                let (found, exact) = (workspace.contact_velocity[i / 2][i % 2], exact.contact_velocity[i / 2][i % 2]);
                prop_assert!(off(found, exact) <= bounds.velocity[i / 2][i % 2]);
            }
        }

        #[test]
        fn a_held_joint_keeps_its_rate_and_drops_its_row((robot, q, v) in case(), index in any::<prop::sample::Index>()) {
            let held = index.index(robot.joints.len());
            let (whole, free) = computed(&robot, &q, &[], &[]);
            let (plan, workspace) = computed(&robot, &q, &[held], &[]);
            let full = dense(&whole, &free.mass_matrix);
            let place = |coordinate: usize| whole.coordinates().iter().position(|&own| own == coordinate).unwrap();
            let kept: Vec<usize> = plan.coordinates().iter().map(|&coordinate| place(coordinate)).collect();
            prop_assert_eq!(kept.len() + 1, whole.columns());
            let mass = dense(&plan, &workspace.mass_matrix);
            for (i, &row) in kept.iter().enumerate() {
                for (j, &column) in kept.iter().enumerate() {
                    prop_assert_eq!(mass[(i, j)], full[(row, column)]);
                }
            }
            let origin = Vector::zero();
            let tip = robot.bodies.len() - 1;
            prop_assert_eq!(
                point_velocity(&plan, tip, origin, &v, &workspace),
                point_velocity(&whole, tip, origin, &v, &free)
            );
        }
    }
}
