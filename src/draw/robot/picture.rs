//! Pictures of a robot in its pose: one panel per outcome, or the robot alone with the names of bodies and joints.

use super::{Arrow, Drawing, DrawnBody, DrawnContact, DrawnOutcome, DrawnShape, Extent, between};
use crate::contact::Placement;
use crate::draw::Forward;
use crate::draw::plot::{
    Color, Dash, LegendEntry, LegendKey, Mark, Panel, Picture, PlotAxis, PlotPoint, PlotShape, Stroke, significant,
};
use crate::pipeline::Aspect;
use crate::planar::Vector;
use crate::robot::{Body, ParentJoint};
use crate::state::{NamedContact, State};
use crate::write::table::number;
use crate::write::words::{self, DrawnNames, Wording};
use crate::{Impact, Mode, Outcome, Robot};
use std::iter;

const IMPULSE: Stroke = Stroke::solid(Color::Vermilion, 3.0);
const IN_LOOP: Stroke = Stroke::solid(Color::Green, 3.0);
const APPLIED: Stroke = Stroke { dash: Dash::DOTTED, ..Stroke::solid(Color::Purple, 3.0) };
const AFTER: Stroke = Stroke::solid(Color::Blue, 2.2);
const BEFORE: Stroke = Stroke { dash: Dash::DASHED, ..Stroke::solid(Color::Black, 1.4) };
const ROOT: Stroke = Stroke::solid(Color::Black, 1.6);
/// The color of joints and their names in the picture of a robot alone.
const JOINT: Color = Color::Blue;
const BONE: Stroke = Stroke::solid(Color::Gray, 4.0);
const EDGE: Stroke = Stroke::solid(Color::Gray, 0.8);
const SURFACE: Stroke = Stroke::solid(Color::Black, 1.6);
const NORMAL: Stroke = Stroke { dash: Dash::DOTTED, ..Stroke::solid(Color::Black, 1.0) };
/// The fill of bodies without children, such as feet and hands, and that of other bodies.
const LAST: Color = Color::Tint(1);
const INNER: Color = Color::Tint(0);

const COLUMNS: usize = 4;
/// Shares of the robot's size: the room around the drawing, and the length of a contact's normal.
const ROOM: f64 = 0.06;
const SHORT: f64 = 0.08;
/// Shares of the robot's size: the room below the drawing for names, the axes of the root, the longest arrow, and the
/// longest arrow in the legend.
const BELOW: f64 = 0.1;
const AXES: f64 = 0.18;
const LONGEST: f64 = 0.4;
const KEY: f64 = 0.1;
/// A velocity before is drawn aside by `ASIDE` of the robot's size if the sine of its angle to another arrow or to the
/// ground is smaller than `ALONG`.
const ALONG: f64 = 0.15;
const ASIDE: f64 = 0.02;
/// Half the width of the symbol of a CoG, for a body of negligible mass and for the heaviest body \[px\].
const LIGHT: f64 = 2.5;
const HEAVY: f64 = 8.0;
/// A velocity after is written as a number if its arrow is shorter than this share of the robot's size.
const SEEN: f64 = 0.04;
/// The number of letters in a line of names, per pixel of a panel's width.
const LETTERS: f64 = 0.1;
/// Points closer than this share of the robot's size are at one place.
const HAIR: f64 = 1e-3;
/// The largest number of bodies for which names are drawn.
const NAMED: usize = 60;

/// Returns a picture with impulses and velocities as arrows, with a panel for each outcome; `None` if there is no
/// analysis because there are too many contacts.
pub fn impact(
    robot: &Robot,
    feet: &[NamedContact],
    state: &State,
    impact: &Impact,
    forward: Forward,
) -> Option<Picture> {
    let analysis = impact.analysis.as_ref()?;
    let (mut drawing, mut outcomes) = (Drawing::of_impact(robot, feet, state, impact), analysis.outcomes.clone());
    drawing.face(forward);
    forward.outcomes(&mut outcomes);
    let scene = DrawnScene::new(&drawing);
    let count = analysis.outcomes.len();
    let panel = |title: String, outcome: Option<(&Outcome, &DrawnOutcome)>| Panel {
        title,
        shapes: [scene.robot(Color::Black), scene.impact(outcome)].concat(),
        ..scene.view.panel(count)
    };
    let titles = outcomes.iter().enumerate().map(|outcome| caption(impact, count > 1, outcome));
    let drawn = outcomes.iter().zip(&drawing.outcomes);
    let panels = titles.zip(drawn).map(|(title, outcome)| panel(title, Some(outcome)));
    let mut panels: Vec<Panel> = panels.collect();
    if panels.is_empty() {
        panels.push(panel(String::new(), None));
    }
    let wording = Wording::of(impact.aspect());
    let sentence = wording.verdict(analysis.verdict, &analysis.outcomes, analysis.open.as_ref());
    Some(Picture {
        title: format!("{}: {sentence}{}", words::titled(&robot.name, &state.id), forward.remark()),
        rows: panels.chunks(COLUMNS).map(<[Panel]>::to_vec).collect(),
        legend: scene.legend(),
    })
}

/// Returns the picture of the robot with its joints at zero, or where they are frozen, and with names.
pub fn robot(robot: &Robot, feet: &[NamedContact], forward: Forward) -> Picture {
    posed(robot, feet, &Placement::of_robot(robot, &vec![0.0; robot.dofs()]), forward)
}

/// Returns the picture of the robot with its bodies at `placement`, and with the names of bodies and joints.
pub fn posed(robot: &Robot, feet: &[NamedContact], placement: &Placement, forward: Forward) -> Picture {
    let mut drawing = Drawing::of_robot(robot, placement, feet);
    drawing.face(forward);
    let size = drawing.extent().size();
    let root = &drawing.bodies[0];
    let way = if forward == Forward::Along { 1.0 } else { -1.0 };
    let tip = |axis: Vector<f64>| root.world(Vector::new(way * axis.x, axis.z) * (AXES * size));
    let mut shapes = DrawnScene::new(&drawing).robot(JOINT);
    let axes = Vector::axes().map(tip);
    shapes.extend(axes.map(|tip| PlotShape::Arrow { from: point(root.origin), to: point(tip), stroke: ROOT }));
    // The names of the axes are before their tips, because other shapes may be beyond.
    let beside = Vector::axes().map(|axis| point(tip(axis * 0.85)));
    let mut names: Vec<(PlotPoint, String)> = beside.into_iter().zip(["x", "z"].map(str::to_owned)).collect();
    if robot.bodies.len() <= NAMED {
        // The root's name stands between its axes.
        let places = iter::once(tip(Vector::new(0.2, 0.2))).chain(drawing.bodies[1..].iter().map(DrawnBody::middle));
        names.extend(places.map(point).zip(robot.bodies.iter().map(|body| body.name.clone())));
    }
    shapes.push(PlotShape::Names { names, below: false, color: Color::Black });
    if robot.bodies.len() <= NAMED {
        let name = |body: &Body| match body.joint? {
            ParentJoint::Joint(joint) => Some(robot.joints[joint].name.clone()),
            ParentJoint::Mimic(mimic) => Some(robot.mimic_joints[mimic].joint.name.clone()),
            ParentJoint::Fixed { .. } => None,
        };
        let names = drawing.joints.iter().copied().map(point).zip(robot.bodies.iter().filter_map(name)).collect();
        shapes.push(PlotShape::Names { names, below: false, color: JOINT });
    }
    let Extent { low, high } = drawing.extent();
    let view = Extent::of([low, high].into_iter().chain(axes)).with_room().panel(1);
    let panel = Panel {
        x: PlotAxis { label: if way > 0.0 { "x [m]" } else { "\u{2212}x [m]" }.into(), ..view.x },
        y: PlotAxis { label: "z [m]".into(), ..view.y },
        size: (1.2 * view.size.0, 1.2 * view.size.1),
        framed: true,
        shapes,
        ..view
    };
    let counted = |count: usize, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
    let bodies = counted(robot.bodies.len(), "body", "bodies");
    let joints = counted(robot.joints.len() + robot.mimic_joints.len(), "joint", "joints");
    let axes = LegendEntry::new("axes of the root link", LegendKey::Line(ROOT));
    Picture {
        title: format!("{}: {bodies}, {joints}, {} kg", robot.name, number(robot.mass())),
        rows: vec![vec![panel]],
        legend: drawing.legend(JOINT).chain([axes]).collect(),
    }
}

fn caption(impact: &Impact, several: bool, (at, outcome): (usize, &Outcome)) -> String {
    let words = modes(impact.contacts.iter().map(|contact| &contact.name), outcome);
    let grades = Some(words::grades(outcome.margin, outcome.index)).filter(|grades| !grades.is_empty());
    let below: Vec<String> = grades.into_iter().chain(remarks(outcome, impact.aspect())).collect();
    let number = if several { format!("{}: ", at + 1) } else { String::new() };
    format!("{number}{words}\n{}", below.join(", "))
}

pub(in crate::draw) fn modes(contacts: impl IntoIterator<Item: AsRef<str>>, outcome: &Outcome) -> String {
    if outcome.modes.is_empty() { "nothing changes".to_owned() } else { words::modes(contacts, &outcome.modes) }
}

/// Returns remarks on an outcome: a border, a family, impulses that are not unique, what is undecided or not proven.
pub(in crate::draw) fn remarks(outcome: &Outcome, aspect: Aspect) -> Vec<String> {
    let border = outcome.border.as_ref().map(|border| format!("on a border: {}", words::at_zero(border)));
    let one_of_many = match aspect {
        Aspect::Impact => "one of many impulses",
        Aspect::Forces => "one of many forces",
    };
    let remarks = [
        (outcome.family, "a corner of a family"),
        (!outcome.impulse_unique, one_of_many),
        (!outcome.decided, "not excluded"),
        (outcome.decided && !outcome.proven, "not proven"),
    ];
    let remarks = remarks.into_iter().filter(|(applies, _)| *applies).map(|(_, remark)| remark.to_owned());
    border.into_iter().chain(remarks).collect()
}

impl Extent {
    /// Returns the extent with room on every side, even around a single point.
    fn with_room(self) -> Self {
        self.widened(ROOM * self.scale())
    }

    /// Returns an empty panel of this extent for a picture with `panels` panels.
    fn panel(self, panels: usize) -> Panel {
        let axis = |low: f64, high: f64| PlotAxis { range: Some((low, high)), ..PlotAxis::default() };
        let Vector { x: across, z: up } = self.high - self.low;
        let width = [560.0, 560.0, 380.0, 320.0, 280.0][panels.min(COLUMNS)];
        let height = width * (up / across).clamp(0.4, 1.25);
        let axes = Panel::new(axis(self.low.x, self.high.x), axis(self.low.z, self.high.z));
        Panel { size: (width, height), framed: false, equal: true, ..axes }
    }
}

impl DrawnBody {
    /// Returns the place of the body's name, in the world frame \[m\].
    fn middle(&self) -> Vector<f64> {
        match self.bones.first() {
            Some(end) => (self.origin + *end) * 0.5,
            None => self.com.map_or(self.origin, |com| self.world(com)),
        }
    }
}

struct DrawnScene<'d> {
    drawing: &'d Drawing,
    /// The robot's size \[m\].
    size: f64,
    /// The lengths \[m\] of arrows of 1 N s and 1 m/s, or 1 N, 1 m/s and 1 m/s^2; the same for all outcomes.
    impulse_scale: f64,
    before_scale: f64,
    after_scale: f64,
    /// The extent of the drawing, its arrows and the ground if that is near, with room around them.
    view: Extent,
}

impl<'d> DrawnScene<'d> {
    fn new(drawing: &'d Drawing) -> Self {
        let view @ Extent { low, high } = drawing.extent();
        let size = view.scale();
        let scale = |most: f64| if most > 0.0 { LONGEST * size / most } else { 0.0 };
        let impulse_scale = scale(drawing.greatest_impulse());
        let [before_scale, after_scale] = drawing.greatest_velocities().map(scale);
        let mut scene = Self { drawing, size, impulse_scale, before_scale, after_scale, view };
        let middle = 0.5 * (low.x + high.x);
        let mut pairs = drawing.ground.windows(2).map(|pair| [pair[0], pair[1]]);
        let under = pairs.find(|[from, to]| (from.x..=to.x).contains(&middle) && from.x < to.x);
        let near = under.map(|pair| between(pair, middle)).filter(|point| (low.z - size..low.z).contains(&point.z));
        let ends = scene.all_arrows().flat_map(|(from, reach, _)| [from, from + reach]);
        scene.view = Extent::of([low, high].into_iter().chain(ends).chain(near)).with_room();
        scene.view.low.z -= (BELOW - ROOM) * size;
        scene
    }

    fn all_arrows(&self) -> impl Iterator<Item = (Vector<f64>, Vector<f64>, Stroke)> {
        self.drawing.outcomes.iter().map(Some).chain([None]).flat_map(|outcome| self.arrows(outcome))
    }

    /// Returns the arrows of an outcome, or those that need no outcome: the start \[m\], the vector to the tip \[m\]
    /// and the stroke of each.
    fn arrows(&self, outcome: Option<&DrawnOutcome>) -> Vec<(Vector<f64>, Vector<f64>, Stroke)> {
        let Drawing { contacts, applied, loops, .. } = self.drawing;
        let impulse = self.impulse_scale;
        let applied = applied.iter().map(|applied| (applied.point, applied.vector * impulse, APPLIED));
        let effects = outcome.into_iter().flat_map(|outcome| {
            let impulses = outcome.impulse.iter().map(|&vector| (vector * impulse, IMPULSE));
            let after = outcome.velocity_after.iter().map(|&vector| (vector * self.after_scale, AFTER));
            let in_loops = outcome.loop_impulse.iter().map(|&(_, vector)| (vector * impulse, IN_LOOP));
            let at = contacts.iter().chain(contacts).map(|contact| contact.point).chain(loops.iter().copied());
            at.zip(impulses.chain(after).chain(in_loops)).map(|(point, (reach, stroke))| (point, reach, stroke))
        });
        let effects: Vec<_> = effects.collect();
        // A velocity before ends where the other arrows begin, or next to that point if one of them or the ground lies
        // along it.
        let before = contacts.iter().map(|contact| {
            let reach = contact.velocity_before * self.before_scale;
            let (way, across) = (reach.length(), reach.perpendicular());
            let is_along = |other: &Vector<f64>| {
                reach.dot(*other) < 0.0 && across.dot(*other).abs() < ALONG * way * other.length()
            };
            let mut there = effects.iter().filter(|(point, ..)| *point == contact.point).map(|(_, other, _)| *other);
            let away = |other| across * (-across.dot(other).signum() * ASIDE * self.size / way);
            let aside = match there.find(is_along) {
                _ if reach.dot(contact.normal).abs() < ALONG * way => contact.normal * (ASIDE * self.size),
                other => other.map_or(Vector::zero(), away),
            };
            (contact.point - reach + aside, reach, BEFORE)
        });
        applied.chain(effects.iter().copied()).chain(before).collect()
    }

    /// Returns the ground and the robot's shapes, bones, joints and CoGs.
    fn robot(&self, joint: Color) -> Vec<PlotShape> {
        let Drawing { bodies, ground, joints, loops, .. } = self.drawing;
        let mut shapes = Vec::new();
        if let ([.., right], [left, ..]) = (&ground[..], &ground[..]) {
            let depth = self.view.low.z.min(left.z).min(right.z) - 10.0 * self.size;
            let below = [(right.x, depth), (left.x, depth)];
            let surface: Vec<PlotPoint> = ground.iter().copied().map(point).collect();
            let soil = surface.iter().copied().chain(below).collect();
            shapes.push(PlotShape::Area { loops: vec![soil], fill: Some(Color::Pale), stroke: None });
            shapes.push(PlotShape::Line { points: surface, stroke: SURFACE });
        }
        for body in bodies {
            let fill = Some(if body.is_last { LAST } else { INNER });
            let at = |local: &Vector<f64>| point(body.world(*local));
            shapes.extend(body.shapes.iter().map(|shape| match shape {
                DrawnShape::Disc { center, radius: 0.0 } => {
                    let points = vec![at(center)];
                    PlotShape::Marks { points, mark: Mark::Circle, color: BONE.color, size: BONE.width }
                }
                DrawnShape::Disc { center, radius } => {
                    PlotShape::Circle { center: at(center), radius: *radius, fill, stroke: Some(EDGE) }
                }
                DrawnShape::Polygon(corners) => {
                    PlotShape::Area { loops: vec![corners.iter().map(at).collect()], fill, stroke: Some(EDGE) }
                }
            }));
        }
        for (body, end) in bodies.iter().flat_map(|body| body.bones.iter().map(move |end| (body, end))) {
            shapes.push(PlotShape::Line { points: vec![point(body.origin), point(*end)], stroke: BONE });
        }
        let heaviest = bodies.iter().map(|body| body.mass).fold(0.0, f64::max);
        for body in bodies {
            let Some(com) = body.com else { continue };
            let size = LIGHT + (HEAVY - LIGHT) * libm::sqrt(body.mass / heaviest);
            let points = vec![point(body.world(com))];
            shapes.push(PlotShape::Marks { points, mark: Mark::Center, color: Color::Black, size });
        }
        for (points, color) in [(joints, joint), (loops, IN_LOOP.color)] {
            let points = points.iter().copied().map(point).collect();
            shapes.push(PlotShape::Marks { points, mark: Mark::Ring, color, size: 3.6 });
        }
        shapes
    }

    /// Returns the contacts, and the arrows of an outcome.
    fn impact(&self, outcome: Option<(&Outcome, &DrawnOutcome)>) -> Vec<PlotShape> {
        let contacts = &self.drawing.contacts;
        let normal = |contact: &DrawnContact| {
            let ends = [contact.point, contact.point + contact.normal * (SHORT * self.size)];
            PlotShape::Line { points: ends.map(point).to_vec(), stroke: NORMAL }
        };
        let mut shapes: Vec<PlotShape> = contacts.iter().map(normal).collect();
        let points = contacts.iter().map(|contact| point(contact.point)).collect();
        shapes.push(PlotShape::Marks { points, mark: Mark::Circle, color: Color::Black, size: 3.0 });
        shapes.extend(self.arrows(outcome.map(|(_, drawn)| drawn)).into_iter().map(|(from, reach, stroke)| {
            let (from, to) = (point(from), point(from + reach));
            PlotShape::Arrow { from, to, stroke }
        }));
        let small = |at: usize| outcome.and_then(|(outcome, drawn)| self.small(outcome, drawn, at));
        let name = |(small, alike): (Option<String>, Vec<usize>)| {
            (point(contacts[alike[0]].point), self.joined(&alike) + &small.unwrap_or_default())
        };
        let alike = |place: Vec<usize>| words::grouped(place.into_iter().map(|at| (small(at), at)));
        let mut names: Vec<_> = self.places().into_iter().flat_map(alike).collect();
        // The long names, with a velocity, are placed first, which keeps them near their points.
        names.sort_by_key(|(small, _)| small.is_none());
        let names = names.into_iter().map(name).collect();
        shapes.push(PlotShape::Names { names, below: true, color: Color::Black });
        shapes.extend(outcome.into_iter().flat_map(|(_, drawn)| self.shared(drawn)));
        let pushed = outcome.into_iter().flat_map(|(_, drawn)| self.drawing.loops.iter().zip(&drawn.loop_impulse));
        let names = pushed.map(|(at, (link, vector))| (point(*at + *vector * self.impulse_scale), link.clone()));
        shapes.push(PlotShape::Names { names: names.collect(), below: false, color: IN_LOOP.color });
        shapes
    }

    /// Groups the contacts by place: a left and a right foot may be at the same place.
    fn places(&self) -> Vec<Vec<usize>> {
        let contacts = &self.drawing.contacts;
        self.together(0..contacts.len(), |at| contacts[at].point)
    }

    /// Groups the numbers whose points are at one place.
    fn together(&self, numbers: impl Iterator<Item = usize>, at: impl Fn(usize) -> Vector<f64>) -> Vec<Vec<usize>> {
        let mut places: Vec<Vec<usize>> = Vec::new();
        for number in numbers {
            match places.iter_mut().find(|place| (at(place[0]) - at(number)).length() < HAIR * self.size) {
                Some(place) => place.push(number),
                None => places.push(vec![number]),
            }
        }
        places
    }

    /// Returns the names of contacts in one line, as many as fit.
    fn joined(&self, contacts: &[usize]) -> String {
        let names: Vec<&str> = contacts.iter().map(|&at| &*self.drawing.contacts[at].name).collect();
        words::list(&names, (LETTERS * self.view.panel(self.drawing.outcomes.len()).size.0) as usize)
    }

    /// Returns the labels at the tips of arrows of contacts at one place: the number of equal impulses, or the contacts
    /// whose arrow it is.
    fn shared(&self, drawn: &DrawnOutcome) -> [PlotShape; 2] {
        let kinds = [(&drawn.impulse, self.impulse_scale, IMPULSE), (&drawn.velocity_after, self.after_scale, AFTER)];
        kinds.map(|(vectors, scale, stroke)| {
            let reach = |at: usize| vectors.get(at).map_or(Vector::zero(), |vector| *vector * scale);
            let mut names = Vec::new();
            for place in self.places() {
                for alike in self.together(place.iter().copied(), reach) {
                    let (reach, count) = (reach(alike[0]), alike.len());
                    let name = match count == place.len() {
                        false => self.joined(&alike),
                        true if count > 1 && stroke == IMPULSE => format!("{count} \u{d7}"),
                        true => continue,
                    };
                    if reach.length() >= SEEN * self.size {
                        names.push((point(self.drawing.contacts[place[0]].point + reach), name));
                    }
                }
            }
            PlotShape::Names { names, below: false, color: stroke.color }
        })
    }

    /// Returns the velocity after of a contact as text if it is not zero but too small for an arrow.
    fn small(&self, outcome: &Outcome, drawn: &DrawnOutcome, contact: usize) -> Option<String> {
        let speed = drawn.velocity_after.get(contact)?.length();
        let sign = match outcome.modes.get(contact)? {
            Mode::Separate => '\u{2191}',
            Mode::SlidePlus => '\u{2192}',
            Mode::SlideMinus => '\u{2190}',
            Mode::Stick => return None,
        };
        let unit = Wording::of(self.drawing.aspect).drawn.taken.1;
        let is_small = speed > 0.0 && speed * self.after_scale < SEEN * self.size;
        is_small.then(|| format!(" {sign} {} {unit}", number(significant(speed, 3))))
    }

    /// Returns the legend: an arrow of a round length for each kind of arrow, and the other symbols.
    fn legend(&self) -> Vec<LegendEntry> {
        let arrows: Vec<_> = self.all_arrows().collect();
        let is_drawn = |stroke: Stroke| {
            arrows.iter().any(|(_, reach, drawn)| *drawn == stroke && (stroke == APPLIED || *reach != Vector::zero()))
        };
        let DrawnNames { given, taken, moving, .. } = Wording::of(self.drawing.aspect).drawn;
        let is_small = |reach: Vector<f64>| reach != Vector::zero() && reach.length() < SEEN * self.size;
        let small = arrows.iter().any(|(_, reach, stroke)| *stroke == AFTER && is_small(*reach));
        let is_count = |(_, name): &(_, String)| name.ends_with('\u{d7}');
        let counts =
            |drawn| matches!(self.shared(drawn), [PlotShape::Names { names, .. }, _] if names.iter().any(is_count));
        let shared = self.drawing.outcomes.iter().any(counts);
        let kinds = [
            (IMPULSE, self.impulse_scale, given.1, format!("{} of the ground", given.0)),
            (APPLIED, self.impulse_scale, given.1, format!("applied {}", given.0)),
            (IN_LOOP, self.impulse_scale, given.1, format!("{} in a loop, on the link at its tip", given.0)),
            (AFTER, self.after_scale, taken.1, taken.0.to_owned()),
            (BEFORE, self.before_scale, "m/s", format!("{moving}, toward the contact")),
        ];
        let drawn = kinds.into_iter().filter(|(stroke, ..)| is_drawn(*stroke));
        let entries = drawn.filter_map(|(stroke, scale, unit, what)| {
            let round = round(KEY * self.size / scale)?;
            let key = LegendKey::Arrow { stroke, length: round * scale };
            let remark = match stroke {
                AFTER if small => "\n(\u{2190} \u{2192} \u{2191}: too small for an arrow)",
                IMPULSE if shared => "\n(2 \u{d7}: on each of so many contacts at one place)",
                _ => "",
            };
            Some(LegendEntry::new(format!("{what}: {round} {unit}{remark}"), key))
        });
        let contacts = !self.drawing.contacts.is_empty();
        let signs = [
            (contacts, LegendKey::Mark(Mark::Circle, Color::Black), "contact"),
            (contacts, LegendKey::Line(NORMAL), "normal of the ground"),
        ];
        let length =
            round(KEY * self.size).map(|round| LegendEntry::new(format!("{round} m"), LegendKey::Length(round)));
        entries.chain(entries_of(signs)).chain(self.drawing.legend(Color::Black)).chain(length).collect()
    }
}

/// Returns the entries whose symbols are drawn.
fn entries_of<const N: usize>(entries: [(bool, LegendKey, &'static str); N]) -> impl Iterator<Item = LegendEntry> {
    entries.into_iter().filter(|(is_drawn, ..)| *is_drawn).map(|(_, key, name)| LegendEntry::new(name, key))
}

impl Drawing {
    /// Mirrors the drawing if forward is along -x.
    pub(in crate::draw) fn face(&mut self, forward: Forward) {
        if forward == Forward::Along {
            return;
        }
        for DrawnBody { origin, x_axis, shapes, com, bones, .. } in &mut self.bodies {
            // The frame turns the other way, and the points in it are mirrored.
            x_axis.z = -x_axis.z;
            let corners = shapes.iter_mut().flat_map(|shape| match shape {
                DrawnShape::Disc { center, .. } => std::slice::from_mut(center),
                DrawnShape::Polygon(corners) => corners,
            });
            iter::once(origin).chain(corners).chain(com).chain(bones).for_each(Forward::vector);
        }
        for DrawnContact { point, normal, velocity_before, .. } in &mut self.contacts {
            [point, normal, velocity_before].into_iter().for_each(Forward::vector);
        }
        for Arrow { point, vector } in &mut self.applied {
            [point, vector].into_iter().for_each(Forward::vector);
        }
        for outcome in &mut self.outcomes {
            outcome.impulse.iter_mut().chain(&mut outcome.velocity_after).for_each(Forward::vector);
            outcome.loop_impulse.iter_mut().for_each(|(_, impulse)| Forward::vector(impulse));
        }
        self.joints.iter_mut().chain(&mut self.loops).chain(&mut self.ground).for_each(Forward::vector);
        self.ground.reverse();
    }

    /// Returns the entries for a robot's symbols; its joints have this color.
    fn legend(&self, joint: Color) -> impl Iterator<Item = LegendEntry> {
        let is_point = |shape: &DrawnShape| matches!(shape, DrawnShape::Disc { radius: 0.0, .. });
        let is_shaped = |body: &DrawnBody| !body.shapes.iter().all(is_point);
        let shaped = |last: bool| self.bodies.iter().any(|body| body.is_last == last && is_shaped(body));
        entries_of([
            (!self.joints.is_empty(), LegendKey::Mark(Mark::Ring, joint), "joint"),
            (!self.loops.is_empty(), LegendKey::Mark(Mark::Ring, IN_LOOP.color), "point of a loop"),
            (true, LegendKey::Mark(Mark::Center, Color::Black), "CoG, area by mass"),
            (shaped(true), LegendKey::Fill(LAST), "outermost body"),
            (shaped(false), LegendKey::Fill(INNER), "inner body"),
        ])
    }
}

/// Returns the greatest of ..., 1, 2, 5, 10, ... that is not above `most`; `None` unless `most` is positive and finite.
fn round(most: f64) -> Option<f64> {
    if !(most > 0.0 && most.is_finite()) {
        return None;
    }
    let unit = libm::pow(10.0, libm::floor(libm::log10(most)));
    [5.0, 2.0, 1.0].map(|times| times * unit).into_iter().find(|round| *round <= most)
}

fn point(Vector { x, z }: Vector<f64>) -> PlotPoint {
    (x, z)
}
