//! Contacts that nearly depend on each other.

use super::random::Random;
use serde_json::{Value, json};

/// A problem of a body on a row of contacts, each of which also has small motions of its own (1e-9): three eigenvalues
/// of G are of order one or more, all others are near 1e-18. It is given by M and J, whose entries are exact.
pub fn nearly_dependent(contacts: usize) -> Value {
    let rows = 2 * contacts;
    let mut random = Random::new(7);
    let mut row = |rigid: [f64; 3]| -> Vec<f64> {
        let own = (0..rows).map(|_| 1e-9 * random.between(-1.0, 1.0));
        rigid.into_iter().chain(own).collect()
    };
    let pair = |at: usize| [[1.0, 0.0, 1.0], [0.0, 1.0, at as f64]];
    let jacobian: Vec<Vec<f64>> = (0..contacts).flat_map(pair).map(&mut row).collect();
    let unit = |own: usize| (0..rows + 3).map(|at| f64::from(u8::from(at == own))).collect::<Vec<f64>>();
    let mass: Vec<Vec<f64>> = (0..rows + 3).map(unit).collect();
    let velocity: Vec<f64> = [0.3, -1.0, 0.2].into_iter().chain(vec![0.0; rows]).collect();
    json!({"mass_matrix": mass, "contact_jacobian": jacobian, "velocity": velocity, "friction": 0.5})
}
