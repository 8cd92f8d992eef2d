//! Notes on recordings: what may hide or create touchdowns, or make velocities false.

use super::*;

#[test]
fn the_note_of_no_touchdown_says_what_would_count() {
    let still =
        "time,q_base_x,q_base_z,q_base_pitch,v_base_x,v_base_z,v_base_pitch\n0,0,0.57,0,0,0,0\n0.1,0,0.6,0,0,0,0\n";
    let note_of = |table: &str, options: &[&str]| {
        let always = ["-", "--input-format", "csv", "--touchdowns"];
        let friction = if options.contains(&"--friction") { &[][..] } else { &["--friction", "1"] };
        batch(&[&always, friction, options].concat(), table).refusal(0)
    };
    let note = |options: &[&str]| note_of(still, options);
    let expected = "no touchdown found: the lowest foot comes to z = 0.07 m; a foot must descend 0.0120 m or more, \
                    faster than 0.0500 m/s, to at most 0.0200 m above the ground (see --drop, --ground-height)\n";
    assert_eq!(note(&[]), expected);
    assert_eq!(note(&["--friction", "20"]), expected, "friction explains nothing");
    let expected = expected.replace("0.0200", "0.0300").replace("0.0120", "0.0250");
    assert_eq!(note(&["--drop", "0.025", "--ground-height", "0.03"]), expected);
    let milliseconds = note_of(&still.replace("\n0.1,", "\n100,"), &[]);
    assert!(milliseconds.contains("note: rows are 100 s apart: is the time in seconds?\n"), "{milliseconds}");
}

/// The cells of a recorded walk, row by row.
type Rows = Vec<Vec<String>>;

/// A change of the walk's cells.
type Change<'c> = &'c dyn Fn(&mut Rows);

/// The names of the walk's columns, and its rows.
fn walk_cells() -> (Vec<String>, Rows) {
    let walk = read("examples/gait/ramone_walk.csv");
    let mut rows = walk.lines().map(|row| row.split(',').map(str::to_owned).collect());
    (rows.next().expect("a header"), rows.collect())
}

/// Standard error of a batch of the changed walk.
fn notes_with(options: &[&str], change: impl Fn(&mut Vec<String>, &mut Rows)) -> String {
    let (mut names, mut rows) = walk_cells();
    change(&mut names, &mut rows);
    let table: Vec<String> = [names].iter().chain(&rows).map(|row| row.join(",")).collect();
    let always = ["batch", RAMONE, "-", "--input-format", "csv", "--friction", "0.6", "--brief"];
    heelstrike_reads(&[&always[..], options].concat(), table.join("\n")).well().stderr
}

/// Standard error of a search for touchdowns in the changed walk.
fn notes_of(change: impl Fn(&[String], &mut Rows)) -> String {
    notes_with(&["--touchdowns"], |names, rows| change(names, rows))
}

#[test]
fn recordings_in_other_units_or_axes_are_noted() {
    let stderr = |change: fn(&str, f64) -> f64| {
        notes_of(|names, rows| {
            for (name, cell) in rows.iter_mut().flat_map(|row| names.iter().zip(row)) {
                *cell = cell.parse().map_or(cell.clone(), |number| change(name, number).to_string());
            }
        })
    };
    let misfit = "velocities do not fit positions over time: v of ";
    let as_it_is = stderr(|_, cell| cell);
    assert!(!as_it_is.contains(misfit) && !as_it_is.contains("far under z = 0"), "{as_it_is}");
    for (change, words) in [
        ((|name, cell| if name.starts_with("v_") { -cell } else { cell }) as fn(&str, f64) -> f64, "the opposite sign"),
        (|name, cell| if name.starts_with("v_left") { cell.to_degrees() } else { cell }, " is 57."),
        (|name, cell| if name.starts_with("v_left") { 2.0 * cell } else { cell }, " is 1.99"),
        (|name, cell| if name == "time" { 1e3 * cell } else { cell }, " is 1000."),
        (|name, cell| if name == "time" { 1.2 * cell } else { cell }, " is 1.20"),
        (|name, cell| if name.starts_with("v_") { 0.0 } else { cell }, "x is 0 although it moves, and "),
    ] {
        let stderr = stderr(change);
        let note = stderr.lines().find(|line| line.contains(misfit)).unwrap_or_else(|| panic!("{words}: {stderr}"));
        assert!(note.contains(words), "{note}");
        assert!(!stderr.contains("positions jump"), "of units, not of outliers: {stderr}");
    }
    // Without `--touchdowns` the first rows of a file are checked. Poses that are not in the order of time have no
    // rates to compare with.
    let is_noted = |order: fn(usize) -> usize, factor: f64, clip: usize| {
        let (names, rows) = walk_cells();
        let line = |at: usize| {
            let cell = |(column, name): (usize, &String)| match name.starts_with("v_left") {
                true => (factor * rows[order(at) % 100][column].parse::<f64>().expect("a rate")).to_string(),
                false if name == "time" => rows[at % clip][column].clone(),
                false => rows[order(at) % 100][column].clone(),
            };
            names.iter().enumerate().map(cell).collect::<Vec<_>>().join(",")
        };
        let table: Vec<String> = std::iter::once(names.join(",")).chain((0..100).map(line)).collect();
        let states = file("rates.csv", table.join("\n"));
        let run = heelstrike(&["batch", RAMONE, &states, "--friction", "0.6", "--brief"]);
        assert!(run.stderr.contains(" states: "), "{}", run.stderr);
        run.stderr.contains(misfit)
    };
    assert!(!is_noted(|at| at, 1.0, 100) && is_noted(|at| at, 57.3, 100) && is_noted(|at| at, 0.0, 100));
    assert!(!is_noted(|at| 37 * at, 0.0, 100), "they stand still");
    // In clips of two rows, the change from one clip to the next is not a motion.
    assert!(!is_noted(|at| 37 * (at / 2) + at % 2, 1.0, 2) && is_noted(|at| 37 * (at / 2) + at % 2, 57.3, 2));
    // Few rows per period: the mean of two velocities is 0.92 times the difference of their positions over time.
    let coarse = notes_of(|names, rows| {
        for (at, row) in rows.iter_mut().enumerate() {
            for (name, cell) in names.iter().zip(row) {
                let angle = 0.95 * at as f64;
                *cell = match name.as_str() {
                    "time" => at.to_string(),
                    "q_left_hip" => angle.sin().to_string(),
                    "v_left_hip" => (0.95 * angle.cos()).to_string(),
                    _ => "0".to_owned(),
                };
            }
        }
    });
    assert!(!coarse.contains(misfit), "{coarse}");
    let deep = stderr(|name, cell| if name == "q_base_z" { cell - 0.5 } else { cell });
    assert!(deep.contains("touchdowns of feet far under z = 0, which were lifted to it: "), "{deep}");
    let degrees =
        stderr(|name, cell| if name.contains("knee") || name.contains("hip") { cell.to_degrees() } else { cell });
    assert!(degrees.contains("degrees?"), "{degrees}");
}

#[test]
fn lengths_beyond_the_robot_are_noted() {
    let walk = "examples/gait/ramone_walk.csv";
    let stderr = |options: &[&str]| {
        let asked = ["batch", RAMONE, walk, "--touchdowns", "--friction", "0.6", "--brief"];
        heelstrike(&[&asked[..], options].concat()).stderr
    };
    assert!(!stderr(&["--drop", "0.02", "--touching", "near:0.02"]).contains("is it in meters?"));
    for options in [["--drop", "12"], ["--ground-height", "20"], ["--touching", "near:5"]] {
        let note =
            format!("{} of {} m is more than the robot's size", options[0], options[1].trim_start_matches("near:"));
        assert!(stderr(&options).contains(&note), "{}", stderr(&options));
    }
}

/// If rows are missing or out of place, the touchdown next to them is lost or has the state after it.
#[test]
fn rows_that_are_missing_or_out_of_order_are_noted() {
    let notes = |change: Change| notes_of(|_, rows| change(rows));
    let whole = notes(&|_| {});
    assert!(!whole.contains("order of time") && !whole.contains("without an impact, as"), "{whole}");
    assert!(!whole.contains("rows seem to be missing"), "{whole}");
    let cases: [(&str, Change); 4] = [
        ("touchdowns without an impact, as their foot does not come down: 1; ", &|rows| drop(rows.drain(47..51))),
        ("note: rows seem to be missing once, first from ", &|rows| drop(rows.remove(29))),
        ("rows are not in the order of time, which goes back once, first from ", &|rows| rows.swap(48, 49)),
        ("no touchdown found: the time never rises", &|rows| rows.iter_mut().for_each(|row| row[1] = "0.5".to_owned())),
    ];
    for (note, change) in cases {
        let found = notes(change);
        assert!(found.contains(note), "{note}: {found}");
    }
}

/// Velocities from differences are false where rows are, whether touchdowns are looked for or not.
#[test]
fn differences_of_doubtful_rows_are_noted() {
    let notes = |change: Change| {
        notes_with(&["--velocity", "central", "--refused", "ok"], |names, rows| {
            change(rows);
            let positions = names.iter().take_while(|name| !name.starts_with("v_")).count();
            rows.iter_mut().chain([names]).for_each(|row| row.truncate(positions));
        })
    };
    let later = |row: &mut Vec<String>| row[1] = (1e3 * row[1].parse::<f64>().expect("a time")).to_string();
    let whole = notes(&|_| {});
    assert!(!whole.contains("note"), "{whole}");
    let cases: [(&str, Change); 4] = [
        ("rows are not in the order of time, which goes back once, first from ", &|rows| rows.swap(48, 49)),
        ("more than two rows have the same time once, first at 0.", &|rows| {
            (29..31).for_each(|at| rows[at][1] = rows[28][1].clone());
        }),
        ("rows are 7.624 s apart: is the time in seconds?", &|rows| rows.iter_mut().for_each(later)),
        ("positions jump 2 times, first from 0.", &|rows| rows[30][3] = "0.7".to_owned()),
    ];
    for (note, change) in cases {
        let found = notes(change);
        assert!(found.contains(note), "{note}: {found}");
    }
}

/// Recordings may repeat frames, lose markers, join trials, round times, or have their ground elsewhere than z = 0.
#[test]
fn rows_that_no_robot_moves_through_are_noted() {
    let names = walk_cells().0;
    let place = |name: &str| names.iter().position(|known| known == name).unwrap_or_else(|| panic!("{name}"));
    let (time, x, z, pitch) = (place("time"), place("q_base_x"), place("q_base_z"), place("q_base_pitch"));
    let number = |cell: &String| cell.parse::<f64>().expect("a number");
    let notes = |change: Change| notes_of(|_, rows| change(rows));
    let turn = |rows: &mut Rows| {
        let (v_x, v_z) = (place("v_base_x"), place("v_base_z"));
        for row in rows {
            // Leans the robot by half a radian, and gives the base's velocity in the axes of the base.
            let lean = 0.5 + number(&row[pitch]);
            let [along, up] = [v_x, v_z].map(|at| number(&row[at]));
            row[pitch] = lean.to_string();
            row[v_x] = (lean.cos() * along - lean.sin() * up).to_string();
            row[v_z] = (lean.sin() * along + lean.cos() * up).to_string();
        }
    };
    let shift = |rows: &mut Rows| {
        let again = rows.clone();
        rows.extend(again);
        rows.iter_mut().for_each(|row| row[z] = (number(&row[z]) - 0.03).to_string());
    };
    let cases: [(&str, Change); 7] = [
        ("rows repeat the positions of the row before, although the robot moves, once, first at ", &|rows| {
            rows[31] = [&rows[31][..=time], &rows[30][time + 1..]].concat();
        }),
        ("positions jump 2 times, first from 0.", &|rows| rows[30][z] = (number(&rows[30][z]) + 0.1).to_string()),
        ("positions jump once, first from 0.", &|rows| {
            rows[30..].iter_mut().for_each(|row| row[x] = (number(&row[x]) + 3.0).to_string());
        }),
        (
            "two rows of the same time have different positions 24 times, first at 0.02 s: is the time rounded? ",
            &|rows| {
                rows.iter_mut().for_each(|row| row[time] = format!("{:.2}", number(&row[time])));
            },
        ),
        ("more than two rows have the same time once, first at 0.", &|rows| {
            (29..31).for_each(|at| rows[at][time] = rows[28][time].clone());
        }),
        ("the base's velocity fits its positions over time if it is turned by the pitch: ", &turn),
        ("feet reach the ground at z = -0.03 m, in the middle of all touchdowns: ", &shift),
    ];
    for (note, change) in cases {
        let found = notes(change);
        assert!(found.contains(note), "{note}: {found}");
    }
    // Without `--touchdowns`, too.
    let (names, mut rows) = walk_cells();
    turn(&mut rows);
    let table: Vec<String> = [names].iter().chain(&rows).map(|row| row.join(",")).collect();
    let states = file("turned.csv", table.join("\n"));
    let run = heelstrike(&["batch", RAMONE, &states, "--friction", "0.6", "--brief"]);
    assert!(run.stderr.contains(cases[5].0), "{}", run.stderr);
    let later = |row: &[String], passed: f64| {
        let mut row = row.to_vec();
        row[time] = (number(&row[time]) + passed).to_string();
        row
    };
    // Ordinary recordings: unchanged, with a robot that stands at the end, with the extra rows that solvers record at
    // events, and two whole clips in a row.
    let ordinary: [Change; 4] = [
        &|_| {},
        &|rows| rows.extend((1..9).map(|at| later(&rows[101], 0.01 * f64::from(at))).collect::<Vec<_>>()),
        &|rows| {
            for at in [30, 33, 36] {
                let mean = |(a, b): (&String, &String)| (0.5 * (number(a) + number(b))).to_string();
                let cells = rows[at][time..].iter().zip(&rows[at + 1][time..]).map(mean);
                let event = rows[at][..time].iter().cloned().chain(cells).collect();
                rows.insert(at + 1, event);
            }
        },
        &|rows| {
            let again = rows.clone();
            rows.extend(again);
        },
    ];
    for change in ordinary {
        let found = notes(change);
        assert!(cases.iter().all(|(note, _)| !found.contains(&note[..20])), "{found}");
        assert!(!found.contains("rows seem to be missing"), "{found}");
    }
}
