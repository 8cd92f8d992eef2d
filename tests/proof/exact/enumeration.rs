//! All outcomes of a contact problem in exact arithmetic, one combination of modes after the other.

use crate::support::rational::{Matrix, common_denominator, cramer, quotient, rank, sign, to_f64, whole};
use dashu_base::Abs;
use dashu_int::{IBig, UBig};
use dashu_ratio::RBig;
use heelstrike::impact::Mode;

/// Coefficient of Coulomb friction; `None` stands for infinite friction.
pub type Friction = Option<RBig>;

/// G, c-, mu and e; contact k has the rows 2k (tangential) and 2k + 1 (normal).
#[derive(Debug, Clone)]
pub struct Problem {
    pub delassus: Matrix,
    pub velocity_before: Vec<RBig>,
    pub friction: Vec<Friction>,
    pub restitution: Vec<RBig>,
}

/// One combination of modes with its solution.
#[derive(Debug, Clone)]
pub struct Combination {
    pub modes: Vec<Mode>,
    /// Whether every strict condition of the modes holds.
    pub valid: bool,
    /// Sign of det A.
    pub index: i8,
    /// The margin: the smallest slack.
    pub margin: f64,
    pub impulse: Quotients,
    pub velocity_after: Quotients,
}

/// Rationals with one denominator.
#[derive(Debug, Clone)]
pub struct Quotients {
    numerators: Vec<IBig>,
    denominator: IBig,
}

impl Quotients {
    pub fn exact(&self) -> Vec<RBig> {
        let exact = |numerator: &IBig| RBig::from_parts_signed(numerator.clone(), self.denominator.clone());
        self.numerators.iter().map(exact).collect()
    }
}

/// The results of all 4^n combinations of modes.
#[derive(Debug, Clone)]
pub struct Enumeration {
    /// The combinations with det A != 0, valid or not.
    pub combinations: Vec<Combination>,
    /// Number of combinations with det A = 0 whose equations contradict each other: no outcome.
    pub contradictory: usize,
    /// Number of combinations with det A = 0 that have infinitely many solutions; a border.
    pub dependent: usize,
}

impl Enumeration {
    pub fn outcomes(&self) -> impl Iterator<Item = &Combination> {
        self.combinations.iter().filter(|combination| combination.valid)
    }

    /// Distance of the whole case from the nearest border: the least |margin| of all combinations.
    pub fn clearance(&self) -> f64 {
        // If nothing moves before the impact, slacks have no scale and margins are not finite.
        if self.dependent > 0 || self.combinations.iter().any(|combination| !combination.margin.is_finite()) {
            return 0.0;
        }
        self.combinations.iter().map(|combination| combination.margin.abs()).fold(f64::INFINITY, f64::min)
    }
}

/// Tries every combination of modes. G must be regular.
pub fn enumerate(problem: &Problem) -> Enumeration {
    let contacts = problem.friction.len();
    let scaled = Scaled::new(problem);
    let mut all = Enumeration { combinations: Vec::new(), contradictory: 0, dependent: 0 };
    for number in 0..1 << (2 * contacts) {
        let modes: Vec<Mode> = (0..contacts).map(|k| Mode::ALL[number >> (2 * k) & 3]).collect();
        let system = scaled.system(&modes);
        match cramer(system.clone()) {
            Some(solution) => {
                all.combinations.push(scaled.judge(modes, solution.determinant, solution.numerators));
            }
            None => {
                let rational: Matrix =
                    system.iter().map(|row| row.iter().map(|x| RBig::from(x.clone())).collect()).collect();
                let left: Matrix = rational.iter().map(|row| row[..2 * contacts].to_vec()).collect();
                if rank(&left) < rank(&rational) { all.contradictory += 1 } else { all.dependent += 1 }
            }
        }
    }
    all
}

/// The problem in whole numbers: scale * G and scale * c-.
struct Scaled {
    scale: UBig,
    delassus: Vec<Vec<IBig>>,
    before: Vec<IBig>,
    /// Pairs (bounce, bounce_scale) with scale * e min(c_n-, 0) = bounce / bounce_scale.
    bounce: Vec<(IBig, IBig)>,
    /// mu as numerator and denominator; (1, 0) if it is infinite.
    friction: Vec<(IBig, IBig)>,
    /// sqrt(G_ii).
    root: Vec<f64>,
    /// S = max |c_i| / sqrt(G_ii).
    size: f64,
}

impl Scaled {
    fn new(problem: &Problem) -> Self {
        let scale = common_denominator(problem.delassus.iter().flatten().chain(&problem.velocity_before));
        let before: Vec<IBig> = problem.velocity_before.iter().map(|c| whole(c, &scale)).collect();
        let root: Vec<f64> = (0..before.len()).map(|i| to_f64(&problem.delassus[i][i]).sqrt()).collect();
        let size = problem.velocity_before.iter().zip(&root).map(|(c, root)| to_f64(c).abs() / root);
        let bounce = problem.restitution.iter().enumerate().map(|(k, e)| {
            let approach = before[2 * k + 1].clone().min(IBig::ZERO);
            (e.numerator() * approach, IBig::from(e.denominator().clone()))
        });
        let friction = problem.friction.iter().map(|friction| match friction {
            Some(mu) => (mu.numerator().clone(), IBig::from(mu.denominator().clone())),
            None => (IBig::ONE, IBig::ZERO),
        });
        Self {
            delassus: problem.delassus.iter().map(|row| row.iter().map(|g| whole(g, &scale)).collect()).collect(),
            size: size.fold(0.0, f64::max),
            bounce: bounce.collect(),
            friction: friction.collect(),
            before,
            root,
            scale,
        }
    }

    /// The equations A L = b of the modes as rows [A | b]; every row may have been multiplied by a positive number.
    fn system(&self, modes: &[Mode]) -> Vec<Vec<IBig>> {
        let size = 2 * modes.len();
        let unit = |entries: &[(usize, IBig)]| {
            let mut row = vec![IBig::ZERO; size + 1];
            entries.iter().for_each(|(column, value)| row[*column] = value.clone());
            row
        };
        let mut rows = Vec::with_capacity(size);
        for (k, mode) in modes.iter().enumerate() {
            let (t, n) = (2 * k, 2 * k + 1);
            // c_t+ = 0: row t of G L = -c_t-.
            let at_rest = || {
                let mut row = self.delassus[t].clone();
                row.push(-&self.before[t]);
                row
            };
            // xi_n = 0: row n of G L = -(c_n- + e min(c_n-, 0)).
            let closed = || {
                let (bounce, parts) = &self.bounce[k];
                let mut row: Vec<IBig> = self.delassus[n].iter().map(|g| g * parts).collect();
                row.push(-(&self.before[n] * parts + bounce));
                row
            };
            let (mu, one) = &self.friction[k];
            match mode {
                Mode::Separate => rows.extend([unit(&[(t, IBig::ONE)]), unit(&[(n, IBig::ONE)])]),
                Mode::Stick => rows.extend([at_rest(), closed()]),
                Mode::SlidePlus => rows.extend([unit(&[(t, one.clone()), (n, mu.clone())]), closed()]),
                Mode::SlideMinus => rows.extend([unit(&[(t, one.clone()), (n, -mu)]), closed()]),
            }
        }
        rows
    }

    /// Tests the inequalities of the modes on the solution L = numerators / determinant.
    fn judge(&self, modes: Vec<Mode>, determinant: IBig, numerators: Vec<IBig>) -> Combination {
        // From here on all numbers have one positive denominator.
        let index = sign(&determinant);
        let turn = |x: IBig| if index < 0 { -x } else { x };
        let impulse: Vec<IBig> = numerators.into_iter().map(turn).collect();
        let determinant = turn(determinant);
        let denominator = IBig::from(self.scale.clone()) * &determinant;
        let after: Vec<IBig> = self
            .delassus
            .iter()
            .zip(&self.before)
            .map(|(row, before)| {
                row.iter()
                    .zip(&impulse)
                    .fold(before * &determinant, |sum, (g, l)| if l.is_zero() { sum } else { sum + g * l })
            })
            .collect();

        let mut valid = true;
        let mut margin = f64::INFINITY;
        // The inequality numerator / below > 0, or >= 0 if it is not strict; `size` makes its slack free of units.
        let mut require = |strict: bool, numerator: IBig, below: &IBig, size: f64| {
            valid &= if strict { sign(&numerator) > 0 } else { sign(&numerator) >= 0 };
            margin = margin.min(quotient(&numerator, below) / size);
        };
        for (k, mode) in modes.iter().enumerate() {
            let (t, n) = (2 * k, 2 * k + 1);
            let (velocity_t, velocity_n) = (self.size * self.root[t], self.size * self.root[n]);
            let (impulse_t, impulse_n) = (self.size / self.root[t], self.size / self.root[n]);
            let (mu, one) = &self.friction[k];
            let infinite = one.is_zero();
            match mode {
                Mode::Separate => {
                    let (bounce, parts) = &self.bounce[k];
                    let gap_speed = &after[n] * parts + bounce * &determinant;
                    require(true, gap_speed, &(&denominator * parts), velocity_n);
                }
                Mode::Stick => {
                    require(false, impulse[n].clone(), &determinant, impulse_n);
                    if !infinite {
                        let slope = quotient(mu, one);
                        let size = self.size * ((slope / self.root[n]).powi(2) + 1.0 / self.root[t].powi(2)).sqrt();
                        let cone = mu * &impulse[n] - one * (&impulse[t]).abs();
                        require(false, cone, &(&determinant * one), size);
                    }
                }
                Mode::SlidePlus | Mode::SlideMinus => {
                    let along = |x: &IBig| if *mode == Mode::SlidePlus { x.clone() } else { -x };
                    require(true, along(&after[t]), &denominator, velocity_t);
                    if infinite {
                        require(false, -along(&impulse[t]), &determinant, impulse_t);
                    } else {
                        require(false, impulse[n].clone(), &determinant, impulse_n);
                    }
                }
            }
        }
        Combination {
            modes,
            valid,
            index,
            margin,
            impulse: Quotients { numerators: impulse, denominator: determinant },
            velocity_after: Quotients { numerators: after, denominator },
        }
    }
}
