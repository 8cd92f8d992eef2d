//! Checks what the example `lecture` claims about its biped and about Painleve's rod.

#[path = "../../examples/lecture/biped.rs"]
mod biped;
#[path = "../../examples/lecture/rod.rs"]
mod rod;

use rod::RodMap;

#[test]
fn claims_and_borders_of_the_lecture_hold() {
    let map = RodMap::new(25, 21).expect("a map");
    let claims = [biped::claims().expect("answers"), map.claims().expect("answers")].concat();
    let failed: Vec<&String> = claims.iter().filter(|(_, holds)| !holds).map(|(words, _)| words).collect();
    assert!(claims.len() == 6 && failed.is_empty(), "{} claims, {failed:?}", claims.len());
    let [jams, lifts] = rod::borders();
    assert_eq!(map.cells.len(), 25 * 21);
    for cell in &map.cells {
        // The curve has a point at each inclination of the map at which its friction is within the map.
        let border = jams.iter().find(|(theta, _)| (theta - cell.theta).abs() < 1e-9);
        let jams = matches!(cell.found, Some(rod::Kind::Two | rod::Kind::Nothing));
        assert_eq!(jams, border.is_some_and(|(_, border)| cell.friction > *border), "{cell:?}");
        let rises = matches!(cell.found, Some(rod::Kind::Two | rod::Kind::Lifts));
        assert_eq!(rises, cell.theta > lifts[0].0, "{cell:?}");
    }
}
