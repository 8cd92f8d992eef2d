//! The accuracy that `docs/guarantees.md` promises for the numbers of a proven outcome.

use heelstrike::impact::{Friction, Mode, Outcome};

/// The promised error of each number, relative to its scale.
pub const PROMISED: f64 = 1e-10;

/// The true numbers of an outcome, [tangential, normal] per contact.
#[derive(Debug)]
pub struct Truth {
    /// Whether the outcome is a robot's: the scales of a contact are then at least what the hardest blow can do there.
    pub of_robot: bool,
    /// sqrt(G_ii) of each row.
    pub mobility: Vec<[f64; 2]>,
    pub before: Vec<[f64; 2]>,
    pub after: Vec<[f64; 2]>,
    pub impulse: Vec<[f64; 2]>,
    pub energy_loss: f64,
    pub friction_needed: Vec<Option<f64>>,
    /// For robots: dq/dt after the impact and its scale, per coordinate.
    pub rates: Vec<[f64; 2]>,
}

/// The least scale of a tangential impulse, as a multiple of the scale of normal impulses: min(mu, 1).
fn least(friction: Friction) -> f64 {
    match friction {
        Friction::Finite(mu) => mu.min(1.0),
        Friction::Infinite => 1.0,
    }
}

/// |L_t| / L_n of each sticking contact with L_n > 0.
pub fn needed(modes: &[Mode], impulse: &[[f64; 2]]) -> Vec<Option<f64>> {
    let of = |(&mode, l): (&Mode, &[f64; 2])| (mode == Mode::Stick && l[1] > 0.0).then(|| l[0].abs() / l[1]);
    modes.iter().zip(impulse).map(of).collect()
}

/// Returns an error if a number is off by more than `PROMISED` times its scale.
pub fn check(what: &str, is: f64, should: f64, scale: f64) -> Result<(), String> {
    if (is - should).abs() <= PROMISED * scale.max(should.abs()) {
        return Ok(());
    }
    Err(format!(
        "{what} is {is:e}, not {should:e}: off by {:.1e} of its scale",
        (is - should).abs() / scale.max(should.abs())
    ))
}

impl Truth {
    /// Returns an error that names the first number of an outcome with too few digits.
    pub fn check(&self, outcome: &Outcome, frictions: &[Friction]) -> Result<(), String> {
        let largest = |pairs: &[[f64; 2]]| pairs.concat().iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        let fastest = largest(&self.before).max(largest(&self.after));
        let energy = self
            .before
            .concat()
            .iter()
            .zip(self.mobility.concat())
            .fold(0.0, |most: f64, (c, mobility)| most.max(c.abs() / mobility));
        for (k, &friction) in frictions.iter().enumerate() {
            let mobility = self.mobility[k];
            let own = largest(&[self.before[k], self.after[k]]);
            let [mut speed, mut push] = [own, self.impulse[k][1]];
            if self.of_robot {
                speed = speed.max(fastest.min(energy * mobility[0].max(mobility[1])));
                push = push.max(largest(&self.impulse).min(energy / mobility[1]));
            }
            for row in 0..2 {
                check(&format!("velocity {row} of {k}"), outcome.velocity_after[k][row], self.after[k][row], speed)?;
            }
            let [t, n] = self.impulse[k];
            check(&format!("normal impulse of {k}"), outcome.impulse[k][1], n, push)?;
            check(&format!("tangential impulse of {k}"), outcome.impulse[k][0], t, least(friction) * push)?;
            match (outcome.friction_needed[k], self.friction_needed[k]) {
                (None, None) => {}
                (Some(is), Some(should)) => {
                    // The scale of the quotient |L_t| / L_n, whose two numbers have the scales above.
                    let size = should.max(least(friction)) * push / n;
                    check(&format!("friction of {k}"), is, should, size)?;
                    if let Friction::Finite(mu) = friction
                        && is > mu
                    {
                        return Err(format!("friction of {k} is {is:e}, beyond {mu:e}"));
                    }
                }
                (is, should) => return Err(format!("friction of {k} is {is:?}, not {should:?}")),
            }
        }
        check("energy", outcome.energy_loss, self.energy_loss, 0.0)
    }

    /// The largest error of base and joint velocities, relative to their scale.
    pub fn worst_rate(&self, outcome: &Outcome) -> f64 {
        let named = [&outcome.base_velocity_after, &outcome.joint_velocity_after].into_iter().flatten();
        let found: Vec<f64> = named.flat_map(|named| named.values().iter().copied()).collect();
        let error =
            |(is, [should, scale]): (&f64, &[f64; 2])| if is == should { 0.0 } else { (is - should).abs() / scale };
        found.iter().zip(&self.rates).map(error).fold(0.0, f64::max)
    }
}
