//! The borders of every model of the paper from 50 samples, against `data/paper.json` (40-digit values).

use crate::support::paper::{MODELS, Model, REFERENCE};
use crate::sweep::command::{assert_begins, kneed, straight, sweep};
use serde_json::json;

#[test]
fn reference_borders_are_found_from_50_samples() {
    let mut borders = 0;
    for Model { name, urdf, inertia, kneed: bends } in MODELS {
        let number = |inertia: &str| inertia.parse().expect("a number");
        // The model pdw_j0.04 is asked with the inertia of its file, and with the same inertia given by the study.
        let mut studies = if bends { vec![kneed()] } else { vec![straight(inertia.map(number))] };
        studies.extend((name == "pdw_j0.04").then(|| straight(Some(0.04))));
        for (mut study, (friction, regions)) in
            studies.into_iter().flat_map(|study| REFERENCE[name].regions.iter().map(move |own| (study.clone(), own)))
        {
            study["state"]["friction"] = friction.parse().map_or(json!(friction), |number: f64| json!(number));
            let expected: Vec<(f64, &str)> =
                regions.iter().map(|(begin, outcomes)| (begin.parse().expect("a number"), outcomes.as_str())).collect();
            let found = sweep(&format!("urdf/{urdf}.urdf"), &study);
            assert_begins(&format!("{name}, friction {friction}"), &found, &expected, 1e-10);
            borders += expected.len() - 1;
        }
    }
    assert_eq!(borders, 35);
}

/// With the center of percussion in the foot all outcomes meet at pi/4. This is one border: the sample on it does not
/// make a region, whatever its result.
#[test]
fn the_degenerate_place_of_the_walker_is_one_border() {
    let mut study = straight(Some(0.24));
    let quarter = std::f64::consts::FRAC_PI_4;
    study["parameters"]["alpha"] = json!({"from": 0.5 * quarter, "to": 1.5 * quarter, "steps": 3});
    let sweep = sweep("urdf/pdw.urdf", &study);
    assert_begins("pdw", &sweep, &[(0.0, "separate/stick"), (quarter, "stick/stick")], 1e-12);
    assert_eq!(sweep.samples[1]["alpha"], json!(quarter));
    assert_eq!(sweep.samples[1]["result"]["proven"], json!(true));
}
