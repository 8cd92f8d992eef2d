//! The studies and states of `examples/paper/`: all are answered, and they show what the paper claims, except where the
//! paper contradicts itself.

use std::collections::BTreeMap;
use std::error::Error;
use std::sync::LazyLock;

#[path = "../../examples/paper/along.rs"]
mod along;
#[path = "../../examples/paper/cases.rs"]
mod cases;
#[path = "../../examples/paper/exhibit.rs"]
mod exhibit;
#[path = "../../examples/paper/figures.rs"]
mod figures;
#[path = "../../examples/paper/map.rs"]
mod map;

use exhibit::{Exhibit, Found, HERE};
use figures::{FIGURES, Figure};
use heelstrike::sweep::Survey;

/// What each figure shows, by its name, found once for all tests of this file.
static FOUND: LazyLock<BTreeMap<&'static str, Found>> = LazyLock::new(|| {
    let found = |figure: &'static Figure| {
        let exhibit = Exhibit::read(figure).unwrap_or_else(|error| panic!("{}: {error}", figure.name));
        (figure.name, exhibit.found().unwrap_or_else(|error| panic!("{}: {error}", figure.name)))
    };
    FIGURES.iter().map(found).collect()
});

/// Every region that has a slide among its outcomes.
fn bands(survey: &Survey) -> Vec<(Vec<String>, [f64; 2])> {
    let regions = survey.regions.iter().map(|region| (along::modes(&region.regime), [region.from, region.to]));
    regions.filter(|(modes, _)| modes.iter().any(|modes| modes.contains("slide"))).collect()
}

#[test]
fn every_file_is_a_figure() -> Result<(), Box<dyn Error>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(HERE)? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == "json") {
            files.extend(path.file_stem().map(|name| name.to_string_lossy().into_owned()));
        }
    }
    files.sort();
    let mut listed: Vec<&str> = FIGURES.iter().map(|figure| figure.input.name()).collect();
    listed.sort_unstable();
    listed.dedup();
    assert_eq!(files, listed);
    Ok(())
}

#[test]
fn nothing_is_refused_anywhere_in_a_study() {
    for (name, found) in FOUND.iter() {
        match found {
            Found::Regions(findings) => {
                assert!(findings.regimes().iter().all(|(_, _, refused)| refused.is_none()), "{name}");
            }
            Found::Outcomes(_) => assert!(found.analysis().is_ok_and(|analysis| analysis.proven), "{name}"),
        }
    }
}

/// Table 1 gives the distance of the shanks' CoG from the foot, but calls it the distance from the knee: its numbers do
/// not reproduce the paper's own bands and Table 2. The paper's numbers on the pitch are lost.
#[test]
fn all_claims_but_those_on_table_1_come_out() -> Result<(), Box<dyn Error>> {
    for figure in FIGURES {
        for claim in figure.claims {
            let finding = (claim.check)(&FOUND[figure.name])?;
            let expected = match figure.name {
                "table_1_as_printed" | "table_2_as_printed" => Some(false),
                "pitch_map" => None,
                _ => Some(true),
            };
            assert_eq!(finding.agrees, expected, "{}: {}: {}", figure.title, claim.words, finding.words);
        }
    }
    Ok(())
}

/// On a line of the map's grid the points of curves come from bisection, as the borders along one parameter do.
#[test]
fn the_pitch_map_agrees_with_sweeps_at_three_pitches() -> Result<(), Box<dyn Error>> {
    const WITHIN: f64 = 1e-9;
    let map = FOUND["pitch_map"].map()?;
    let figure = FIGURES.iter().find(|figure| figure.name == "pitch_map").ok_or("no figure")?;
    let study = std::fs::read_to_string(figure.path())?;
    let mut counted: BTreeMap<u64, usize> = BTreeMap::new();
    for [_, pitch] in map.curves.iter().flat_map(|curve| &curve.points) {
        *counted.entry(pitch.to_bits()).or_default() += 1;
    }
    for near in [-0.4, 0.02, 0.35] {
        // A line of the grid crosses all six curves; the pitch of other points occurs less often.
        let lines = counted.iter().filter(|(_, count)| **count >= 6).map(|(bits, _)| f64::from_bits(*bits));
        let pitch = lines.min_by(|a, b| (a - near).abs().total_cmp(&(b - near).abs())).ok_or("no line of the grid")?;
        let [parameter, constants] = [r#", "pitch": {"from": -0.5, "to": 0.5, "steps": 65}"#, r#""constants": {"#];
        let study = study.replacen(parameter, "", 1);
        let study = study.replacen(constants, &format!("{constants}\"pitch\": {pitch:?}, "), 1);
        let found = Exhibit::read_with(figure, study)?.found()?;

        let (along, across) = (bands(found.survey()?), map::bands_at(map, pitch));
        assert_eq!(along.len(), 3, "{along:?}");
        assert_eq!(across.len(), 3, "{across:?}");
        for ((modes, along), (should, across)) in along.iter().zip(&across) {
            assert_eq!(modes, should, "at {pitch}");
            let off = along.iter().zip(across).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off <= WITHIN, "at {pitch}: {along:?} and {across:?}");
        }
    }
    Ok(())
}
