//! One core, many numbers: kinematics, mass matrix, factorization, Jacobian, Delassus matrix and the numbers of all
//! combinations run on exact rationals and balls without a change, and agree with f64.

use dashu_ratio::RBig;
use heelstrike::Robot;
use heelstrike::dynamics::plan::{Configuration, Plan};
use heelstrike::dynamics::{ContactPoint, Workspace, contact_jacobian, delassus, factorize, kinematics, mass_matrix};
use heelstrike::impact::enumerate::{Leaf, Tableau};
use heelstrike::impact::{ContactProblem, Friction};
use heelstrike::planar::Rotation;
use heelstrike::scalar::{Ball, Real};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

thread_local! {
    static ARENA: RefCell<Vec<RBig>> = const { RefCell::new(Vec::new()) };
}

/// An exact rational by its place in the thread's arena, so that it is `Copy`.
#[derive(Clone, Copy, Default)]
struct Exact(usize);

macro_rules! operators {
    ($($operator:ident $function:ident),*) => {
        $(impl $operator for Exact {
            type Output = Self;
            fn $function(self, other: Self) -> Self {
                Self::new($operator::$function(self.value(), other.value()))
            }
        })*
    };
}

operators!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Exact {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.value())
    }
}

impl Exact {
    fn new(value: RBig) -> Self {
        ARENA.with_borrow_mut(|arena| {
            arena.push(value);
            Self(arena.len() - 1)
        })
    }

    fn value(self) -> RBig {
        ARENA.with_borrow(|arena| arena[self.0].clone())
    }
}

impl Real for Exact {
    fn from_f64(value: f64) -> Self {
        Self::new(RBig::try_from(value).expect("finite"))
    }
}

/// Tangents of half angles of pitch and the four joints, state by state.
const HALF_TANGENTS: [[f64; 5]; 4] = [
    [0.0625, 0.5, -0.75, 0.125, -0.875],
    [-0.125, 0.25, -0.5, 0.375, -0.25],
    [0.0, -0.5, -1.0, 0.5, -0.0625],
    [0.03125, 0.625, 0.25, -0.5, -0.75],
];
const VELOCITY: [f64; 7] = [0.5, -0.25, 1.0, -0.5, 0.75, 0.0, -1.5];

/// M (lower triangle), G and c of RAMone; angles by the tangent of their half, so that cosine and sine are rational.
fn run<T: Real>(half_tangents: [T; 5]) -> Vec<T> {
    let robot = Robot::from_urdf(include_str!("../../urdf/ramone.urdf")).expect("a good robot");
    let plan = Plan::<T>::new(&robot, &[], &[]);
    let one = T::one();
    let cos = half_tangents.map(|t| (one - t * t) / (one + t * t));
    let sin = half_tangents.map(|t| (t + t) / (one + t * t));
    // x and z have no angle; their entries are not read.
    let padded = |values: [T; 5]| [[T::zero(); 2].as_slice(), values.as_slice()].concat();
    let configuration = Configuration { cos: padded(cos), sin: padded(sin), displacement: vec![T::zero(); 7] };
    let mut workspace = Workspace::default();
    kinematics(&plan, &configuration, &mut workspace);
    mass_matrix(&plan, &mut workspace);
    factorize(&plan, &mut workspace);
    let contacts = ["left_foot", "right_foot"].map(|name| {
        let link = &robot.links[robot.link(name).expect("a foot")];
        let (center, radius) = (link.point([0.0; 3]).map(T::from_f64), T::from_f64(0.02815));
        ContactPoint { body: link.body, center, radius, ground: Rotation::identity() }
    });
    contact_jacobian(&plan, &contacts, &VELOCITY.map(T::from_f64), None, &mut workspace);
    delassus(&plan, &mut workspace);
    let mut numbers = workspace.mass_matrix.clone();
    numbers.extend(&workspace.delassus);
    numbers.extend(workspace.contact_velocity.as_flattened());
    numbers
}

/// The numbers of all combinations of a problem given in f64.
fn combinations<T: Real>(problem: &ContactProblem) -> Vec<T> {
    let mut tableau = Tableau::<T>::default();
    tableau.load(&problem.map(T::from_f64));
    let mut numbers = Vec::new();
    tableau.visit(&mut |leaf: &Leaf<'_, T>| (0..2).for_each(|contact| numbers.extend(leaf.numbers(contact))));
    numbers
}

fn problem() -> ContactProblem {
    let delassus = vec![3.0, 0.5, 0.25, 0.1, 0.5, 2.0, 0.3, -0.5, 0.25, 0.3, 4.0, 1.0, 0.1, -0.5, 1.0, 3.0];
    let friction = vec![Friction::Finite(0.75), Friction::Infinite];
    ContactProblem::new(delassus, vec![[0.5, -1.0], [-0.3, -0.5]], friction, vec![0.0, 0.5]).expect("a good problem")
}

fn exact(value: f64) -> RBig {
    RBig::try_from(value).expect("finite")
}

/// What is compared with the exact core.
fn numbers<T: Real>() -> Vec<T> {
    let states = HALF_TANGENTS.iter().flat_map(|tangents| run(tangents.map(T::from_f64)));
    states.chain(combinations(&problem())).collect()
}

#[test]
fn f64_is_within_rounding_of_the_exact_core() {
    for (entry, (reference, found)) in numbers::<Exact>().iter().zip(numbers::<f64>()).enumerate() {
        let far = (reference.value() - exact(found)).to_f64().value().abs();
        // Entries are sums of some dozen terms of order ten at most.
        assert!(far < 1e3 * f64::EPSILON, "entry {entry}: {found} is off by {far}");
    }
}

#[test]
fn balls_enclose_the_exact_core() {
    let mut widest = 0.0_f64;
    for (reference, ball) in numbers::<Exact>().iter().zip(numbers::<Ball>()) {
        let (distance, radius) = (reference.value() - exact(ball.mid), exact(ball.radius));
        assert!(distance <= radius && -distance <= radius, "{ball:?}");
        widest = widest.max(ball.radius);
    }
    assert!(widest < 1e-11, "balls are of use only while they are small: {widest}");
}
