//! States from tables and results as tables: what is read, what is refused and where, and what is written.

use crate::support::after::velocities_after;
use heelstrike::impact::Friction;
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::robot::{Base, Reduction};
use heelstrike::state::NamedContact;
use heelstrike::state::{Defaults, State};
use heelstrike::write::{Detail, Refused, Report};
use heelstrike::{Error, Robot};
use heelstrike::{
    read::table::{Header, Rates},
    write::Columns,
};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A hip and a knee, a point for a foot, and a box on the body that can touch at two corners.
const LEG: &str = r#"<robot name="leg">
    <link name="body"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
        <collision><geometry><box size="0.4 0.1 0.2"/></geometry></collision></link>
    <link name="shin"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="1"/></inertial>
        <collision><origin xyz="0 0 -0.5"/><geometry><sphere radius="0"/></geometry></collision></link>
    <joint name="knee" type="continuous"><parent link="body"/><child link="shin"/><axis xyz="0 1 0"/></joint>
</robot>"#;

fn leg() -> Robot {
    Robot::from_urdf(LEG).unwrap()
}

fn bolted_leg() -> Robot {
    let description = heelstrike::description::Description::from_urdf(LEG).unwrap();
    Robot::reduce(&description, &Reduction { base: Some(Base::Fixed), ..Reduction::default() }).unwrap()
}

/// The states of a table whose every row is on a line of its own.
fn states(table: &[u8], robot: &Robot) -> Vec<Result<State, Error>> {
    let mut lines = table.split_inclusive(|&byte| byte == b'\n');
    let header = Header::read(lines.next().unwrap(), robot, Rates::Columns).unwrap();
    let mut rows = header.rows();
    let mut states = Vec::new();
    for (line, record) in (2..).zip(lines) {
        match rows.row(record, line) {
            Ok(Some(row)) => states
                .push(row.state(robot, &Defaults { friction: Some(Friction::Finite(0.25)), ..Defaults::default() })),
            Ok(None) => {}
            Err(error) => states.push(Err(error)),
        }
    }
    states
}

fn state(table: &str) -> State {
    states(table.as_bytes(), &leg()).pop().unwrap().unwrap()
}

#[test]
fn columns_go_by_name_and_what_has_none_is_zero() {
    let state = state("v_knee,id,q_base_pitch,phase,friction,q_base_z,restitution\n2e1,007,-0.5,x,infinite, .25 ,1\n");
    assert_eq!(state.position, [0.0, 0.25, -0.5, 0.0]);
    assert_eq!(state.velocity, [0.0, 0.0, 0.0, 20.0]);
    assert_eq!(state.id, Some("007".into()), "a number would lose its zeros");
    assert_eq!(state.scene.friction.default, Some(Friction::Infinite));
    assert_eq!(state.scene.restitution.default, Some(1.0));
}

#[test]
fn empty_cells_leave_open_what_need_not_be_given() {
    let state = state("id,friction,restitution,stance,v_knee\n,,,,1\n");
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

/// The error as a person sees it.
fn told(error: &Error) -> String {
    let hint = error.remedy().map_or(String::new(), |hint| format!(" | {hint}"));
    format!("{error}{hint}")
}

#[test]
fn a_header_that_does_not_fit_is_refused_with_the_columns_place() {
    let (leg, bolted) = (leg(), bolted_leg());
    let mut refusals = String::new();
    for (robot, rates, records) in [
        (
            &leg,
            Rates::Columns,
            &[
                &b"q_kne,v_knee"[..],
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
            ][..],
        ),
        (
            &leg,
            Rates::Time,
            &[
                &b"q_base_qw,q_base_qy,q_base_qx,time"[..],
                b"time,q_base_y,q_base_pitch",
                b"q_base_pitch,q_base_qw,q_base_qy,q_base_qx,q_base_qz,time",
                b"q_knee",
                b"time,q_knee,v_knee",
            ][..],
        ),
        (&bolted, Rates::Columns, &[&b"v_knee,q_base_qw"[..], b"v_knee,q_base_x"][..]),
    ] {
        for record in records {
            let error = Header::read(record, robot, rates).map(|_| ()).unwrap_err();
            writeln!(refusals, "{}\n    {}", record.escape_ascii(), told(&error)).unwrap();
        }
    }
    insta::assert_snapshot!("headers", refusals);
}

/// A leg that can swing out of the plane, with a wheel that follows its knee; its base is a chain of three joints.
const HIP: &str = r#"<robot name="hip"><link name="world"/>
    <link name="rail"/><link name="lift"/>
    <link name="body"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
    <link name="thigh"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
    <link name="shin"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
    <link name="wheel"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
    <joint name="slide" type="prismatic"><parent link="world"/><child link="rail"/><axis xyz="1 0 0"/>
        <limit effort="1" velocity="1" lower="-9" upper="9"/></joint>
    <joint name="rise" type="prismatic"><parent link="rail"/><child link="lift"/><axis xyz="0 0 1"/>
        <limit effort="1" velocity="1" lower="-9" upper="9"/></joint>
    <joint name="tip" type="continuous"><parent link="lift"/><child link="body"/><axis xyz="0 1 0"/></joint>
    <joint name="splay" type="continuous"><parent link="body"/><child link="thigh"/><axis xyz="1 0 0"/></joint>
    <joint name="knee" type="continuous"><parent link="thigh"/><child link="shin"/><axis xyz="0 1 0"/></joint>
    <joint name="spin" type="continuous"><parent link="shin"/><child link="wheel"/><axis xyz="0 1 0"/>
        <mimic joint="knee" multiplier="2"/></joint>
</robot>"#;

#[test]
fn columns_of_joints_without_a_coordinate_are_told_and_not_read() {
    let robot = Robot::from_urdf(HIP).unwrap();
    let header = Header::read(b"q_splay,q_knee,v_spin,q_spin,v_knee,v_splay,note", &robot, Rates::Columns).unwrap();
    assert_eq!(header.ignored().collect::<Vec<_>>(), ["q_splay", "v_spin", "q_spin", "v_splay"]);
    assert_eq!(header.carried().collect::<Vec<_>>(), ["note"]);
    let mut rows = header.rows();
    let row = rows.row(b"x,0.5,,nan,2,0,a", 2).unwrap().unwrap();
    let state = row.state(&robot, &Defaults::default()).unwrap();
    assert_eq!((&state.position[..], &state.velocity[..]), (&[0.0, 0.0, 0.0, 0.5][..], &[0.0, 0.0, 0.0, 2.0][..]));
}

#[test]
fn a_joint_of_the_base_is_given_as_the_base() {
    let robot = Robot::from_urdf(HIP).unwrap();
    let error = Header::read(b"q_knee,v_rise", &robot, Rates::Columns).map(|_| ()).unwrap_err();
    assert_eq!(
        told(&error),
        "1:8: column 2: joint \"rise\" is part of the floating base: x, z and pitch of body take its place | give v_base_x, v_base_z and v_base_pitch"
    );
}

#[test]
fn a_row_that_does_not_fit_is_refused_with_line_and_column() {
    let rows: [&[u8]; 18] = [
        b"a,x,1,,,,",
        b"a,,1,,,,",
        b"\"a,b\",NaN,1,,,,",
        b"a,1e999,1,,,,",
        b"a,\"1,5\",1,,,,",
        b"a,\xff,1,,,,",
        b"\xff,0,1,,,,",
        b"a,0,1,-1,,,",
        b"a,0,1,inf,,,",
        b"a,0,1,infinit,,,",
        b"a,0,1,nan,,,",
        b"a,0,1,,1.5,,",
        b"a,,1,,,shinn,",
        b"a,0,1,,,shin,",
        b"a,0,1",
        b"a",
        b"a,0,1,,,,,",
        b"a,0,1,,,,\"open",
    ];
    let mut refusals = String::new();
    for row in rows {
        let table = [b"id,q_base_x,v_knee,friction,restitution,stance,note\n", row].concat();
        let found = states(&table, &leg());
        let error = found[0].as_ref().map(|_| ()).unwrap_err();
        writeln!(refusals, "{}\n    {}", row.escape_ascii(), told(error)).unwrap();
    }
    insta::assert_snapshot!("rows", refusals);
}

#[test]
fn a_broken_row_does_not_touch_the_next() {
    let table = b"q_knee,v_knee\n\"open,1\n0.5,1\n1\r2,3\n0.25,1\n";
    let found: Vec<Option<f64>> =
        states(table, &leg()).iter().map(|state| Some(state.as_ref().ok()?.position[3])).collect();
    assert_eq!(found, [None, Some(0.5), None, Some(0.25)]);
}

#[test]
fn a_long_cell_stays_out_of_the_message() {
    let table = format!("q_knee,v_knee\n{},1\n", "x".repeat(1 << 20));
    let error = states(table.as_bytes(), &leg()).pop().unwrap().unwrap_err();
    assert!(told(&error).len() < 200, "{error}");
}

/// The rows that are written for a state of the leg, by column.
fn written(columns: &Columns, state: &State, options: Options) -> Vec<BTreeMap<String, String>> {
    let robot = leg();
    rows(&robot, columns, state, &Pipeline::new(&robot, options).impact(state).unwrap())
}

fn rows(robot: &Robot, columns: &Columns, state: &State, impact: &Impact) -> Vec<BTreeMap<String, String>> {
    let report = Report::of_state(robot, state, impact, Detail::default()).unwrap();
    let mut out = Vec::new();
    columns.append_header(&mut out);
    columns.append_result(&report, None, &mut out).unwrap();
    by_column(&out)
}

fn by_column(table: &[u8]) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_reader(table).deserialize().map(Result::unwrap).collect()
}

#[test]
fn an_outcome_is_a_row_with_every_number_of_the_result() {
    let robot = leg();
    let columns = Columns::new(&robot, &[], None, false);
    let state = state("id,q_base_z,q_knee,v_base_x,v_base_z,friction\nk1,0.5,0,0.1,-1,0.5\n");
    let rows = written(&columns, &state, Options::default());
    let impact = Pipeline::new(&robot, Options::default()).impact(&state).unwrap();
    let analysis = impact.analysis.as_ref().unwrap();
    let outcome = &analysis.outcomes[0];
    assert_eq!((rows.len(), analysis.outcomes.len()), (1, 1));
    let row = &rows[0];
    let text = |column: &str| row[column].as_str();
    let number = |column: &str| row[column].parse::<f64>().unwrap();
    assert_eq!([text("id"), text("verdict"), text("outcome")], ["k1", "unique", "1"]);
    assert_eq!(text("proven"), outcome.proven.to_string());
    assert_eq!(number("margin"), outcome.margin.unwrap());
    assert_eq!(text("mode_shin"), outcome.modes[0].to_string());
    assert_eq!([number("p_shin_t"), number("p_shin_n")], outcome.impulse[0]);
    let velocity = ["v_base_x", "v_base_z", "v_base_pitch", "v_knee"].map(number);
    assert_eq!(velocity[..], velocities_after(&impact)[0]);
    assert_eq!([text("mode_body"), text("mode_body/0"), text("p_body/1_n"), text("border")], [""; 4]);
    assert_eq!([text("family"), text("error")], ["false", ""]);
}

#[test]
fn the_header_has_every_contact_that_the_feet_can_give() {
    let header = |feet: &[NamedContact], touchdowns| {
        let mut out = Vec::new();
        Columns::new(&leg(), feet, None, touchdowns).append_header(&mut out);
        String::from_utf8(out).unwrap()
    };
    let modes = |header: &str| -> Vec<String> {
        header.split(',').filter_map(|name| Some(name.strip_prefix("mode_")?.to_owned())).collect()
    };
    assert_eq!(
        header(&[], false),
        "id,verdict,outcome,margin,proven,mode_body,p_body_t,p_body_n,mode_body/0,p_body/0_t,p_body/0_n,mode_body/1,\
         p_body/1_t,p_body/1_n,mode_shin,p_shin_t,p_shin_n,v_base_x,v_base_z,v_base_pitch,v_knee,border,family,error\n"
    );
    let foot = NamedContact { link: 1, offset: [0.1, 0.0, -0.5], radius: 0.0 };
    assert_eq!(modes(&header(&[foot], false)), ["body", "body/0", "body/1", "shin", "shin/0", "shin/1"]);
    assert_eq!(modes(&header(&[], true)), ["body", "body/0", "body/1", "body/2", "body/3", "shin"]);
    assert!(header(&[], true).contains(
        ",v_knee,touchdown_row,touchdown_time,touchdown_striking,touchdown_shift_z,touchdown_at,touchdown_touching,border,\
         family,error"
    ));
}

#[test]
fn two_corners_have_columns_of_their_own() {
    let columns = Columns::new(&leg(), &[], None, false);
    let state = state("q_base_z,q_knee,v_base_z,friction\n0.1,1.5707963267948966,-1,0.5\n");
    let rows = written(&columns, &state, Options { contact_tolerance: Some(1e-6), ..Options::default() });
    assert_eq!(rows.len(), 1);
    assert_eq!((rows[0]["mode_body"].as_str(), rows[0]["mode_shin"].as_str()), ("", ""));
    assert!(!rows[0]["mode_body/0"].is_empty() && !rows[0]["mode_body/1"].is_empty());
}

#[test]
fn a_state_in_the_air_has_a_row_without_modes() {
    let columns = Columns::new(&leg(), &[], None, false);
    let rows = written(&columns, &state("q_base_z,v_base_z\n9,-1\n"), Options::default());
    assert_eq!(rows.len(), 1);
    assert_eq!((rows[0]["verdict"].as_str(), rows[0]["mode_shin"].as_str()), ("no_contact", ""));
    assert_eq!(rows[0]["v_base_z"], "-1.0");
}

#[test]
fn a_contact_without_columns_is_refused_and_nothing_is_written() {
    let robot = leg();
    let columns = Columns::new(&robot, &[], None, false);
    let mut state = state("q_base_z,v_base_z,friction\n0.5,-1,1\n");
    let named = |x| NamedContact { link: 1, offset: [x, 0.0, -0.5], radius: 0.0 };
    state.scene.contacts = Some(vec![named(0.0), named(0.1)]);
    let impact = Pipeline::new(&robot, Options::default()).impact(&state).unwrap();
    let report = Report::of_state(&robot, &state, &impact, Detail::default()).unwrap();
    let mut out = Vec::new();
    let error = columns.append_result(&report, None, &mut out).unwrap_err();
    assert_eq!(
        told(&error),
        "the table of results has no columns for contact \"shin/0\" | write NDJSON instead, or add the foot by `feet`"
    );
    assert!(out.is_empty());
}

#[test]
fn foreign_columns_are_carried_through_also_beside_a_refusal() {
    let robot = leg();
    let header = Header::read(b"time,id,verdict,v_knee,error,note,in_error,family", &robot, Rates::Columns).unwrap();
    let columns = Columns::new(&robot, &[], Some(&header), false);
    let mut rows = header.rows();
    let row = rows.row(b" 0.10 ,\"k,1\",mine,oops,none,\"a \"\"b\"\"\nc\",other,ours", 7).unwrap().unwrap();
    assert_eq!(row.time().unwrap(), 0.1);
    let error = row.state(&robot, &Defaults::default()).map(|_| ()).unwrap_err();
    let mut out = Vec::new();
    columns.append_header(&mut out);
    columns.append_refused(&Refused::new(row.id(), row.line(), &error), Some(&row.carried()), &mut out);
    let rows = by_column(&out);
    let cell = |column: &str| rows[0][column].as_str();
    assert_eq!([cell("id"), cell("verdict"), cell("outcome")], ["k,1", "refused", ""]);
    assert_eq!(
        [cell("time"), cell("in_verdict"), cell("in_in_error"), cell("note")],
        [" 0.10 ", "mine", "none", "a \"b\"\nc"]
    );
    assert_eq!([cell("in_error"), cell("in_family"), cell("family")], ["other", "ours", ""]);
    assert_eq!(cell("error"), "line 7: v_knee: expected a number, found \"oops\"");
}

/// A state of the block, whose G is [[2, 1], [1, 2]], and its rows.
fn block(row: &str) -> (Vec<BTreeMap<String, String>>, Impact) {
    let robot = Robot::from_urdf(include_str!("../../urdf/block.urdf")).unwrap();
    let state = states(format!("id,v_base_x,v_base_z,friction\nk,{row}\n").as_bytes(), &robot).pop().unwrap().unwrap();
    let impact = Pipeline::new(&robot, Options::default()).impact(&state).unwrap();
    (rows(&robot, &Columns::new(&robot, &[], None, false), &state, &impact), impact)
}

#[test]
fn a_border_is_told_by_what_is_zero_and_a_family_by_its_ends() {
    let told = |row: &str| -> Vec<[String; 2]> {
        block(row).0.iter().map(|row| [&row["border"], &row["family"]].map(String::clone)).collect()
    };
    // Resting, it is not pressed; struck, it stops with less than all of its friction.
    assert_eq!(told("0,0,0.5"), [["block: L_n = 0", "false"]]);
    assert_eq!(told("-0.5,-1,0.5"), [["", "false"]]);
    // At friction 2 sliding loads the contact by just what brakes it: it stops, goes on, or anything between.
    assert_eq!(told("1,0,2"), [["block: |L_t| = mu L_n", "true"], ["block: L_n = 0", "true"]]);
}

#[test]
fn every_outcome_has_a_row_of_its_own() {
    // It leaves the ground, or jams.
    let (rows, impact) = block("1.7,0.4,infinite");
    let outcomes = &impact.analysis.as_ref().unwrap().outcomes;
    assert!(outcomes.len() > 1);
    assert_eq!(rows.len(), outcomes.len());
    for (at, (row, outcome)) in rows.iter().zip(outcomes).enumerate() {
        assert_eq!((row["id"].as_str(), row["verdict"].as_str()), ("k", "ambiguous"));
        assert_eq!(row["outcome"], (at + 1).to_string());
        assert_eq!(row["mode_block"], outcome.modes[0].to_string());
        assert_eq!(row["p_block_n"].parse::<f64>().unwrap(), outcome.impulse[0][1]);
    }
}
