//! The figures and tables of the paper that show collisions, each with the paper's claims about it.
//!
//! Modes are of the trailing foot, then of the leading foot. The paper walks toward -x, so it calls slide- forward.

use super::along::{Modes, bands, order, order_without_slides};
use super::cases::{Case, cases, outcomes};
use super::exhibit::Found;
use super::map::{bands_move, closes_at};
use std::f64::consts::PI;

/// A figure or table.
pub struct Figure {
    /// Name of the figure's picture.
    pub name: &'static str,
    /// Title for people.
    pub title: &'static str,
    /// The robot's file.
    pub robot: &'static str,
    /// The study's or state's file.
    pub input: Input,
    /// Claims of the paper, or of the theory that it gives.
    pub claims: &'static [Claim],
}

/// A claim about a figure, and the check of it.
pub struct Claim {
    /// The claim in the paper's words, shortened.
    pub words: &'static str,
    /// Compares the claim with what is found.
    pub check: fn(&Found) -> Result<Finding, String>,
}

/// What a check found.
pub struct Finding {
    /// The finding with its numbers.
    pub words: String,
    /// Whether the finding agrees with the claim; `None` if the claim's numbers are lost.
    pub agrees: Option<bool>,
}

/// A file of this directory, without its ending.
pub enum Input {
    /// A study for `heelstrike sweep`.
    Study(&'static str),
    /// A study for `heelstrike sweep --explain`, whose picture has beta and gamma.
    Explained(&'static str),
    /// A state for `heelstrike impact --explain`.
    State(&'static str),
}

impl Input {
    /// The file's name, without its ending.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Study(name) | Self::Explained(name) | Self::State(name) => name,
        }
    }
}

const LIFT_OFF: &[Modes] = &["separate/stick"];
const STOP: &[Modes] = &["stick/stick"];
const SLIDE_FORWARD: &[Modes] = &["slide-/stick"];
const SLIDE_BACKWARD: &[Modes] = &["slide+/stick"];
const THREE: &[Modes] = &["separate/stick", "stick/stick", "slide+/stick"];

/// The angle of inertial impulses in a pure slide of the body of Figure 9, whose M_c is [[2, -1], [-1, 2]] / 3 (section
/// 4).
const TAN_BETA: f64 = -0.5;

const RAMONE_BANDS: &[Claim] = &[Claim {
    words: "slides whatever the friction for 0.47..0.54 and 1.02..1.06, three outcomes for 1.34..1.40 (section 6)",
    check: |found| {
        const PRINTED: f64 = 0.5e-2;
        bands(found, &[(SLIDE_BACKWARD, 0.47, 0.54), (SLIDE_FORWARD, 1.02, 1.06), (THREE, 1.34, 1.40)], PRINTED)
    },
}];

const RAMONE_CASES: &[Claim] = &[Claim {
    words: "in 1e-4 m/s and 1e-4 N s: lift-off c = (0.826, -0.032); stop L = (-0.116, -0.043); slide c_x = 0.582, L_x = -0.033, \
            which alone is valid",
    check: |found| {
        const PRINTED: [Case; 3] = [
            ("separate/stick", [0.826, -0.032], [0.0, 0.0]),
            ("stick/stick", [0.0, 0.0], [-0.116, -0.043]),
            ("slide+/stick", [0.582, 0.0], [-0.033, 0.0]),
        ];
        cases(found, 1e-4, &PRINTED, "slide+/stick")
    },
}];

/// The inertia at which the foot is the legs' center of percussion \[kg m^2\], m along (l - along) for legs of 1 kg and
/// 1 m.
const fn critical_inertia(along: f64) -> f64 {
    along * (1.0 - along)
}

/// All figures and tables, in the order of the paper.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "figures_3_and_6",
        title: "Figures 3 and 6: minimalistic biped, infinite friction",
        robot: "minimalistic",
        input: Input::Study("figures_3_and_6"),
        claims: &[
            Claim {
                words: "without sliding: lift-off in A and E, stop in C, D and E; B is left unexplained, E is ambiguous (Figure 3)",
                check: |found| order_without_slides(found, &[LIFT_OFF, &[], STOP, &["separate/stick", "stick/stick"]]),
            },
            Claim {
                words: "lift-off (A), slide in spite of infinite friction (B), stop (C, D), all three of them (E) (Figure 6)",
                check: |found| order(found, &[LIFT_OFF, SLIDE_FORWARD, STOP, THREE]),
            },
        ],
    },
    Figure {
        name: "figure_5",
        title: "Figure 5: minimalistic biped, friction 1 at the trailing foot, the leading foot stops",
        robot: "minimalistic",
        input: Input::Study("figure_5"),
        claims: &[Claim {
            words: "slides forward in B and C, and backward for very large angles",
            check: |found| order(found, &[LIFT_OFF, SLIDE_FORWARD, STOP, SLIDE_BACKWARD, LIFT_OFF]),
        }],
    },
    Figure {
        name: "figure_7",
        title: "Figure 7: minimalistic biped, friction 1",
        robot: "minimalistic",
        input: Input::Study("figure_7"),
        claims: &[Claim {
            words: "I lift-off, II slides forward, III both rest, IV slides backward, V slides backward and the leading foot forward, \
                    VI lift-off and the leading foot slides forward",
            check: |found| {
                let (fifth, sixth): (&[Modes], &[Modes]) = (&["slide+/slide-"], &["separate/slide-"]);
                order(found, &[LIFT_OFF, SLIDE_FORWARD, STOP, SLIDE_BACKWARD, fifth, sixth])
            },
        }],
    },
    Figure {
        name: "figure_8",
        title: "Figure 8: minimalistic biped, friction 10",
        robot: "minimalistic",
        input: Input::Study("figure_8"),
        claims: &[Claim {
            words: "I-III as with friction 1, IV three outcomes, V lift-off, VI lift-off and the leading foot slides forward",
            check: |found| order(found, &[LIFT_OFF, SLIDE_FORWARD, STOP, THREE, LIFT_OFF, &["separate/slide-"]]),
        }],
    },
    Figure {
        name: "figure_9",
        title: "Figure 9: single body, against the angle gamma of the impulse on its contact",
        robot: "block",
        input: Input::Study("figure_9"),
        claims: &[Claim {
            words: "three outcomes for beta < gamma < 0, slides whatever the friction for pi + beta < gamma < pi; tan(beta) = -1/2",
            check: |found| {
                const EXACT: f64 = 1e-10;
                let beta = TAN_BETA.atan();
                let three: &[Modes] = &["separate", "stick", "slide+"];
                bands(found, &[(three, beta, 0.0), (&["slide-"], PI + beta, PI)], EXACT)
            },
        }],
    },
    Figure {
        name: "figure_9_abc",
        title: "Figure 9(a)-(c): single body, pushed into the ground",
        robot: "block",
        input: Input::State("figure_9_abc"),
        claims: &[Claim {
            words: "it can lift off (a), stay (b), or slide (c)",
            check: |found| outcomes(found, &["separate", "stick", "slide+"]),
        }],
    },
    Figure {
        name: "figure_9_d",
        title: "Figure 9(d): single body, pulled from the ground",
        robot: "block",
        input: Input::State("figure_9_d"),
        claims: &[Claim {
            words: "it slides, although the impulse points upward and friction is infinite",
            check: |found| outcomes(found, &["slide-"]),
        }],
    },
    Figure {
        name: "figure_10a",
        title: "Figure 10(a): passive dynamic walker, inertia below m along (l - along)",
        robot: "pdw",
        input: Input::Explained("figure_10a"),
        claims: &[Claim {
            words: "leaves the ground (A), slides whatever the friction (B), stays (C, D), three outcomes (E)",
            check: |found| order(found, &[LIFT_OFF, SLIDE_FORWARD, STOP, THREE]),
        }],
    },
    Figure {
        name: "figure_10b",
        title: "Figure 10(b): passive dynamic walker, inertia equal to m along (l - along)",
        robot: "pdw",
        input: Input::Explained("figure_10b"),
        claims: &[Claim {
            words: "sliding with infinite friction and multiple solutions vanish",
            check: |found| order(found, &[LIFT_OFF, STOP]),
        }],
    },
    Figure {
        name: "figure_10c",
        title: "Figure 10(c): passive dynamic walker, inertia above m along (l - along)",
        robot: "pdw",
        input: Input::Explained("figure_10c"),
        claims: &[Claim {
            words: "no sliding whatever the friction, but multiple solutions",
            check: |found| order(found, &[LIFT_OFF, THREE]),
        }],
    },
    Figure {
        name: "inertia_map_0.2",
        title: "Section 5: passive dynamic walker, along = 0.2 l, against the leg angle and the legs' inertia",
        robot: "pdw",
        input: Input::Study("inertia_map_0.2"),
        claims: &[Claim {
            words: "sliding ends and a second ambiguous region begins at j = m along (l - along)",
            check: |found| closes_at(found, critical_inertia(0.2)),
        }],
    },
    Figure {
        name: "inertia_map_0.4",
        title: "Section 5: passive dynamic walker, along = 0.4 l, against the leg angle and the legs' inertia",
        robot: "pdw",
        input: Input::Study("inertia_map_0.4"),
        claims: &[Claim {
            words: "sliding ends and a second ambiguous region begins at j = m along (l - along)",
            check: |found| closes_at(found, critical_inertia(0.4)),
        }],
    },
    Figure {
        name: "inertia_map_0.7",
        title: "Section 5: passive dynamic walker, along = 0.7 l, against the leg angle and the legs' inertia",
        robot: "pdw",
        input: Input::Study("inertia_map_0.7"),
        claims: &[Claim {
            words: "sliding ends and a second ambiguous region begins at j = m along (l - along)",
            check: |found| closes_at(found, critical_inertia(0.7)),
        }],
    },
    Figure {
        name: "table_1_as_printed",
        title: "Table 1: RAMone, lower-leg CoG as printed, 0.165235 m below the knee",
        robot: "ramone",
        input: Input::Study("table_1"),
        claims: RAMONE_BANDS,
    },
    Figure {
        name: "table_1_as_computed",
        title: "Table 1: RAMone, lower-leg CoG as computed, 0.073265 m below the knee",
        robot: "ramone_paper",
        input: Input::Study("table_1"),
        claims: RAMONE_BANDS,
    },
    Figure {
        name: "table_2_as_printed",
        title: "Table 2 and Figure 11: RAMone at alpha = 0.5, lower-leg CoG as printed in Table 1",
        robot: "ramone",
        input: Input::State("table_2"),
        claims: RAMONE_CASES,
    },
    Figure {
        name: "table_2_as_computed",
        title: "Table 2 and Figure 11: RAMone at alpha = 0.5, lower-leg CoG as computed",
        robot: "ramone_paper",
        input: Input::State("table_2"),
        claims: RAMONE_CASES,
    },
    Figure {
        name: "pitch_map",
        title: "Section 7: RAMone as computed, against the leg angle in the world and the pitch of the main body",
        robot: "ramone_paper",
        input: Input::Study("pitch_map"),
        claims: &[Claim {
            words: "pitching the main body forward and backward by some angle shifts the band of sliding by another",
            check: |found| bands_move(found, &[-0.4, -0.1, 0.0, 0.1, 0.4]),
        }],
    },
];
