//! A robot in its pose as a picture: one panel per outcome, or the robot alone with its names.

use super::{Body, Drawing, Effect, Extent, Outline};
use crate::contact::Placement;
use crate::draw::plot::{
    Arrangement, Color, Dash, Legend, LegendEntry, LegendKey, Mark, Panel, Picture, PlotAxis, PlotPoint, Shape, Stroke,
};
use crate::impact::outcome::Outcome;
use crate::pipeline::Impact;
use crate::planar::Vector;
use crate::robot::Robot;
use crate::state::NamedContact;
use crate::state::State;
use crate::write::text::table::number;
use crate::write::words;

const IMPULSE: Stroke = Stroke::solid(Color::Vermilion, 3.0);
const APPLIED: Stroke = Stroke { dash: Dash::Dotted, ..Stroke::solid(Color::Purple, 3.0) };
const AFTER: Stroke = Stroke::solid(Color::Blue, 2.2);
const BEFORE: Stroke = Stroke { dash: Dash::Dashed, ..Stroke::solid(Color::Black, 1.4) };
const BONE: Stroke = Stroke::solid(Color::Gray, 4.0);
const EDGE: Stroke = Stroke::solid(Color::Gray, 0.8);
const SURFACE: Stroke = Stroke::solid(Color::Black, 1.6);
const NORMAL: Stroke = Stroke { dash: Dash::Dotted, ..Stroke::solid(Color::Black, 1.0) };
/// What nothing hangs on, feet and hands.
const LAST: Color = Color::Tint(1);
const SHAPE: Color = Color::Tint(0);

/// Panels side by side.
const COLUMNS: usize = 4;
/// Of the robot's size: about all that is drawn, the normal of a contact, the axes of the root.
const ROOM: f64 = 0.06;
const SHORT: f64 = 0.08;
const AXES: f64 = 0.18;
/// The most that an arrow of the legend has of it.
const KEY: f64 = 0.3;
/// Half the width of a CoG's sign, of the lightest and the heaviest body \[px\].
const LIGHT: f64 = 2.5;
const HEAVY: f64 = 8.0;
/// More bodies have no names.
const NAMED: usize = 60;

/// A state with an arrow for each impulse and velocity, a panel for each outcome; `feet` are those beside the robot's own
/// shapes. None where the outcomes were refused.
pub fn impact(robot: &Robot, feet: &[NamedContact], state: &State, impact: &Impact) -> Option<Picture> {
    let analysis = impact.analysis.as_ref().ok()?;
    let drawing = Drawing::of_impact(robot, feet, state, impact);
    let view = drawing.view();
    let captions: Vec<String> = analysis.outcomes.iter().enumerate().map(|outcome| caption(impact, outcome)).collect();
    let panel = |title: &String, effect: Option<&Effect>| Panel {
        title: title.clone(),
        shapes: [drawing.scene(), drawing.happening(effect)].concat(),
        ..view.panel(captions.len())
    };
    let panels: Vec<Panel> = match &captions[..] {
        [] => vec![panel(&String::new(), None)],
        captions => captions.iter().zip(&drawing.outcomes).map(|(title, effect)| panel(title, Some(effect))).collect(),
    };
    let sentence = words::verdict(analysis.verdict, analysis.outcomes.len());
    Some(Picture {
        title: format!("{}: {sentence}", words::titled(&robot.name, &state.id)),
        rows: panels.chunks(COLUMNS).map(<[Panel]>::to_vec).collect(),
        legend: Legend { entries: drawing.legend(), arrangement: Arrangement::Rows },
    })
}

/// The robot with its joints at zero, or where they are held, and its names; `feet` are those beside its own shapes.
pub fn robot(robot: &Robot, feet: &[NamedContact]) -> Picture {
    let placement = Placement::of_robot(robot, &vec![0.0; robot.dofs()]);
    let drawing = Drawing::of_robot(robot, &placement, feet);
    let size = drawing.extent().size();
    let root = placement.world(0, Vector::zero());
    let tip = |axis: Vector<f64>| root + placement.turned(0, axis * (AXES * size));
    let mut shapes = drawing.scene();
    let axes = Vector::axes().map(tip);
    shapes.extend(axes.map(|tip| Shape::Arrow { from: point(root), to: point(tip), stroke: AFTER }));
    let mut names: Vec<(PlotPoint, String)> =
        axes.into_iter().map(point).zip(["x".to_owned(), "z".to_owned()]).collect();
    if robot.bodies.len() <= NAMED {
        // The root's name stands between its axes.
        let places = [tip(Vector::new(0.2, 0.2))].into_iter().chain(drawing.bodies.iter().skip(1).map(Body::middle));
        names.extend(places.map(point).zip(robot.bodies.iter().map(|body| body.name.clone())));
    }
    shapes.push(Shape::Names { names, below: false });
    let axis = |label: &str, range| PlotAxis { label: label.into(), range, ..PlotAxis::default() };
    let Extent { low, high } = drawing.extent();
    let view = Extent::of([low, high].into_iter().chain(axes)).with_room().panel(1);
    let panel = Panel {
        x: axis("x [m]", view.x.range),
        y: axis("z [m]", view.y.range),
        size: (1.2 * view.size.0, 1.2 * view.size.1),
        framed: true,
        shapes,
        ..view
    };
    let joints = robot.joints.len() + robot.followers.len();
    let shaped = |last: bool| drawing.bodies.iter().any(|body| body.last == last && !body.outlines.is_empty());
    let entries = [
        (joints > 0, LegendKey::Mark(Mark::Ring, Color::Black), "joint"),
        (true, LegendKey::Mark(Mark::Center, Color::Black), "CoG, its area by mass"),
        (shaped(true), LegendKey::Fill(LAST), "shape of an outermost body"),
        (shaped(false), LegendKey::Fill(SHAPE), "shape of an inner body"),
        (true, LegendKey::Line(AFTER), "axes of the root link"),
    ];
    let entry =
        |(is_drawn, key, name): (bool, LegendKey, &str)| is_drawn.then(|| LegendEntry { name: name.into(), key });
    Picture {
        title: format!("{}: {} bodies, {joints} joints, {} kg", robot.name, robot.bodies.len(), number(robot.mass())),
        rows: vec![vec![panel]],
        legend: Legend { entries: entries.into_iter().filter_map(entry).collect(), arrangement: Arrangement::Rows },
    }
}

/// What happens, and then how sure that is.
fn caption(impact: &Impact, (at, outcome): (usize, &Outcome)) -> String {
    let names = impact.contacts.iter().map(|contact| contact.name.as_str());
    let modes = match outcome.modes[..] {
        [] => "nothing changes".to_owned(),
        _ => words::modes(names, &outcome.modes),
    };
    let marks = [
        (outcome.border.is_some(), "on a border"),
        (outcome.family, "the end of a family"),
        (!outcome.decided, "not excluded"),
        (outcome.decided && !outcome.proven, "not proven"),
    ];
    let grades = words::grades(outcome.margin, outcome.index);
    let marks = marks.into_iter().filter_map(|(applies, name)| applies.then_some(name));
    let below: Vec<&str> = Some(grades.as_str()).filter(|grades| !grades.is_empty()).into_iter().chain(marks).collect();
    let number = if impact.velocity_after.len() > 1 { format!("{}: ", at + 1) } else { String::new() };
    format!("{number}{modes}\n{}", below.join(", "))
}

impl Extent {
    /// With room about all that is drawn; about a point, too.
    fn with_room(self) -> Self {
        self.widened(ROOM * Some(self.size()).filter(|&size| size > 0.0).unwrap_or(1.0))
    }

    /// An empty panel of this extent, of so many.
    fn panel(self, panels: usize) -> Panel {
        let axis = |low: f64, high: f64| PlotAxis { range: Some((low, high)), ..PlotAxis::default() };
        let [across, up] = [self.high.x - self.low.x, self.high.z - self.low.z];
        let width = [460.0, 460.0, 380.0, 320.0, 280.0][panels.min(COLUMNS)];
        let height = width * (up / across).clamp(0.4, 1.5);
        Panel {
            size: (width, height),
            framed: false,
            equal: true,
            ..Panel::new(axis(self.low.x, self.high.x), axis(self.low.z, self.high.z))
        }
    }
}

impl Body {
    /// Where its name belongs.
    fn middle(&self) -> Vector<f64> {
        match self.bones.first() {
            Some(end) => (self.origin + *end) * 0.5,
            None => self.com.unwrap_or(self.origin),
        }
    }
}

impl Drawing {
    /// All that is drawn, with every arrow and the ground where it is near, and room about it.
    fn view(&self) -> Extent {
        let Extent { low, high } = self.extent();
        let size = self.extent().size();
        let near = self.below(0.5 * (low.x + high.x)).filter(|Vector { z, .. }| (low.z - size..low.z).contains(z));
        let tips = self.contacts.iter().enumerate().flat_map(|(at, contact)| {
            let tip = |scale: f64, vector: Vector<f64>| contact.point + vector * scale;
            let effects = self.outcomes.iter().flat_map(move |outcome| {
                let impulse = outcome.impulse.get(at).map(|&vector| tip(self.impulse_scale, vector));
                let velocity = outcome.velocity_after.get(at).map(|&vector| tip(self.velocity_scale, vector));
                impulse.into_iter().chain(velocity)
            });
            effects.chain([tip(self.velocity_scale, contact.velocity_before)])
        });
        let applied = self.applied.iter().map(|arrow| arrow.point + arrow.vector * self.impulse_scale);
        let whole = Extent::of([low, high].into_iter().chain(tips).chain(applied).chain(near));
        whole.with_room()
    }

    /// The ground at a place; none beside its ends.
    fn below(&self, x: f64) -> Option<Vector<f64>> {
        self.ground.windows(2).find_map(|pair| match *pair {
            [Vector { x: x0, z: z0 }, Vector { x: x1, z: z1 }] if (x0..=x1).contains(&x) && x0 < x1 => {
                Some(Vector::new(x, z0 + (x - x0) / (x1 - x0) * (z1 - z0)))
            }
            _ => None,
        })
    }

    /// The ground, the robot's shapes, bones, joints and CoGs.
    fn scene(&self) -> Vec<Shape> {
        let mut shapes = Vec::new();
        if let ([.., right], [left, ..]) = (&self.ground[..], &self.ground[..]) {
            let depth = self.view().low.z.min(left.z).min(right.z) - 10.0 * self.extent().size();
            let below = [(right.x, depth), (left.x, depth)];
            let surface: Vec<PlotPoint> = self.ground.iter().copied().map(point).collect();
            let soil = surface.iter().copied().chain(below).collect();
            shapes.push(Shape::Area { loops: vec![soil], fill: Some(Color::Pale), stroke: None });
            shapes.push(Shape::Line { points: surface, stroke: SURFACE });
        }
        for body in &self.bodies {
            let fill = Some(if body.last { LAST } else { SHAPE });
            shapes.extend(body.outlines.iter().map(|outline| match outline {
                Outline::Disc { center, radius: 0.0 } => Shape::Marks {
                    points: vec![point(*center)],
                    mark: Mark::Circle,
                    color: BONE.color,
                    size: BONE.width,
                },
                &Outline::Disc { center, radius } => {
                    Shape::Circle { center: point(center), radius, fill, stroke: Some(EDGE) }
                }
                Outline::Polygon(corners) => {
                    let corners = corners.iter().copied().map(point).collect();
                    Shape::Area { loops: vec![corners], fill, stroke: Some(EDGE) }
                }
            }));
        }
        for body in &self.bodies {
            let bone = |end: &Vector<f64>| vec![point(body.origin), point(*end)];
            shapes.extend(body.bones.iter().map(|end| Shape::Line { points: bone(end), stroke: BONE }));
        }
        let heaviest = self.bodies.iter().map(|body| body.mass).fold(0.0, f64::max);
        for body in &self.bodies {
            let Some(com) = body.com else { continue };
            let size = LIGHT + (HEAVY - LIGHT) * libm::sqrt(body.mass / heaviest);
            shapes.push(Shape::Marks { points: vec![point(com)], mark: Mark::Center, color: Color::Black, size });
        }
        let joints = self.joints.iter().copied().map(point).collect();
        shapes.push(Shape::Marks { points: joints, mark: Mark::Ring, color: Color::Black, size: 3.6 });
        shapes
    }

    /// What the contacts do.
    fn happening(&self, effect: Option<&Effect>) -> Vec<Shape> {
        let size = self.extent().size();
        let arrow = |at: Vector<f64>, scale: f64, vector: Vector<f64>, stroke: Stroke| Shape::Arrow {
            from: point(at),
            to: point(at + vector * scale),
            stroke,
        };
        let mut shapes = Vec::new();
        for contact in &self.contacts {
            let ends = [contact.point, contact.point + contact.normal * (SHORT * size)];
            shapes.push(Shape::Line { points: ends.map(point).to_vec(), stroke: NORMAL });
        }
        let points = self.contacts.iter().map(|contact| point(contact.point)).collect();
        shapes.push(Shape::Marks { points, mark: Mark::Circle, color: Color::Black, size: 3.0 });
        for applied in &self.applied {
            shapes.push(arrow(applied.point, self.impulse_scale, applied.vector, APPLIED));
        }
        if let Some(effect) = effect {
            for (contact, &impulse) in self.contacts.iter().zip(&effect.impulse) {
                shapes.push(arrow(contact.point, self.impulse_scale, impulse, IMPULSE));
            }
            for (contact, &velocity) in self.contacts.iter().zip(&effect.velocity_after) {
                shapes.push(arrow(contact.point, self.velocity_scale, velocity, AFTER));
            }
        }
        // On top, because it may be the velocity after, too.
        for contact in &self.contacts {
            shapes.push(arrow(contact.point, self.velocity_scale, contact.velocity_before, BEFORE));
        }
        let names = self.contacts.iter().map(|contact| (point(contact.point), contact.name.clone())).collect();
        shapes.push(Shape::Names { names, below: true });
        shapes
    }

    /// What the arrows are, with a round one for each scale.
    fn legend(&self) -> Vec<LegendEntry> {
        let key = |stroke: Stroke, scale: f64, unit: &str, what: &str| {
            let round = round(KEY * self.extent().size() / scale)?;
            let name = format!("{what}: {round} {unit}");
            Some(LegendEntry { name, key: LegendKey::Arrow { stroke, length: round * scale } })
        };
        let has = |vectors: &[Vector<f64>]| vectors.iter().any(|vector| *vector != Vector::zero());
        let struck = self.outcomes.iter().any(|outcome| has(&outcome.impulse));
        let moving = self.outcomes.iter().any(|outcome| has(&outcome.velocity_after));
        let moved = self.contacts.iter().any(|contact| contact.velocity_before != Vector::zero());
        let arrows = [
            (struck, IMPULSE, self.impulse_scale, "N s", "impulse of the ground"),
            (!self.applied.is_empty(), APPLIED, self.impulse_scale, "N s", "applied impulse"),
            (moving, AFTER, self.velocity_scale, "m/s", "velocity after"),
            (moved, BEFORE, self.velocity_scale, "m/s", "velocity before"),
        ];
        let arrows = arrows.into_iter().filter(|(is_drawn, ..)| *is_drawn);
        let mut entries: Vec<LegendEntry> =
            arrows.filter_map(|(_, stroke, scale, unit, what)| key(stroke, scale, unit, what)).collect();
        if self.contacts.is_empty() {
            return entries;
        }
        entries.push(LegendEntry { name: "contact".into(), key: LegendKey::Mark(Mark::Circle, Color::Black) });
        entries
    }
}

/// The greatest of 1, 2, 5, 10 ... that is not greater; none of what is not positive.
fn round(most: f64) -> Option<f64> {
    if !(most > 0.0 && most.is_finite()) {
        return None;
    }
    let unit = libm::pow(10.0, libm::floor(libm::log10(most)));
    [5.0, 2.0, 1.0].into_iter().map(|times| times * unit).find(|round| *round <= most)
}

fn point(Vector { x, z }: Vector<f64>) -> PlotPoint {
    (x, z)
}
