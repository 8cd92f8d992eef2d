//! Checks what the example `lecture` claims about its biped and about Painleve's rod.

#[path = "../../examples/lecture/biped.rs"]
mod biped;
#[path = "../../examples/lecture/rod.rs"]
mod rod;

use rod::RodMap;

#[test]
fn claims_of_the_lecture_hold() {
    let map = RodMap::new(25, 21).expect("a map");
    let claims = biped::claims().expect("answers").into_iter().chain(map.claims().expect("answers"));
    let failed: Vec<String> = claims.filter(|(_, holds)| !holds).map(|(words, _)| words).collect();
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn borders_part_the_regions_of_the_map() {
    let map = RodMap::new(25, 21).expect("a map");
    let [jams, lifts] = rod::borders();
    for cell in &map.cells {
        let above = jams.iter().min_by(|a, b| (a.0 - cell.theta).abs().total_cmp(&(b.0 - cell.theta).abs()));
        let &(theta, border) = above.expect("a curve");
        // Compares only cells near a point of the curve, but farther than 0.2 from it: the curve is steep at its ends.
        if (theta - cell.theta).abs() < 3e-3 && (border - cell.friction).abs() > 0.2 {
            let jams = matches!(cell.found, Some(rod::Kind::Two | rod::Kind::Nothing));
            assert_eq!(jams, cell.friction > border, "{cell:?}");
        }
        let rises = matches!(cell.found, Some(rod::Kind::Two | rod::Kind::Lifts));
        assert_eq!(rises, cell.theta > lifts[0].0, "{cell:?}");
    }
}
