//! What a figure's regions of two parameters say of a claim.

use crate::along::modes;
use crate::exhibit::Found;
use crate::figures::Finding;
use heelstrike::planar::Vector;
use heelstrike::sweep::{Area, Map};

fn map(found: &Found) -> Result<&Map, String> {
    match found {
        Found::Map(map) => Ok(map),
        _ => Err("this is no study of two parameters".into()),
    }
}

fn slides(area: &Area) -> bool {
    matches!(&modes(&area.regime)[..], [only] if only.starts_with("slide"))
}

fn ambiguous(area: &Area) -> bool {
    modes(&area.regime).len() > 1
}

fn points(map: &Map, of: fn(&Area) -> bool) -> impl Iterator<Item = Vector<f64>> {
    map.areas.iter().filter(move |area| of(area)).flat_map(|area| area.loops.iter().flatten().copied())
}

/// Where the sliding band ends, and the point of the ambiguous band that is nearest to it.
pub fn junction(map: &Map) -> Option<[Vector<f64>; 2]> {
    let top = points(map, slides).max_by(|a, b| a[1].total_cmp(&b[1]))?;
    let away = |point: &Vector<f64>| (point[0] - top[0]).hypot(point[1] - top[1]);
    let nearest = points(map, ambiguous).min_by(|a, b| away(a).total_cmp(&away(b)))?;
    Some([top, nearest])
}

/// The sliding band ends, and the ambiguous band begins, at this inertia.
pub fn closes_at(found: &Found, inertia: f64) -> Result<Finding, String> {
    const WITHIN: f64 = 1e-3;
    let [slides, ambiguous] = junction(map(found)?).ok_or("one of the bands is not there")?;
    let words = format!(
        "sliding ends at alpha = {:.5}, j = {:.5}; ambiguity begins at alpha = {:.5}, j = {:.5}; m along (l - along) = {inertia:.5}",
        slides[0], slides[1], ambiguous[0], ambiguous[1]
    );
    let near = |point: Vector<f64>| (point[1] - inertia).abs() <= WITHIN && (point[0] - slides[0]).abs() <= WITHIN;
    Ok(Finding { words, agrees: near(slides) && near(ambiguous) })
}

/// From where to where along the first parameter an area reaches at a value of the second.
pub fn across(area: &Area, at: f64) -> Vec<[f64; 2]> {
    let mut crossings: Vec<f64> = Vec::new();
    for points in &area.loops {
        for ([x, y], [next_x, next_y]) in points.iter().zip(points.iter().cycle().skip(1)) {
            if (*y <= at) != (*next_y <= at) {
                crossings.push(x + (next_x - x) * (at - y) / (next_y - y));
            }
        }
    }
    crossings.sort_by(f64::total_cmp);
    crossings.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// The first band of sliding at the second parameter's value.
fn first_band(map: &Map, at: f64) -> Option<[f64; 2]> {
    let bands = map.areas.iter().filter(|area| slides(area)).flat_map(|area| across(area, at));
    bands.min_by(|a, b| a[0].total_cmp(&b[0]))
}

/// The first band of sliding lies elsewhere, by more than its width, when the second parameter is `by` less or more than 0.
pub fn band_shifts(found: &Found, by: f64) -> Result<Finding, String> {
    let map = map(found)?;
    let [back, upright, forward] = [by, 0.0, -by].map(|at| first_band(map, at));
    let (Some(back), Some(upright), Some(forward)) = (back, upright, forward) else {
        return Ok(Finding { words: "there is no such band".into(), agrees: false });
    };
    let middle = |band: [f64; 2]| 0.5 * (band[0] + band[1]);
    let shift = |band| middle(band) - middle(upright);
    let words = format!(
        "pitched {by} rad backward {:.4}..{:.4} (shift {:+.4}), upright {:.4}..{:.4}, {by} rad forward {:.4}..{:.4} (shift {:+.4})",
        back[0], back[1], shift(back), upright[0], upright[1], forward[0], forward[1], shift(forward)
    );
    let width = upright[1] - upright[0];
    Ok(Finding { words, agrees: shift(back).abs() > width && shift(forward).abs() > width })
}
