//! Seeded random states of several robots, and states at chosen distances from a border.

use crate::balls::oracle;
use crate::support::command::read;
use crate::support::random::Random;
use crate::support::urdf::{self, Axis};
use heelstrike::impact::{Friction, Mode};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::planar::Vector;
use heelstrike::robot::Robot;
use heelstrike::state::{
    AppliedImpulse, ByLink, Ground, LinkPoint, NamedContact, NamedLoop, Profile, Scene, SpringEnd, SpringLaw, State,
    VirtualSpring,
};

/// A robot with the points that its states name as contacts.
#[derive(Clone)]
pub struct Model {
    pub name: &'static str,
    pub robot: Robot,
    feet: Vec<NamedContact>,
    /// How many feet touch in most states.
    touching: usize,
    /// How many feet touch at most, so that contacts are not redundant by their number.
    most: usize,
    /// The robot's loops, and a function that changes a pose so that they are closed.
    loops: Vec<NamedLoop>,
    closing: fn(&mut [f64]),
}

/// A robot with prismatic joints, one of them inclined, which no robot file has.
fn telescope() -> String {
    urdf::robot(&[
        urdf::link("torso", 5.0, [0.02, 0.1], 0.07, ""),
        urdf::link("left_leg", 0.7, [0.0, -0.2], 0.004, ""),
        urdf::link("left_foot", 0.3, [0.0, -0.1], 0.001, ""),
        urdf::link("right_foot", 0.9, [0.01, -0.3], 0.006, ""),
        urdf::joint("left_hip", Axis::Revolute(1.0), ["torso", "left_leg"], [-0.1, -0.05], ""),
        urdf::joint("left_slide", Axis::Prismatic([0.6, -0.8]), ["left_leg", "left_foot"], [0.0, -0.3], ""),
        urdf::joint("right_slide", Axis::Prismatic([0.0, -1.0]), ["torso", "right_foot"], [0.1, -0.05], ""),
    ])
}

/// A chain of `length` links with masses of 1e-4 to 1e4 kg; points of three links may touch.
pub fn chain(length: usize, random: &mut Random) -> Model {
    let links = (0..length).map(|link| {
        let mass = random.decades(-4.0, 4.0);
        urdf::link(format!("link_{link}"), mass, [0.0, -random.between(0.1, 0.9)], 0.02 * mass, "")
    });
    let mut parts: Vec<String> = links.collect();
    parts.extend((1..length).map(|link| joint(link - 1, link, Axis::Revolute(1.0), [0.0, -1.0])));
    let feet = [length - 1, length - 3, 4].map(|link| (format!("link_{link}"), [0.1, 0.0, -1.0], 0.0));
    Model { most: 3, ..Model::new("chain", &urdf::robot(&parts), 2, &feet) }
}

/// A random tree of two to seven links on revolute and prismatic joints; one point per link may touch, two at a time.
pub fn tree(random: &mut Random) -> Model {
    let point = |random: &mut Random| [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
    let (mut parts, mut feet) = (Vec::new(), Vec::new());
    for link in 0..random.whole(2, 7) as usize {
        let mass = random.between(0.3, 4.0);
        parts.push(urdf::link(format!("link_{link}"), mass, point(random), random.between(0.01, 0.5), ""));
        let [x, z] = point(random);
        feet.push((format!("link_{link}"), [x, 0.0, z], 0.0));
        if link > 0 {
            let axes = [Axis::Revolute(1.0), Axis::Revolute(-1.0), Axis::Revolute(1.0), Axis::Prismatic(point(random))];
            parts.push(joint(random.whole(0, link as i64 - 1) as usize, link, random.pick(&axes), point(random)));
        }
    }
    Model::new("tree", &urdf::robot(&parts), 2, &feet)
}

fn joint(parent: usize, link: usize, axis: Axis, origin: [f64; 2]) -> String {
    let ends = [parent, link].map(|end| format!("link_{end}"));
    urdf::joint(format!("joint_{link}"), axis, [&ends[0], &ends[1]], origin, "")
}

/// A robot with mimic joints: the left knee and ankle follow the left hip, and the right slide follows the right hip.
fn follower() -> String {
    let mimic = |joint: &str, multiplier: f64, offset: f64| {
        format!("<mimic joint=\"{joint}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>")
    };
    let [knee, ankle] = [mimic("left_hip", 1.7, 0.3), mimic("left_hip", 0.3, -0.1)];
    let slide = mimic("right_hip", 0.125, 0.2);
    urdf::robot(&[
        urdf::link("torso", 4.0, [0.05, 0.1], 0.08, ""),
        urdf::link("left_thigh", 1.0, [0.0, -0.2], 0.01, ""),
        urdf::link("left_shank", 0.7, [0.03, -0.2], 0.006, ""),
        urdf::link("left_toe", 0.2, [0.05, 0.0], 0.001, ""),
        urdf::link("right_thigh", 0.8, [0.0, -0.1], 0.009, ""),
        urdf::link("right_foot", 0.4, [0.0, -0.1], 0.003, ""),
        urdf::link("tail", 0.3, [-0.3, 0.0], 0.004, ""),
        urdf::joint("left_hip", Axis::Revolute(1.0), ["torso", "left_thigh"], [0.1, -0.1], ""),
        urdf::joint("left_knee", Axis::Revolute(-1.0), ["left_thigh", "left_shank"], [0.0, -0.4], &knee),
        urdf::joint("left_ankle", Axis::Revolute(1.0), ["left_shank", "left_toe"], [0.0, -0.4], &ankle),
        urdf::joint("right_hip", Axis::Revolute(-1.0), ["torso", "right_thigh"], [-0.1, -0.1], ""),
        urdf::joint("right_slide", Axis::Prismatic([0.6, -0.8]), ["right_thigh", "right_foot"], [0.0, -0.2], &slide),
        urdf::joint("tail", Axis::Revolute(1.0), ["torso", "tail"], [-0.2, 0.1], ""),
    ])
}

/// Sets both knees of the five-bar leg such that the ends of its shanks coincide, ahead of the hips or behind them.
fn close_five_bars(q: &mut [f64]) {
    let [hips, thigh, shank] = [0.2, 0.4, 0.5];
    // Smaller hip angles, so that the shanks reach each other.
    let [left, right] = [3, 5].map(|hip| 0.6 * q[hip]);
    let knee = |hip: f64, x: f64| [x - thigh * hip.sin(), -thigh * hip.cos()];
    let [a, b] = [knee(left, -0.5 * hips), knee(right, 0.5 * hips)];
    let [x, z] = [b[0] - a[0], b[1] - a[1]];
    let apart = f64::hypot(x, z);
    let rise = (shank * shank - 0.25 * apart * apart).max(0.0).sqrt() / apart;
    let end = [0.5 * (a[0] + b[0]) + rise * z, 0.5 * (a[1] + b[1]) - rise * x];
    // A bar that hangs down at zero points along (x, z) at the angle atan2(-x, -z).
    let turned = |from: [f64; 2], hip: f64| f64::atan2(from[0] - end[0], from[1] - end[1]) - hip;
    (q[3], q[5]) = (left, right);
    (q[4], q[6]) = (turned(a, left), turned(b, right));
}

/// Robots for states in sustained contact: with a loop, with mimic joints, on a fixed base, and two chains of random
/// masses, one of which is solved by articulated bodies alone.
pub fn tied_models(random: &mut Random) -> Vec<Model> {
    let feet =
        [("left_shank", [0.0, 0.0, -0.5], 0.0), ("torso", [-0.3, 0.0, 0.0], 0.05), ("torso", [0.2, 0.0, 0.3], 0.0)];
    let mut five_bar = Model::new("five_bar", &read("urdf/five_bar.urdf"), 2, &feet);
    let end = |link: &str| LinkPoint { link: five_bar.robot.link(link).unwrap_or(0), offset: [0.0, 0.0, -0.5] };
    five_bar.loops = vec![NamedLoop { a: end("left_shank"), b: end("right_shank") }];
    five_bar.closing = close_five_bars;
    let feet =
        [("left_toe", [0.1, 0.0, -0.05], 0.0), ("right_foot", [0.0, 0.0, -0.3], 0.03), ("tail", [-0.5, 0.0, 0.0], 0.0)];
    let follower = Model::new("follower", &follower(), 2, &feet);
    let acrobot = read("tests/data/robots/acrobot/Acrobot.urdf");
    let acrobot = Model::new("acrobot", &acrobot, 1, &[("lower_link", [0.0, 0.0, -2.0], 0.1)]);
    vec![five_bar, follower, acrobot, chain(10, random), chain(26, random)]
}

/// The robots, each with up to four feet.
pub fn models() -> Vec<Model> {
    let model = |name, urdf: &str, touching, feet: &[(&str, [f64; 3], f64)]| {
        let model = Model::new(name, urdf, touching, feet);
        // More contact rows than coordinates make contacts redundant, so the number is limited, but not below
        // `touching`.
        let most = if touching > 2 { touching } else { feet.len().min(model.robot.dofs() / 2).max(touching) };
        Model { most, ..model }
    };
    let end = |z: f64| [0.0, 0.0, z];
    let legs = [("left_leg", end(-1.0), 0.0), ("right_leg", end(-1.0), 0.0)];
    let round = [("left_foot", end(0.0), 0.02815), ("right_foot", end(0.0), 0.02815)];
    let h1 = read("tests/proof/balls/h1_planar.urdf");
    let [left, right] =
        ["left_ankle_link", "right_ankle_link"].map(|ankle| [0.17, -0.06].map(|x| (ankle, [x, 0.0, -0.05], 0.0)));
    let hand_and_knee = [("left_elbow_link", [0.3, 0.0, -0.01], 0.02), ("left_knee_link", [0.03, 0.0, -0.2], 0.02)];
    let solo = ["FL_LOWER_LEG", "FR_LOWER_LEG", "HL_LOWER_LEG", "HR_LOWER_LEG"].map(|leg| (leg, end(-0.16), 0.0));
    let leaning = [round[0], round[1], ("torso", [0.05, 0.0, 0.2], 0.04)];
    let shins = [("right_shin", end(0.4), 0.0), ("left_shin", end(0.4), 0.0), ("torso", end(0.48), 0.0)];
    let wheels = [("left_wheel_tire", end(0.0), 0.05), ("right_wheel_tire", end(0.0), 0.05)];
    // A body that stands on two corners: four contact rows for three coordinates.
    let sled = urdf::robot(&[urdf::link("sled", 3.0, [0.1, 0.2], 0.05, "")]);
    let corners = [("sled", [0.4, 0.0, 0.0], 0.0), ("sled", [-0.3, 0.0, 0.0], 0.0)];
    let slides = [("left_foot", end(-0.2), 0.02), ("right_foot", end(-0.5), 0.0), ("torso", [0.2, 0.0, 0.3], 0.0)];
    vec![
        model("minimalistic", &read("urdf/minimalistic.urdf"), 2, &legs),
        model("pdw", &read("urdf/pdw.urdf"), 2, &legs),
        model("ramone", &read("urdf/ramone.urdf"), 2, &round),
        model("ramone_paper", &read("urdf/ramone_paper.urdf"), 3, &leaning),
        model("rabbit", &read("tests/data/robots/rabbit/five_link_walker.urdf"), 2, &shins),
        model("upkie", &read("tests/data/robots/upkie/upkie.urdf"), 2, &wheels),
        model("solo8", &read("tests/data/robots/solo8/solo.urdf"), 4, &solo),
        model("h1_planar", &h1, 2, &[left[0], right[1], hand_and_knee[0], hand_and_knee[1]]),
        model("h1_flat", &h1, 2, &[left, right].concat()),
        model("sled", &sled, 2, &corners),
        model("telescope", &telescope(), 3, &slides),
    ]
}

impl Random {
    /// 10 to a power from `low` to `high`.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.between(low, high))
    }
}

impl Model {
    /// A robot with these points of links as feet, of which `touching` touch in most states.
    fn new(name: &'static str, urdf: &str, touching: usize, feet: &[(impl AsRef<str>, [f64; 3], f64)]) -> Self {
        let robot = Robot::from_urdf(urdf).unwrap_or_else(|error| panic!("{name}: {error}"));
        let link = |link: &str| robot.link(link).unwrap_or_else(|| panic!("{name} has no link {link}"));
        let feet = feet.iter().map(|(own, offset, radius)| NamedContact {
            link: link(own.as_ref()),
            offset: *offset,
            radius: *radius,
        });
        let feet = feet.collect();
        Self { name, robot, feet, touching, most: touching, loops: Vec::new(), closing: |_| {} }
    }

    /// The model's name and the JSON of one of its states, for messages.
    pub fn named(&self, state: &State) -> String {
        format!("{}\n{}", self.name, state.to_json(&self.robot).expect("a state of the model"))
    }

    /// A random state with one to four of the robot's feet as contacts.
    pub fn random(&self, random: &mut Random) -> State {
        let dofs = self.robot.dofs();
        let base = self.robot.base_dofs();
        let mut state = State {
            position: (0..dofs).map(|_| random.between(-1.5, 1.5)).collect(),
            velocity: (0..dofs).map(|_| random.between(-2.0, 2.0)).collect(),
            ..State::default()
        };
        // Most states move downward; otherwise most impacts would end with the feet in the air.
        state.velocity[1] -= random.between(0.0, 3.0);
        // Joints at rest give contacts equal velocities; straight legs give nearly singular matrices.
        if random.once_in(3) {
            state.velocity.iter_mut().for_each(|rate| {
                if random.once_in(2) {
                    *rate = 0.0;
                }
            });
        }
        if random.once_in(8) && dofs > base {
            let joint = random.whole(base as i64, dofs as i64 - 1) as usize;
            // A walker with only a hip is not quite straightened: its feet would coincide, and its legs of point masses
            // would have no inertia as one.
            let straight = if self.robot.joints().len() == 1 { [1e-4, 1e-2] } else { [0.0, 1e-9] };
            state.position[joint] = random.pick(&straight);
        }
        state.scene = self.scene(random);
        state
    }

    /// A random state in sustained contact, with torques; `None` if its contacts are redundant while they move.
    pub fn sustained(&self, random: &mut Random) -> Option<State> {
        let mut state = self.random(random);
        state.scene.impulses.clear();
        state.scene.stance = None;
        state.scene.gravity = random.once_in(4).then(|| random.between(0.0, 20.0));
        state.scene.torque = self.robot.joints().iter().map(|_| random.between(-20.0, 20.0)).collect();
        state.scene.springs = (0..random.whole(-1, 2)).map(|_| self.spring(random)).collect();
        state.scene.loops.clone_from(&self.loops);
        (self.closing)(&mut state.position);
        let contacts = state.scene.contacts.as_deref().unwrap_or_default();
        let is_shared = |at: usize| (0..at).any(|other| contacts[other].link == contacts[at].link);
        if random.once_in(3) || (0..contacts.len()).any(is_shared) {
            state.velocity.fill(0.0);
            return Some(state);
        }
        // The contact Jacobian, with the columns of braked joints.
        let options = Options { matrices: true, ..Options::default() };
        let ends = self.loops.iter().flat_map(|own| [own.a, own.b]);
        let ends = ends.map(|LinkPoint { link, offset }| NamedContact { link, offset, radius: 0.0 });
        let rows_of = |contacts: Vec<NamedContact>, ground: Ground| {
            let (contacts, friction) = (Some(contacts), ByLink::everywhere(Friction::ZERO));
            let scene = Scene { contacts, ground, friction, ..Scene::default() };
            let loose = State { scene, ..state.clone() };
            Some(Pipeline::new(&self.robot, options.clone()).impact(&loose).ok()?.matrices?.contact_jacobian)
        };
        let mut rows = rows_of(contacts.to_vec(), state.scene.ground.clone())?;
        let ties = rows_of(ends.collect(), Ground::default())?;
        // All normal velocities and a third of the tangential ones are removed.
        let mut wanted: Vec<usize> = (0..rows.len()).filter(|at| at % 2 == 1 || random.once_in(3)).collect();
        for ends in ties.chunks(4) {
            for axis in 0..2 {
                wanted.push(rows.len());
                rows.push(ends[axis].iter().zip(&ends[2 + axis]).map(|(a, b)| a - b).collect());
            }
        }
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let subtract = |from: &mut Vec<f64>, own: &[f64]| {
            let part = dot(from, own) / dot(own, own);
            from.iter_mut().zip(own).for_each(|(entry, own)| *entry -= part * own);
        };
        for at in wanted {
            let mut row = rows[at].clone();
            for _ in 0..2 {
                basis.iter().for_each(|own| subtract(&mut row, own));
            }
            if dot(&row, &row) < 1e-12 * dot(&rows[at], &rows[at]) {
                return None;
            }
            basis.push(row);
        }
        for _ in 0..2 {
            basis.iter().for_each(|own| subtract(&mut state.velocity, own));
        }
        Some(state)
    }

    /// A spring from one link to another or to the world.
    fn spring(&self, random: &mut Random) -> VirtualSpring {
        let point = |random: &mut Random| LinkPoint {
            link: random.whole(0, self.robot.links().len() as i64 - 1) as usize,
            offset: [random.between(-0.3, 0.3), 0.0, random.between(-0.3, 0.3)],
        };
        let a = point(random);
        let b = match random.once_in(2) {
            true => SpringEnd::Link(point(random)),
            false => SpringEnd::World(Vector::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0))),
        };
        let laws = std::array::from_fn(|_| SpringLaw {
            stiffness: random.pick(&[0.0, 300.0]) * random.uniform(),
            damping: random.pick(&[0.0, 30.0]) * random.uniform(),
            target: random.between(-0.5, 0.5),
            constant: random.pick(&[0.0, 20.0]) * random.between(-1.0, 1.0),
        });
        VirtualSpring { a, b, laws }
    }

    fn scene(&self, random: &mut Random) -> Scene {
        let order = random.permutation(self.feet.len());
        let count = match random.whole(1, 12) {
            1 => 1,
            2 => self.most,
            _ => self.touching,
        };
        let contacts: Vec<NamedContact> = order[..count].iter().map(|&foot| self.feet[foot]).collect();
        let alike = random.once_in(2).then(|| friction(random));
        let mut links: Vec<usize> = contacts.iter().map(|contact| contact.link).collect();
        links.sort_unstable();
        links.dedup();
        let by_link = links.iter().map(|&link| (link, alike.unwrap_or_else(|| friction(random)))).collect();
        // A stance is the lowest contact of its link, so only a link with a single contact is chosen.
        let alone = contacts.iter().filter(|contact| contact.link == contacts[0].link).count() == 1;
        let mut scene = Scene {
            friction: ByLink { default: None, links: by_link },
            ground: ground(random),
            stance: (alone && random.once_in(4)).then(|| contacts[0].link),
            ..Scene::default()
        };
        if random.once_in(5) {
            let bounce = |link: usize| (link, random.pick(&[0.0, 0.5, 1.0, 0.3]));
            scene.restitution = ByLink { default: None, links: links.into_iter().map(bounce).collect() };
        }
        if random.once_in(10) && !self.robot.joints().is_empty() {
            scene.braked = vec![random.whole(0, self.robot.joints().len() as i64 - 1) as usize];
        }
        if random.once_in(10) {
            let joints = self.robot.joints().len() + self.robot.mimic_joints().len();
            scene.rotor_inertia = (0..joints).map(|_| random.decades(-4.0, -1.0)).collect();
        }
        if random.once_in(10) {
            scene.impulses = vec![AppliedImpulse {
                link: self.feet[order[0]].link,
                offset: [random.between(-0.1, 0.1), 0.0, random.between(-0.1, 0.1)],
                vector: Vector::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0)),
            }];
        }
        scene.contacts = Some(contacts);
        scene
    }
}

/// Zero, small, usual, large, or infinite friction.
fn friction(random: &mut Random) -> Friction {
    match random.whole(0, 9) {
        0 => Friction::ZERO,
        1 => Friction::Finite(random.decades(-12.0, -1.0)),
        2 => Friction::Finite(random.decades(0.2, 12.0)),
        3 | 4 => Friction::Infinite,
        _ => Friction::Finite(random.between(0.1, 1.5)),
    }
}

/// A number of a state that varies along a line in the space of states.
#[derive(Debug, Clone, Copy)]
enum Parameter {
    Position(usize),
    Velocity(usize),
    /// Friction of this link.
    Friction(usize),
}

impl Parameter {
    fn random(state: &State, robot: &Robot, random: &mut Random) -> Self {
        let floating = robot.base_dofs() == 3;
        let finite = |(&link, &mu): (&usize, &Friction)| matches!(mu, Friction::Finite(mu) if mu > 0.0).then_some(link);
        let finite: Vec<usize> = state.scene.friction.links.iter().filter_map(finite).collect();
        // The base's x and z change no outcome, and with a stance their rates change none either.
        let dofs = robot.dofs() as i64 - 1;
        match random.whole(0, 2) {
            0 if !finite.is_empty() => Self::Friction(random.pick(&finite)),
            1 => Self::Position(random.whole(if floating { 2 } else { 0 }, dofs) as usize),
            _ => Self::Velocity(random.whole(if state.scene.stance.is_some() { 2 } else { 0 }, dofs) as usize),
        }
    }

    fn of(self, state: &State) -> f64 {
        match self {
            Self::Position(k) => state.position[k],
            Self::Velocity(k) => state.velocity[k],
            Self::Friction(link) => match state.scene.friction.of(link) {
                Some(Friction::Finite(mu)) => mu,
                _ => f64::INFINITY,
            },
        }
    }

    fn with(self, state: &State, value: f64) -> State {
        let mut changed = state.clone();
        match self {
            Self::Position(k) => changed.position[k] = value,
            Self::Velocity(k) => changed.velocity[k] = value,
            Self::Friction(link) => {
                changed.scene.friction.links.insert(link, Friction::Finite(value.max(0.0)));
            }
        }
        changed
    }
}

/// States next to one border: the two neighboring f64 values of a parameter between which the outcomes change, and a
/// value farther off on either side, 1e-15 to 1e-6 of the parameter away.
pub fn beside_a_border(model: &Model, random: &mut Random) -> [State; 4] {
    let mut pipeline = Pipeline::new(&model.robot, Options::default());
    loop {
        let state = model.random(random);
        let parameter = Parameter::random(&state, &model.robot, random);
        let start = parameter.of(&state);
        let far = match parameter {
            Parameter::Friction(_) => start * random.decades(-2.0, 2.0),
            _ => start + random.between(-1.0, 1.0),
        };
        let guess = |value: f64| oracle::guess(&model.robot, &parameter.with(&state, value));
        let Some(guessed) = bisect(start, far, guess) else { continue };
        let modes = |value: f64| modes(model, &parameter.with(&state, value));
        // The product finds the place faster. The place counts only if the oracle's outcomes change there; otherwise
        // the oracle searches for one.
        let mut found = |value: f64| {
            let analysis = pipeline.impact(&parameter.with(&state, value)).ok()?.into_analysis().ok()?;
            Some(analysis.outcomes.into_iter().map(|outcome| outcome.modes).collect::<Vec<_>>())
        };
        let near = widen(guessed, &mut found).and_then(|[a, b]| bisect(a, b, &mut found));
        let near = near.filter(|&[a, b]| modes(a) != modes(b));
        let near = near.or_else(|| widen(guessed, modes).and_then(|[a, b]| bisect(a, b, modes)));
        let Some([a, b]) = near else { continue };
        if modes(a).is_none() || modes(b).is_none() {
            continue;
        }
        let mut off = |value: f64, away: f64| {
            let step = random.decades(-15.0, -6.0) * value.abs();
            if away < value { value + step } else { value - step }
        };
        let values = [a, b, off(a, b), off(b, a)];
        return values.map(|value| parameter.with(&state, value));
    }
}

/// The modes of all outcomes; `None` if they are undecided.
fn modes(model: &Model, state: &State) -> Option<Vec<Vec<Mode>>> {
    let answer = oracle::answer(&model.robot, state, &[]).filter(|answer| answer.open == 0)?;
    Some(answer.outcomes.into_iter().map(|outcome| outcome.modes).collect())
}

/// Two neighboring f64 from `a` to `b` that `property` distinguishes; `None` if it does not distinguish `a` from `b`.
fn bisect<T: PartialEq>(mut a: f64, mut b: f64, mut property: impl FnMut(f64) -> T) -> Option<[f64; 2]> {
    let at_a = property(a);
    if property(b) == at_a {
        return None;
    }
    loop {
        let middle = a + (b - a) / 2.0;
        if middle == a || middle == b {
            return Some([a, b]);
        }
        *(if property(middle) == at_a { &mut a } else { &mut b }) = middle;
    }
}

/// Two numbers around `guessed`, which is off by the rounding of f64, that `property` distinguishes.
fn widen<T: PartialEq>([a, b]: [f64; 2], mut property: impl FnMut(f64) -> T) -> Option<[f64; 2]> {
    let mut reach = b - a;
    let (mut low, mut high) = (a, b);
    // 4^20 units in the last place are 1e-4 of the number, more than the error of a guess in f64.
    for _ in 0..20 {
        if property(low) != property(high) {
            return Some([low, high]);
        }
        (low, high) = (a - reach, b + reach);
        reach *= 4.0;
    }
    None
}

/// Level ground, a slope, or a profile of one segment whose rounded normal is not quite of length one.
fn ground(random: &mut Random) -> Ground {
    if random.once_in(2) {
        return Ground::Slope(0.0);
    }
    if random.once_in(2) {
        return Ground::Slope(random.between(-0.6, 0.6));
    }
    let [x, z] = random.pick(&[[4.0, 3.0], [4.0, -3.0], [12.0, 5.0], [8.0, -6.0]]);
    Ground::Profile(Profile::new(vec![Vector::new(-x, -z), Vector::new(x, z)]).expect("a profile"))
}
