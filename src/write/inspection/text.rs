//! The reduced planar robot as text that fits a screen. What a user needs to trust the model comes first, and long
//! lists are cut.

use super::{Inspection, JointRecord, MimicRecord};
use crate::error::visible;
use crate::planar::Vector;
use crate::robot::FreezeReason;
use crate::write::table::{Table, number, scale};
use crate::write::{Palette, words, written};
use std::collections::HashSet;
use std::fmt::Write;

/// The width of the head's lines, in characters.
const WIDTH: usize = 118;
/// The column at which the head's text begins, after the labels.
const INDENT: usize = 15;
/// The room for a list of names, in characters.
const NAMES: usize = 300;
/// The room for the feet of one shape, and for the feet of all shapes, in characters.
const FEET: usize = 200;
const SHAPES: usize = 600;
/// The number of lines that fit a screen.
const SCREEN: usize = 40;
/// The number of lines of a section that are always shown: a blank line, the title, the heads of the columns, one row.
const LEAST: usize = 4;
/// The room for the links of a body, in characters.
const LINKS: usize = 50;

impl Inspection<'_> {
    /// Returns the description as text that ends with a line break: all of it, or what fits a screen.
    pub fn text(&self, palette: &Palette, all: bool) -> String {
        let head = written(|out| self.head(palette, all, out));
        let bodies = written(|out| self.bodies(palette, out));
        let joints = written(|out| self.joints(palette, out));
        let left_out = written(|out| self.left_out(palette, out));
        let sections = [bodies, joints, left_out];
        let lengths = sections.each_ref().map(|section| section.lines().count());
        let mut shown = lengths;
        let above = head.lines().count();
        let height = |shown: &[usize]| {
            let cut = shown.iter().zip(lengths).filter(|(shown, length)| *shown < length).count();
            above + shown.iter().sum::<usize>() + cut
        };
        let is_cut = !all && height(&shown) > SCREEN;
        while is_cut && height(&shown) + 1 > SCREEN {
            let Some(longest) = shown.iter_mut().max().filter(|shown| **shown > LEAST) else { break };
            *longest -= 1;
        }
        let mut out = head;
        for ((section, shown), length) in sections.iter().zip(shown).zip(lengths) {
            section.lines().take(shown).for_each(|line| out.extend([line, "\n"]));
            if shown < length {
                out += &format!("  ... {} more lines\n", length - shown);
            }
        }
        let Palette { faint, plain, .. } = *palette;
        if is_cut { format!("{out}{faint}The rest: `all`{plain}\n") } else { out }
    }

    fn head(&self, palette: &Palette, all: bool, out: &mut String) -> std::fmt::Result {
        let Palette { strong, plain, .. } = *palette;
        writeln!(out, "{strong}{}{plain}", visible(self.name))?;
        for caution in self.cautions {
            write!(out, "{strong}")?;
            entry("caution", caution, out)?;
            write!(out, "{plain}")?;
        }
        entry("plane", &format!("{}: {}", self.plane_in_words(), self.plane_because), out)?;
        entry("mass", &format!("{} kg", number(self.mass)), out)?;
        let root = self.bodies.first().map_or("", |body| body.name);
        let base = match self.base {
            "floating" => format!("floating: x, z, pitch of the root link {root}; {}", self.base_because),
            _ => format!("fixed: the root link {root} is bolted to the world; {}", self.base_because),
        };
        entry("base", &base, out)?;
        entry("joints", &self.joints_in_words(), out)?;
        entry("coordinates", &format!("{}: {}", self.coordinates.len(), self.coordinates.join(", ")), out)?;
        entry("feet", &self.feet_in_words(all), out)
    }

    fn hinges(&self) -> impl Iterator<Item = &JointRecord<'_>> + Clone {
        self.joints.iter().chain(self.followers.iter().map(|follower| &follower.joint))
    }

    /// The largest coordinate of a point in the tables \[m\].
    fn lengths(&self) -> f64 {
        let points = self.bodies.iter().map(|body| body.com).chain(self.hinges().map(|joint| joint.origin));
        scale(points.flat_map(Vector::components))
    }

    fn bodies(&self, palette: &Palette, out: &mut String) -> std::fmt::Result {
        let Palette { strong, plain, .. } = *palette;
        writeln!(out, "\n{strong}bodies{plain}")?;
        let (bodies, lengths) = (&self.bodies, self.lengths());
        let moments = scale(bodies.iter().map(|body| body.moment));
        Table::default()
            .text("body", bodies.iter().map(|body| body.name))
            .numbers("mass [kg]", self.mass, bodies.iter().map(|body| body.mass))
            .pairs(["CoG x [m]", "z [m]"], lengths, bodies.iter().map(|body| body.com.components()))
            .numbers("moment [kg m^2]", moments, bodies.iter().map(|body| body.moment))
            .text("links", bodies.iter().map(|body| words::list(&body.links, LINKS)))
            .write(out);
        Ok(())
    }

    fn joints(&self, palette: &Palette, out: &mut String) -> std::fmt::Result {
        let Palette { strong, plain, .. } = *palette;
        let (joints, lengths, hinges) = (&self.joints, self.lengths(), || self.hinges());
        if hinges().next().is_some() {
            writeln!(out, "\n{strong}joints{plain}")?;
            let law = |&MimicRecord { mimicked, multiplier, offset, .. }: &MimicRecord| {
                let offset = if offset == 0.0 { String::new() } else { format!(" + {}", number(offset)) };
                format!(" as {} {mimicked}{offset}", number(multiplier))
            };
            let laws = joints.iter().map(|_| String::new()).chain(self.followers.iter().map(law));
            Table::default()
                .text("joint", hinges().map(|joint| joint.name))
                .text("motion", hinges().zip(laws).map(|(joint, law)| self.motion(joint) + &law))
                .text("from", hinges().map(|joint| joint.parent))
                .text("to", hinges().map(|joint| joint.child))
                .pairs(["origin x [m]", "z [m]"], lengths, hinges().map(|joint| joint.origin.components()))
                .write(out);
        }
        Ok(())
    }

    fn left_out(&self, palette: &Palette, out: &mut String) -> std::fmt::Result {
        let Palette { strong, plain, .. } = *palette;
        let massless: Vec<&str> = self.links.iter().filter(|link| !link.has_inertial).map(|link| link.name).collect();
        if !massless.is_empty() {
            writeln!(out, "\nWithout inertial, so massless: {}", words::list(&massless, NAMES))?;
        }
        let left_out = self.left_out_by_reason();
        if !left_out.is_empty() {
            writeln!(out, "\n{strong}left out{plain}")?;
            for (why, what) in left_out {
                wrapped("  ", 6, &format!("{why}: {}", words::list(&what, NAMES)), out)?;
            }
        }
        Ok(())
    }

    fn plane_in_words(&self) -> String {
        let (forward, up) = self.plane.split_at(1);
        format!("{forward}-{up}: {forward} forward, {up} up, pitch about {} (nose down)", self.normal)
    }

    /// Describes the motion of a joint; a revolute one turns about an axis of the file's root frame.
    fn motion(&self, joint: &JointRecord) -> String {
        let Some(sign) = joint.sign else {
            let Vector { x, z } = joint.direction.unwrap_or_default();
            return format!("slides along ({}, {})", number(x), number(z));
        };
        let (along, letter) = self.normal.split_at(1);
        format!("turns about {}{letter}", if (sign < 0.0) == (along == "+") { '-' } else { '+' })
    }

    fn joints_in_words(&self) -> String {
        let frozen = |because: FreezeReason| self.held.iter().filter(|held| *held.reason == because).count();
        let (fixed, base) = (frozen(FreezeReason::Fixed), frozen(FreezeReason::Base));
        let parts = [
            (self.joints.len(), "kept"),
            (self.followers.len(), "kept as mimic joints"),
            (self.held.len() - fixed - base, "frozen"),
            (base, "part of the base"),
            (fixed, "fixed"),
        ];
        let parts = parts.iter().filter(|(count, what)| *count > 0 || *what == "kept");
        parts.map(|(count, what)| format!("{count} {what}")).collect::<Vec<_>>().join(", ")
    }

    /// Lists the feet grouped by shape, in the order in which the shapes first occur: all of them, or what fits.
    fn feet_in_words(&self, all: bool) -> String {
        if self.feet.is_empty() {
            return "none: name them by `feet`, or in each state by \"contacts\"".to_owned();
        }
        let feet = self.feet.iter().map(|foot| (foot.in_words(), foot.link));
        let groups = words::grouped(feet).into_iter().map(|(shape, links)| {
            // Each link is listed once, with the number of its equal shapes.
            let links = words::grouped(links.into_iter().map(|link| (link, ()))).into_iter();
            let counted = |(link, shapes): (&str, Vec<()>)| match shapes.len() {
                1 => link.to_owned(),
                count => format!("{count} of {link}"),
            };
            format!("{} ({shape})", words::list(&links.map(counted).collect::<Vec<_>>(), FEET))
        });
        let groups: Vec<String> = groups.collect();
        if all { groups.join(", ") } else { words::list(&groups, SHAPES) }
    }

    /// Returns what was left out, grouped by reason; joints by name alone, without the body of their child link.
    fn left_out_by_reason(&self) -> Vec<(String, Vec<String>)> {
        let held = self.held.iter().map(|held| (held.why.clone(), held.name.to_owned()));
        let names: HashSet<&str> = self.held.iter().map(|held| held.name).collect();
        let is_held = |what: &str| {
            let name = what.strip_prefix("joint \"").and_then(|name| name.strip_suffix('"'));
            name.is_some_and(|name| names.contains(name))
        };
        let rest = self.left_out.iter().filter(|left| !is_held(&left.what));
        words::grouped(held.chain(rest.map(|left| (left.why.to_string(), left.what.to_string()))))
    }
}

/// Writes a line of the head, broken between words.
fn entry(label: &str, text: &str, out: &mut String) -> std::fmt::Result {
    wrapped(&format!("  {label:<12} "), INDENT, text, out)
}

fn wrapped(begin: &str, indent: usize, text: &str, out: &mut String) -> std::fmt::Result {
    let text = visible(text);
    let mut words = text.split(' ');
    let mut line = begin.to_owned() + words.next().unwrap_or_default();
    for word in words {
        if line.chars().count() + 1 + word.chars().count() > WIDTH {
            writeln!(out, "{}", line.trim_end())?;
            line = " ".repeat(indent) + word;
        } else {
            line.extend([" ", word]);
        }
    }
    writeln!(out, "{}", line.trim_end())
}
