//! Checks claims against the regions of a figure in two parameters.

use super::along::modes;
use super::exhibit::Found;
use super::figures::Finding;
use heelstrike::sweep::{Area, Map};

fn slides(area: &Area) -> bool {
    matches!(&modes(&area.regime)[..], [only] if only.starts_with("slide"))
}

fn ambiguous(area: &Area) -> bool {
    modes(&area.regime).len() > 1
}

fn points(map: &Map, of: fn(&Area) -> bool) -> impl Iterator<Item = [f64; 2]> {
    map.areas.iter().filter(move |area| of(area)).flat_map(|area| area.loops.iter().flatten().copied())
}

/// The point at which the sliding band ends, and the nearest point of the ambiguous band.
pub fn junction(map: &Map) -> Option<[[f64; 2]; 2]> {
    let top = points(map, slides).max_by(|a, b| a[1].total_cmp(&b[1]))?;
    let away = |point: &[f64; 2]| (point[0] - top[0]).hypot(point[1] - top[1]);
    let nearest = points(map, ambiguous).min_by(|a, b| away(a).total_cmp(&away(b)))?;
    Some([top, nearest])
}

/// Checks that the sliding band ends, and the ambiguous band begins, at this inertia.
pub fn closes_at(found: &Found, inertia: f64) -> Result<Finding, String> {
    const WITHIN: f64 = 1e-3;
    let [slides, ambiguous] = junction(found.map()?).ok_or("one of the bands is not there")?;
    let words = format!(
        "sliding ends at alpha = {:.5}, j = {:.5}; ambiguity begins at alpha = {:.5}, j = {:.5}; m along (l - along) = {inertia:.5}",
        slides[0], slides[1], ambiguous[0], ambiguous[1]
    );
    let near = |point: [f64; 2]| (point[1] - inertia).abs() <= WITHIN && (point[0] - slides[0]).abs() <= WITHIN;
    Ok(Finding { words, agrees: Some(near(slides) && near(ambiguous)) })
}

/// The intervals of the first parameter that an area covers at one value of the second.
fn across(area: &Area, at: f64) -> Vec<[f64; 2]> {
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

/// All bands with a slide among their outcomes at a value of the second parameter, in order.
pub fn bands_at(map: &Map, at: f64) -> Vec<(Vec<String>, [f64; 2])> {
    let of = |area: &Area| {
        let modes = modes(&area.regime);
        let bands = if modes.iter().any(|modes| modes.contains("slide")) { across(area, at) } else { Vec::new() };
        bands.into_iter().map(move |band| (modes.clone(), band)).collect::<Vec<_>>()
    };
    let mut bands: Vec<_> = map.areas.iter().flat_map(of).collect();
    bands.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]));
    bands
}

/// Lists the bands at some values of the second parameter; the paper's numbers are lost.
pub fn bands_move(found: &Found, values: &[f64]) -> Result<Finding, String> {
    let map = found.map()?;
    let at = |value: &f64| {
        let bands = bands_at(map, *value);
        let said = bands.iter().map(|(modes, [from, to])| format!("{} {from:.4}..{to:.4}", modes.join(" or ")));
        format!("at {value}: {}", said.collect::<Vec<_>>().join(", "))
    };
    Ok(Finding { words: values.iter().map(at).collect::<Vec<_>>().join("; "), agrees: None })
}
