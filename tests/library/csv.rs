//! Tables of states and of results: what is read, what is refused and with which place, and what is written.

use crate::support::impact::{outcomes, reduced, robot, velocities_after};
use crate::support::urdf::{self, Axis, HINGE, POINT, collision, joint, link};
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::read::table::{Form, Header, Rates};
use heelstrike::robot::{Base, Reduction};
use heelstrike::state::NamedContact;
use heelstrike::write::{Columns, Layout, Refused};
use heelstrike::{Defaults, Error, Friction, Robot, State};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A body with a box that can touch at two corners, a knee, and a shin with a point foot.
fn leg_urdf() -> String {
    urdf::robot(&[
        link("body", 2.0, [0.0; 2], 1.0, &collision([0.0; 2], r#"box size="0.4 0.1 0.2""#)),
        link("shin", 1.0, [0.0; 2], 0.1, &collision([0.0, -0.5], POINT)),
        joint("knee", HINGE, ["body", "shin"], [0.0; 2], ""),
    ])
}

fn leg() -> Robot {
    robot(&leg_urdf())
}

/// Parses a table with one row per line.
fn states(table: &[u8], robot: &Robot) -> Vec<Result<State, Error>> {
    let mut lines = table.split_inclusive(|&byte| byte == b'\n');
    let header = Header::read(lines.next().unwrap(), Form::Csv, robot, Rates::Columns, &[]).unwrap();
    let mut rows = header.rows();
    let mut states = Vec::new();
    for (line, record) in (2..).zip(lines) {
        let defaults = Defaults { friction: Some(Friction::Finite(0.25)), ..Defaults::default() };
        states.extend(rows.row(record, line).transpose().map(|row| row?.state(robot, &defaults)));
    }
    states
}

fn state(table: &str) -> State {
    states(table.as_bytes(), &leg()).pop().unwrap().unwrap()
}

#[test]
fn a_misspelt_frozen_joint_is_likened_to_frozen_joints() {
    let turned = joint("ankle_yaw", Axis::OffPlane, ["shin", "foot"], [0.0; 2], "");
    let turns = joint("ankle_pitch", HINGE, ["foot", "toe"], [0.0; 2], "");
    let links = ["foot", "toe"].map(|name| link(name, 1.0, [0.0; 2], 0.1, "")).concat();
    let robot = robot(&leg_urdf().replace("</robot>", &format!("{links}{turned}{turns}</robot>")));
    let refused = Header::read(b"q_ankle_yow,v_knee", Form::Csv, &robot, Rates::Columns, &[]).expect_err("no joint");
    assert_eq!(refused.remedy(), Some("did you mean q_ankle_yaw?"));
}

#[test]
fn columns_go_by_name_and_cells_may_be_missing() {
    let state = state("v_knee,id,q_base_pitch,phase,friction,q_base_z,restitution\n2e1,007,-0.5,x,infinite, .25 ,1\n");
    assert_eq!(state.position, [0.0, 0.25, -0.5, 0.0]);
    assert_eq!(state.velocity, [0.0, 0.0, 0.0, 20.0]);
    assert_eq!(state.id, Some("007".into()), "a number would lose its zeros");
    assert_eq!(state.scene.friction.default, Some(Friction::Infinite));
    assert_eq!(state.scene.restitution.default, Some(1.0));

    let state = self::state("id,friction,restitution,stance,v_knee\n,,,,1\n");
    assert_eq!((state.id, state.scene.stance), (None, None));
    assert_eq!(state.scene.friction.default, Some(Friction::Finite(0.25)), "the command line's");
    assert_eq!(state.scene.restitution.default, None);
}

#[test]
fn a_stance_places_the_base() {
    let table = "stance,q_base_x,v_base_z,v_knee\nshin,,,1\n,0.5,-1,2\n";
    let states: Vec<State> = states(table.as_bytes(), &leg()).into_iter().map(Result::unwrap).collect();
    assert_eq!(states[0].scene.stance, Some(1));
    assert_eq!((states[1].scene.stance, states[1].position[0], states[1].velocity[1]), (None, 0.5, -1.0));
}

#[test]
fn other_programs_tables_are_read() {
    let expected = [0.0, 0.25, 0.0, 0.0];
    for table in [
        "\u{feff}q_base_z,v_knee\n0.25,1\n",
        "q_base_z,v_knee\r\n0.25,1\r\n",
        "\"q_base_z\",\"v_knee\"\n\"0.25\",\"1\"",
        "q_base_z, v_knee\n\n   \n0.25, 1\n\n",
        "note,q_base_z,v_knee\n\"a, \"\"b\"\"\",+.25e0,1\n",
    ] {
        let found = states(table.as_bytes(), &leg());
        assert_eq!(found.len(), 1, "{table:?}");
        assert_eq!(found[0].as_ref().unwrap().position, expected, "{table:?}");
    }
}

/// The error with its remedy.
fn shown(error: &Error) -> String {
    let hint = error.remedy().map_or(String::new(), |hint| format!(" | {hint}"));
    format!("{error}{hint}")
}

#[test]
fn headers_that_do_not_fit_are_refused() {
    let bolted = reduced(&leg_urdf(), &Reduction { base: Some(Base::Fixed), ..Reduction::default() });
    let with_rates: [&[u8]; 33] = [
        b"q_kne,v_knee",
        b"id,\"a,b\",v_base_y",
        b"q_base_qw,q_base_qy,q_base_qx,q_base_qz,v_knee,time",
        b"q_base_qw,q_base_qy,q_base_qx,q_base_qz,time",
        b"v_knee,time,v_knee",
        b"time,v_knee,time",
        b"0.1,0.2,0.3",
        b"",
        b"q_knee",
        b"q_knee,time",
        b"v_knee,\xff",
        b"q_Knee,v_knee",
        b"Q_KNEE,v_knee,restituion,tau_knee",
        b"x,knee",
        b"v_knee,held",
        b"v_knee,mu",
        b"v_knee,v_after_knee",
        b"v_knee,\"note",
        b"# q_base_pitch,v_knee",
        b"Q_BASE_X,v_knee",
        b"v_knee,friction [-]",
        b"v_knee,coefficient_of_restitution,friction_coefficient_left_front_foot",
        b"v_knee,Ground slope [rad]",
        b"v_knee,held_knee",
        b"v_knee,rotor_inertia_knee,gravity_z",
        b"v_knee,mu_left_front_foot",
        b"v_knee,base_vel_z,qpos_base_x,base_pitch_dot",
        b"q_knee_deg,v_knee",
        b",v_knee,",
        b"q_base_X,q_base_z,v_knee",
        b"q_base_x,q_base_height,v_knee",
        b"q_base_x,q_base_z,q_base_pitch,q_knee,q_base_roll,v_knee",
        b"q_base_x,q_base_qx,q_base_qy,q_base_qz,q_base_w,v_knee",
    ];
    let with_time: [&[u8]; 5] = [
        b"q_base_qw,q_base_qy,q_base_qx,time",
        b"time,q_base_y,q_base_pitch",
        b"q_base_pitch,q_base_qw,q_base_qy,q_base_qx,q_base_qz,time",
        b"q_knee",
        b"time,q_knee,v_knee",
    ];
    let mut refusals = String::new();
    for (robot, rates, records) in [
        (&leg(), Rates::Columns, &with_rates[..]),
        (&leg(), Rates::Time, &with_time),
        (&bolted, Rates::Columns, &[b"v_knee,q_base_qw", b"v_knee,q_base_x"]),
        (&hip(), Rates::Columns, &[b"q_knee,v_rise"]),
    ] {
        for record in records {
            let error = Header::read(record, Form::Csv, robot, rates, &[]).map(|_| ()).unwrap_err();
            writeln!(refusals, "{}\n    {}", record.escape_ascii(), shown(&error)).unwrap();
        }
    }
    insta::assert_snapshot!("headers", refusals);
}

/// A leg with one joint out of the plane and a wheel that mimics its knee, on a base that is a chain of three joints.
fn hip() -> Robot {
    let [forward, up] = [[1.0, 0.0], [0.0, 1.0]].map(Axis::Prismatic);
    robot(&urdf::robot(&[
        r#"<link name="world"/><link name="rail"/><link name="lift"/>"#.to_owned(),
        ["body", "thigh", "shin", "wheel"].map(|name| link(name, 1.0, [0.0; 2], 1.0, "")).concat(),
        joint("slide", forward, ["world", "rail"], [0.0; 2], ""),
        joint("rise", up, ["rail", "lift"], [0.0; 2], ""),
        joint("tip", HINGE, ["lift", "body"], [0.0; 2], ""),
        joint("splay", HINGE, ["body", "thigh"], [0.0; 2], "").replace("0 1 0", "1 0 0"),
        joint("knee", HINGE, ["thigh", "shin"], [0.0; 2], ""),
        joint("spin", HINGE, ["shin", "wheel"], [0.0; 2], r#"<mimic joint="knee" multiplier="2"/>"#),
    ]))
}

#[test]
fn missing_columns_are_listed_by_name() {
    let missing =
        |record: &[u8], rates| Header::read(record, Form::Csv, &leg(), rates, &[]).unwrap().missing().join(" ");
    let all = "q_base_x q_base_pitch q_knee v_base_x v_base_z v_base_pitch";
    assert_eq!(missing(b"v_knee,q_base_z,tau_base_x,friction_needed,joint_friction", Rates::Columns), all);
    // A stance replaces the base's x and z, a quaternion its pitch, and the time all velocities.
    assert_eq!(missing(b"v_knee,stance", Rates::Columns), "q_base_pitch q_knee v_base_pitch");
    let quaternion = b"time,q_knee,q_base_qw,q_base_qx,q_base_qy,q_base_qz";
    assert_eq!(missing(quaternion, Rates::Time), "q_base_x q_base_z q_base_y");
}

#[test]
fn columns_of_frozen_joints_are_listed_and_not_read() {
    let robot = hip();
    let header =
        Header::read(b"q_splay,q_knee,v_spin,q_spin,v_knee,v_splay,note", Form::Csv, &robot, Rates::Columns, &[])
            .unwrap();
    assert_eq!(header.ignored().collect::<Vec<_>>(), ["q_splay", "v_spin", "q_spin", "v_splay"]);
    assert_eq!(header.carried().collect::<Vec<_>>(), ["note"]);
    let mut rows = header.rows();
    let row = rows.row(b"x,0.5,,nan,2,0,a", 2).unwrap().unwrap();
    let state = row.state(&robot, &Defaults::default()).unwrap();
    assert_eq!((&state.position[..], &state.velocity[..]), (&[0.0, 0.0, 0.0, 0.5][..], &[0.0, 0.0, 0.0, 2.0][..]));
}

#[test]
fn rows_that_do_not_fit_are_refused_with_their_place() {
    let rows: [&[u8]; 18] = [
        b"a,x,1,,,,",
        b"a,,1,,,,",
        b"\"\xc3\xa9,\"\"b\",NaN,1,,,,",
        b"a,1e999,1,,,,",
        b"a,\"1,5\",1,,,,",
        b"a,\xff,1,,,,",
        b"\xff,0,1,,,,",
        b"a,0,1,-1,,,",
        b"a,0,1,infinit,,,",
        b"a,0,1,nan,,,",
        b"a,0,1,,1.5,,",
        b"a,,1,,,shinn,",
        b"a,0,1,,,shin,",
        b"a,0,1",
        b"a",
        b"a,0,1,,,,,",
        b"a,0,1,,,,\"open",
        b"a,0,1,,,,\"closed\" too early",
    ];
    let mut refusals = String::new();
    for row in rows {
        let table = [b"id,q_base_x,v_knee,friction,restitution,stance,note\n", row].concat();
        let found = states(&table, &leg());
        let error = found[0].as_ref().map(|_| ()).unwrap_err();
        writeln!(refusals, "{}\n    {}", row.escape_ascii(), shown(error)).unwrap();
    }
    insta::assert_snapshot!("rows", refusals);
}

#[test]
fn columns_of_the_base_are_not_those_of_joints() {
    let text = leg_urdf().replace("\"knee\"", "\"x\"");
    let columns = Columns::new(&robot(&text), &[], None, Layout { touchdowns: true, ..Layout::default() });
    for name in ["v_after_base_x", "v_after_x", "q_base_x", "q_x", "v_base_x", "v_x"] {
        assert_eq!(columns.names().iter().filter(|own| *own == name).count(), 1, "{name}");
    }
}

/// A column of numbers cannot hold the word `infinite`.
#[test]
fn infinite_friction_is_a_word_or_a_number() {
    let found = states(b"q_knee,v_knee,friction\n0,0,inf\n0,0,infinite\n0,0,1e999\n", &leg());
    let friction: Vec<_> = found.iter().flatten().map(|state| state.scene.friction.default).collect();
    assert_eq!(friction, [Some(Friction::Infinite); 2]);
    // Digits beyond the range of f64 are refused, as in JSON.
    let refused = found[2].as_ref().unwrap_err().to_string();
    assert_eq!(refused, "4:5: friction: friction must be a finite number, not inf");
}

#[test]
fn broken_row_stays_out_of_the_next() {
    let table = b"q_knee,v_knee\n\"open,1\n0.5,1\n1\r2,3\n0.25,1\n";
    let found: Vec<Option<f64>> =
        states(table, &leg()).iter().map(|state| Some(state.as_ref().ok()?.position[3])).collect();
    assert_eq!(found, [None, Some(0.5), None, Some(0.25)]);
    let table = format!("q_knee,v_knee\n{},1\n", "x".repeat(1 << 20));
    let error = states(table.as_bytes(), &leg()).pop().unwrap().unwrap_err();
    assert!(shown(&error).len() < 200, "{error}");
}

/// The rows that are written for a state, by column, and its impact.
fn rows(robot: &Robot, state: &State, options: Options) -> (Vec<BTreeMap<String, String>>, Box<Impact>) {
    let impact = Pipeline::new(robot, options).impact(state).unwrap();
    let (mut out, columns) = (Vec::new(), Columns::new(robot, &[], None, Layout::default()));
    columns.append_header(&mut out);
    columns.append_result((state.id.as_ref(), None, None), &impact, None, &mut out).unwrap();
    (by_column(&out), impact)
}

fn by_column(table: &[u8]) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_reader(table).deserialize().map(Result::unwrap).collect()
}

/// Asserts that each outcome has a row with every number of the result.
fn assert_rows(rows: &[BTreeMap<String, String>], impact: &Impact, contact: &str, velocity: &[&str]) {
    assert_eq!(rows.len(), outcomes(impact).len());
    let verdict = impact.analysis.as_ref().unwrap().verdict.to_string();
    for (at, ((row, outcome), after)) in rows.iter().zip(outcomes(impact)).zip(velocities_after(impact)).enumerate() {
        let text = |column: &str| row[column].as_str();
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        assert_eq!([text("id"), text("verdict"), text("outcome")], ["k", verdict.as_str(), &(at + 1).to_string()]);
        assert_eq!(text("proven"), outcome.proven.to_string());
        assert_eq!(number("margin"), outcome.margin.unwrap());
        assert_eq!(text(&format!("mode_{contact}")), outcome.modes[0].to_string());
        assert_eq!(["t", "n"].map(|axis| number(&format!("p_{contact}_{axis}"))), outcome.impulse[0]);
        assert_eq!(velocity.iter().map(|column| number(column)).collect::<Vec<_>>(), after);
        assert_eq!([text("border"), text("family"), text("error")], ["", "false", ""]);
    }
}

#[test]
fn every_outcome_is_a_row_with_every_number() {
    let base = ["v_after_base_x", "v_after_base_z", "v_after_base_pitch"];
    let state = state("id,q_base_z,q_knee,v_base_x,v_base_z,friction\nk,0.5,0,0.1,-1,0.5\n");
    let (rows, impact) = rows(&leg(), &state, Options::default());
    assert_eq!((rows.len(), rows[0]["verdict"].as_str()), (1, "unique"));
    assert_rows(&rows, &impact, "shin", &[&base[..], &["v_after_knee"]].concat());
    assert_eq!(["mode_body", "mode_body/0", "p_body/1_n"].map(|column| rows[0][column].as_str()), [""; 3]);
    // The block leaves the ground or jams.
    let (rows, impact) = block("1.7,0.4,infinite");
    assert!(rows.len() > 1);
    assert_rows(&rows, &impact, "block", &base);
}

#[test]
fn the_header_has_every_contact_that_feet_can_give() {
    let [state, touchdown] = [false, true].map(|touchdowns| Layout { touchdowns, ..Layout::default() });
    let header = |feet: &[NamedContact], layout| {
        let mut out = Vec::new();
        Columns::new(&leg(), feet, None, layout).append_header(&mut out);
        String::from_utf8(out).unwrap()
    };
    let modes = |header: &str| -> Vec<String> {
        header.split(',').filter_map(|name| Some(name.strip_prefix("mode_")?.to_owned())).collect()
    };
    assert_eq!(
        header(&[], state),
        "id,line,verdict,outcome,margin,proven,mode_body,p_body_t,p_body_n,mode_body/0,p_body/0_t,p_body/0_n,mode_body/1,\
         p_body/1_t,p_body/1_n,mode_shin,p_shin_t,p_shin_n,v_after_base_x,v_after_base_z,v_after_base_pitch,v_after_knee,border,\
         family,families,error,notes\n"
    );
    let foot = NamedContact { link: 1, offset: [0.1, 0.0, -0.5], radius: 0.0 };
    assert_eq!(modes(&header(&[foot], state)), ["body", "body/0", "body/1", "shin", "shin/0", "shin/1"]);
    assert_eq!(modes(&header(&[], touchdown)), ["body", "body/0", "body/1", "body/2", "body/3", "shin"]);
    assert!(header(&[], touchdown).contains(
        ",v_after_knee,touchdown_row,touchdown_time,touchdown_striking,touchdown_shift_z,touchdown_at,touchdown_touching,\
         q_base_x,q_base_z,q_base_pitch,q_knee,v_base_x,v_base_z,v_base_pitch,v_knee,border,family,families,error,notes"
    ));
}

#[test]
fn contacts_called_like_other_links_have_columns() {
    let robot = robot(&leg_urdf().replace("shin", "body/0"));
    let state = states(b"q_base_z,q_knee,v_base_z\n0.1,1.5707963267948966,-1\n", &robot).pop().unwrap().unwrap();
    let (rows, impact) = rows(&robot, &state, Options::default());
    assert_eq!(impact.contacts.iter().map(|contact| &*contact.name).collect::<Vec<_>>(), ["body//0", "body//1"]);
    let modes: Vec<_> = rows[0].iter().filter(|(column, _)| column.starts_with("mode_")).collect();
    let modes: Vec<_> = modes.into_iter().map(|(column, mode)| (column.as_str(), mode.is_empty())).collect();
    assert_eq!(modes, [("mode_body", true), ("mode_body//0", false), ("mode_body//1", false), ("mode_body/0", true)]);
}

#[test]
fn a_row_has_modes_only_of_what_touches() {
    let only = |table: &str, contact_tolerance| {
        let (mut rows, _) = rows(&leg(), &state(table), Options { contact_tolerance, ..Options::default() });
        assert_eq!(rows.len(), 1);
        rows.remove(0)
    };
    let row = only("q_base_z,q_knee,v_base_z,friction\n0.1,1.5707963267948966,-1,0.5\n", Some(1e-6));
    assert_eq!(["mode_body", "mode_shin"].map(|column| row[column].as_str()), ["", ""]);
    assert!(!row["mode_body/0"].is_empty() && !row["mode_body/1"].is_empty());
    let row = only("q_base_z,v_base_z\n9,-1\n", None);
    assert_eq!(
        ["verdict", "mode_shin", "v_after_base_z"].map(|column| row[column].as_str()),
        ["no_contact", "", "-1.0"]
    );
    let row = only("q_base_z,q_base_pitch,v_base_z\n9,30,-1\n", None);
    assert!(row["notes"].starts_with("pitch = 30 rad is more than a turn; degrees?; nothing touches"), "{row:?}");
}

#[test]
fn a_contact_without_columns_is_refused() {
    let robot = leg();
    let mut state = state("q_base_z,v_base_z,friction\n0.5,-1,1\n");
    let named = |x| NamedContact { link: 1, offset: [x, 0.0, -0.5], radius: 0.0 };
    state.scene.contacts = Some(vec![named(0.0), named(0.1)]);
    let impact = Pipeline::new(&robot, Options::default()).impact(&state).unwrap();
    let (mut out, columns) = (Vec::new(), Columns::new(&robot, &[], None, Layout::default()));
    let error = columns.append_result((None, None, None), &impact, None, &mut out).unwrap_err();
    assert_eq!(
        shown(&error),
        "the table of results has no columns for contact \"shin/0\" | write NDJSON instead, or add the foot by `feet`"
    );
    assert!(out.is_empty());
}

#[test]
fn foreign_columns_are_carried_beside_a_refusal() {
    let robot = leg();
    let names = b"time,id,verdict,v_knee,error,note,in_error,family,next_modes";
    let header = Header::read(names, Form::Csv, &robot, Rates::Columns, &[]).unwrap();
    let columns = Columns::new(&robot, &[], Some(&header), Layout { next: true, ..Layout::default() });
    let mut rows = header.rows();
    let row = rows.row(b" 0.10 ,\"k,1\",mine,oops,none,\"a \"\"b\"\"\nc\",other,ours,held", 7).unwrap().unwrap();
    assert_eq!(row.time().unwrap(), 0.1);
    let error = row.state(&robot, &Defaults::default()).map(|_| ()).unwrap_err();
    let mut out = Vec::new();
    columns.append_header(&mut out);
    columns.append_refused(&Refused::new(row.id(), row.line(), &error), row.carried().as_ref(), &mut out);
    let rows = by_column(&out);
    let cell = |column: &str| rows[0][column].as_str();
    assert_eq!([cell("id"), cell("verdict"), cell("outcome")], ["k,1", "refused", ""]);
    assert_eq!(["time", "in_verdict", "in_in_error", "note"].map(cell), [" 0.10 ", "mine", "none", "a \"b\"\nc"]);
    assert_eq!(["in_error", "in_family", "family"].map(cell), ["other", "ours", ""]);
    assert_eq!(["next_modes", "in_next_modes"].map(cell), ["", "held"]);
    assert_eq!(cell("error"), "line 7: v_knee: expected a number, found \"oops\"");
}

/// The rows and the impact of a state of the block, whose G is [[2, 1], [1, 2]].
fn block(row: &str) -> (Vec<BTreeMap<String, String>>, Box<Impact>) {
    let robot = robot(include_str!("../../urdf/block.urdf"));
    let state = states(format!("id,v_base_x,v_base_z,friction\nk,{row}\n").as_bytes(), &robot).pop().unwrap().unwrap();
    rows(&robot, &state, Options::default())
}

#[test]
fn a_border_has_what_is_zero_and_a_family_its_modes() {
    let found = |row: &str| -> Vec<[String; 3]> {
        block(row).0.iter().map(|row| ["border", "family", "families"].map(|column| row[column].clone())).collect()
    };
    // At rest nothing presses the block, so that L_n = 0. Struck, it stops inside its friction cone.
    assert_eq!(found("0,0,0.5"), [["block: L_n = 0", "false", ""]]);
    assert_eq!(found("-0.5,-1,0.5"), [["", "false", ""]]);
    // At friction 2 a slide has L_t = -2 L_n, so that c_n = L_t + 2 L_n = 0: it stops, slides on, or anything between.
    let ends = [["block: |L_t| = mu L_n", "true", "slide+"], ["block: L_n = 0", "true", "slide+"]];
    assert_eq!(found("1,0,2"), ends);
}
