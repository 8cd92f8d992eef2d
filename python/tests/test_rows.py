"""Arrays of states: the same answers as the command, bad rows as values, bad arrays with a remedy."""

import csv
import io
import json
import pickle
import subprocess

import numpy as np
import pytest
from conftest import COMMAND, ROOT

import heelstrike
from heelstrike import Mode, Verdict


def state(robot, q, v, **scene):
    """The state, as a dictionary, of a row of q and v."""

    def part(entries):
        named = dict(zip(robot.coordinates, entries.tolist()))
        return {"base": {name: named.pop(name) for name in ("x", "z", "pitch")}, "joints": named}

    return {"position": part(q), "velocity": part(v), **scene}


def command(*arguments, states=None):
    lines = None if states is None else "".join(json.dumps(state) + "\n" for state in states)
    done = subprocess.run([*COMMAND, *map(str, arguments)], input=lines, capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return done.stdout


@pytest.mark.parametrize("aspect", ["impacts", "forces"])
def test_numbers_are_those_of_the_command(ramone, walk, aspect):
    q, v = walk(300)
    v[::7] = 0.0
    v[1, 3] = 1e308
    states = [state(ramone, *row, friction=0.4, place="lowest", id=at) for at, row in enumerate(zip(q, v))]
    forces = ["--forces"] if aspect == "forces" else []
    lines = command("batch", ROOT / "urdf/ramone.urdf", "-", "--quiet", *forces, states=states).splitlines()
    answers = getattr(ramone, aspect)(q, v, friction=0.4, place="lowest", threads=2)
    after = ("base_acceleration", "joint_acceleration") if forces else ("base_velocity_after", "joint_velocity_after")
    numbers = (answers.force, answers.acceleration) if forces else (answers.impulse, answers.velocity_after)
    assert len(lines) == len(answers)
    for at, line in enumerate(map(json.loads, lines)):
        assert heelstrike.Verdict[line.get("verdict", "refused").upper()] == answers.verdict[at]
        if "error" in line:
            assert line["error"]["message"] in answers.error[at]
            continue
        assert answers.error[at] is None
        assert answers.all_proven[at] == line["proven"]
        own = range(answers.offsets[at], answers.offsets[at + 1])
        assert len(own) == len(line["outcomes"])
        for row, outcome in zip(own, line["outcomes"]):
            places = [answers.contacts.index(contact["name"]) for contact in line["contacts"]]
            modes = [mode.upper().replace("+", "_PLUS").replace("-", "_MINUS") for mode in outcome["modes"]]
            assert [Mode(mode).name for mode in answers.modes[row, places]] == modes
            assert (answers.modes[row] == Mode.OPEN).sum() == len(answers.contacts) - len(places)
            assert numbers[0][row, places].tolist() == outcome["force" if forces else "impulse"]
            assert numbers[1][row].tolist() == [entry for part in after for entry in outcome[part].values()]
            margin = answers.margin[row]
            assert (None if np.isnan(margin) else margin) == outcome["margin"]
            assert answers.index[row] == (outcome["index"] or 0)
            assert answers.proven[row] == outcome["proven"]
            assert answers.family[row] == outcome.get("family", False)


def test_table_is_that_of_the_command(ramone, walk, tmp_path):
    q, v = walk(200)
    q[3, 1] = np.nan
    ids = [f"k{at}" for at in range(len(q))]
    rows = [state(ramone, *row, friction=0.4, place="lowest", id=id) for id, *row in zip(ids, q, v)]
    rows[3]["position"]["base"]["z"] = None
    output = tmp_path / "out.csv"
    command("batch", ROOT / "urdf/ramone.urdf", "-", "-o", output, "--quiet", states=rows)
    written = list(csv.DictReader(io.StringIO(output.read_text())))
    table = ramone.impacts(q, v, friction=0.4, place="lowest").to_arrow(ids)
    names = list(written[0])
    names.remove("line")
    assert table.column_names == names
    assert table.num_rows == len(written)
    for own, row in zip(table.to_pylist(), written):
        for name in names:
            value = own[name]
            if name == "error" and value:
                assert value == "q of z must be a finite number, not NaN"
                assert row[name] == "line 4: position.base.z: expected a number, found null; leave the field out"
            elif name == "notes" and value:
                assert value == row[name].replace("`contact_tolerance: ", "`contact_tolerance=")
            elif value is None or isinstance(value, (bool, str)):
                assert row[name] == {None: "", True: "true", False: "false"}.get(value, value), (name, own)
            else:
                assert float(row[name]) == value, (name, own)
    assert sum("`contact_tolerance=" in (value or "") for value in table["notes"].to_pylist()) > 3
    frame = ramone.impacts(q, v, friction=0.4, place="lowest").to_pandas()
    assert list(frame.columns) == names and len(frame) == table.num_rows


def test_refused_row_is_a_value(ramone, walk):
    q, v = walk(6)
    q[1, 4] = np.nan
    v[2, 0] = np.inf
    friction = np.array([0.5, 0.5, 0.5, -1.0, np.nan, np.inf])
    answers = ramone.impacts(q, v, friction=friction, place="lowest")
    assert (answers.verdict == Verdict.REFUSED).tolist() == [False, True, True, True, True, False]
    assert answers.error[1] == "q of left_knee must be a finite number, not NaN"
    assert answers.error[3] == "friction must be 0 or more, not -1"
    assert answers.error[0] is None
    assert np.diff(answers.offsets)[[1, 2, 3, 4]].tolist() == [0, 0, 0, 0]
    deep = ramone.impacts(np.zeros((1, 7)), np.zeros((1, 7)), friction=1)
    assert "deep in the ground" in deep.error[0]
    silent = ramone.impacts(q[:1], v[:1], place="lowest")
    assert "`friction=0.8`" in silent.error[0]
    assert f"first refusal: {silent.error[0]}" in repr(silent)


def test_arrays_cannot_be_changed(ramone, walk):
    answers = ramone.impacts(*walk(3), friction=1, place="lowest")
    for array in (answers.verdict, answers.offsets, answers.modes, answers.impulse, answers.velocity_after):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 9
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.setflags(write=True)
    assert len(answers.to_pandas()) == len(answers.margin)


def test_masked_numbers_are_refused(ramone, walk):
    q, v = walk(3)
    masked = np.ma.masked_array(q, mask=np.arange(21).reshape(3, 7) == 10)
    answers = ramone.impacts(masked, v, friction=1, place="lowest")
    assert (answers.verdict == Verdict.REFUSED).tolist() == [False, True, False]
    one = ramone.impacts(q[:1], v[:1], friction=np.ma.masked_array([0.5], mask=[True]), place="lowest")
    assert one.verdict[0] == Verdict.REFUSED


def test_infinite_friction_may_be_written_as_numbers_are(ramone, walk):
    q, v = walk(30)
    expected = ramone.impacts(q, v, friction="infinite", place="lowest")
    for infinite in (np.inf, "inf", np.float64("inf"), {"default": np.inf}, {"left_foot": "inf", "right_foot": np.inf}):
        answers = ramone.impacts(q, v, friction=infinite, place="lowest")
        assert answers.impulse.tobytes() == expected.impulse.tobytes(), infinite


def test_numbers_that_are_not_decided_are_nan(walk):
    robot = heelstrike.Robot(ROOT / "urdf/ramone.urdf", budget=0)
    spots = [(link, x) for link in ("left_shank", "right_shank", "torso") for x in (0.1, -0.1)]
    contacts = [{"link": link, "offset": [x, 0, -0.2]} for link, x in spots]
    answers = robot.impacts(*walk(20), friction=0.5, contacts=contacts)
    undecided = np.flatnonzero(answers.verdict == Verdict.UNDECIDED)
    rows = [row for at in undecided for row in range(answers.offsets[at], answers.offsets[at + 1])]
    rows = [row for row in rows if not answers.proven[row]]
    assert rows
    assert all(answers.notes[at].endswith("the budget of work ended (`budget`)") for at in undecided)
    for row in rows:
        assert np.isnan(answers.impulse[row]).all() and np.isnan(answers.velocity_after[row]).all()
    table = answers.to_arrow()
    named = zip(table["verdict"].to_pylist(), table["proven"].to_pylist(), table["v_after_base_x"].to_pylist())
    velocities = [velocity for verdict, proven, velocity in named if verdict == "undecided" and proven is False]
    assert velocities and set(velocities) == {None}


def test_foot_in_a_notch_has_two_contacts():
    text = """<robot name="ball"><link name="ball"><inertial><mass value="1"/>
        <inertia ixx="0.004" ixy="0" ixz="0" iyy="0.004" iyz="0" izz="0.004"/></inertial>
        <collision><geometry><sphere radius="0.1"/></geometry></collision></link></robot>"""
    ball = heelstrike.Robot.from_string(text)
    notch = {"profile": [[-1, 1], [0, 0], [1, 1]]}
    q, v = np.array([[0, 0.1 * np.sqrt(2), 0]]), np.array([[0.0, -1, 0]])
    answers = ball.impacts(q, v, friction=0, ground=notch)
    assert (answers.contacts, answers.error) == (["ball", "ball/0", "ball/1"], [None])
    assert answers.velocity_after.tolist() == [pytest.approx([0, 0, 0], abs=1e-12)]


def test_stance_places_the_base(ramone, walk):
    q, v = walk(3)
    q[:, 2:] = [0, 0, 0, 0.3, -0.6]
    q[0, :2], v[0, :2], q[1, :2], v[1, :2] = np.nan, np.nan, 0, 0
    answers = ramone.impacts(q, v, friction=0.5, stance="left_foot")
    assert not (answers.verdict == Verdict.REFUSED).any()
    assert ["stance places the base" in (notes or "") for notes in answers.notes] == [False, False, True]
    bare = ramone.impacts(q * [0, 0, 1, 1, 1, 1, 1], v * [0, 0, 1, 1, 1, 1, 1], friction=0.5, stance="left_foot")
    assert bare.velocity_after[bare.offsets[1] :].tolist() == answers.velocity_after[answers.offsets[1] :].tolist()


def test_data_frame_is_in_the_order_of_the_coordinates(ramone, walk):
    pandas = pytest.importorskip("pandas")
    q, v = (pandas.DataFrame(part, columns=ramone.coordinates) for part in walk(3))
    expected = ramone.impacts(*walk(3), friction=0.5, place="lowest").velocity_after.tolist()
    assert ramone.impacts(q, v, friction=0.5, place="lowest").velocity_after.tolist() == expected
    with pytest.raises(ValueError, match="q has the columns left_hip, .*not in the order.*: give q.robot.coordinates"):
        ramone.impacts(q[sorted(q)], v, friction=0.5)
    of_tables = {name: f"q_base_{name}" if name in ("x", "z", "pitch") else f"q_{name}" for name in q}
    scene = {"friction": 0.5, "place": "lowest"}
    assert ramone.impacts(q.rename(columns=of_tables), v, **scene).velocity_after.tolist() == expected
    pyarrow = pytest.importorskip("pyarrow")
    for own in (q.rename(columns=of_tables), q.rename(columns={"left_hip": "hip"}), pyarrow.table(q.to_dict("list"))):
        other = own.iloc[:, ::-1] if hasattr(own, "iloc") else own.select(own.column_names[::-1])
        with pytest.raises(ValueError, match="not in the order of robot.coordinates: give "):
            ramone.impacts(other, v, friction=0.5, place="lowest")
    unnamed = q.rename(columns={"x": "q0"})
    assert ramone.impacts(unnamed, v, friction=0.5, place="lowest").velocity_after.tolist() == expected


@pytest.mark.parametrize("names", [("base_x", "base_z"), ("hip", "q_hip"), ("q_hip", "hip")])
def test_joints_may_be_named_as_columns_are(names):
    pandas = pytest.importorskip("pandas")
    inertial = """<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>"""
    parts = [
        f"""<link name="l{at + 1}">{inertial}</link><joint name="{name}" type="continuous"><parent link="l{at}"/>
            <child link="l{at + 1}"/><origin xyz="0 0 -1"/><axis xyz="0 1 0"/></joint>"""
        for at, name in enumerate(names)
    ]
    text = f"""<robot name="arm"><link name="l0"/>{"".join(parts)}</robot>"""
    arm = heelstrike.Robot.from_string(text, base="fixed")
    q = pandas.DataFrame(np.zeros((2, 2)), columns=names)
    assert len(arm.impacts(q, q)) == 2
    with pytest.raises(ValueError, match="not in the order of robot.coordinates"):
        arm.impacts(q[list(names[::-1])], q)


def test_refused_rows_do_not_change_the_types_of_a_data_frame(ramone, walk):
    q, v = walk(2)
    q[1, 0] = np.nan
    frame = ramone.impacts(q, v, friction=0.5, place="lowest").to_pandas()
    assert frame[frame.proven].id.tolist() == [0] and frame.outcome.dtype == "Int64"


def test_unknown_argument_is_refused_with_the_one_that_is_meant(ramone, walk):
    with pytest.raises(TypeError, match="there is no argument 'thread'; did you mean threads?"):
        ramone.impacts(*walk(1), thread=1)
    with pytest.raises(TypeError, match="did you mean ground?"):
        ramone.impacts(*walk(1), friction=0.5, grond={"slope": 0.1})
    with pytest.raises(heelstrike.Refused, match="^ground: "):
        ramone.impacts(*walk(1), friction=1, ground=3)
    with pytest.raises(heelstrike.Refused, match="^ground.gravity: unknown field"):
        ramone.impacts(*walk(1), friction=1, ground={"gravity": 1}, gravity=9.8)


def test_other_arrays_are_converted(ramone, walk):
    q, v = walk(20)
    expected = ramone.impacts(q, v, friction=0.5, place="lowest")
    single = ramone.impacts(q.astype(np.float32).astype(float), v, friction=0.5, place="lowest")
    for own, other in [
        (np.asfortranarray(q), np.asfortranarray(v)),
        (q[::-1][::-1], v[::-1].copy()[::-1]),
        (q.tolist(), v.tolist()),
        (np.repeat(q, 2, axis=1)[:, ::2], v),
        (q.astype(">f8"), v),
    ]:
        assert ramone.impacts(own, other, friction=0.5, place="lowest").impulse.tobytes() == expected.impulse.tobytes()
    converted = ramone.impacts(q.astype(np.float32), v, friction=0.5, place="lowest")
    assert converted.impulse.tobytes() == single.impulse.tobytes()


@pytest.mark.parametrize(
    ("q", "v", "message"),
    [
        (np.zeros(7), np.zeros(7), r"q has the shape \[7\], not \(n, 7\).*q\[None, :\]"),
        (np.zeros((3, 6)), np.zeros((3, 6)), r"q has the shape \[3, 6\], not \(n, 7\).*robot.coordinates"),
        (np.zeros((3, 7)), np.zeros((2, 7)), "q has 3 rows and v 2"),
        (np.zeros((3, 7), complex), np.zeros((3, 7)), "numpy.ascontiguousarray"),
        (np.zeros((3, 7), object), np.zeros((3, 7)), "numpy.ascontiguousarray"),
        (np.full((3, 7), "0"), np.zeros((3, 7)), "numpy.ascontiguousarray"),
    ],
)
def test_wrong_array_is_refused_with_a_remedy(ramone, q, v, message):
    with pytest.raises((TypeError, ValueError), match=message):
        ramone.impacts(q, v, friction=0.5)


def test_contacts_and_scene_are_those_of_a_state(ramone, walk):
    q, v = walk(5)
    contacts = [{"link": "left_foot"}, {"link": "torso", "offset": [0, 0, 0.1]}]
    scene = {"contacts": contacts, "friction": {"left_foot": 0.2, "torso": "infinite"}, "ground": {"slope": 0.1}}
    answers = ramone.impacts(q, v, **scene)
    for at, row in enumerate(zip(q, v)):
        one = ramone.impact(state(ramone, *row, **scene))
        places = [answers.contacts.index(contact["name"]) for contact in one["contacts"]]
        own = slice(*answers.offsets[at : at + 2])
        assert answers.impulse[own][:, places].tolist() == [outcome["impulse"] for outcome in one["outcomes"]]
    with pytest.raises(TypeError, match="position"):
        ramone.impacts(q, v, friction=0.5, position={})


def test_any_number_of_threads_and_rows_gives_the_same(ramone, walk):
    q, v = walk(1000)
    one = ramone.impacts(q, v, friction=0.3, place="lowest", threads=1)
    for threads in (2, 5, 0, None, 10**9):
        other = ramone.impacts(q, v, friction=0.3, place="lowest", threads=threads)
        for name in ("verdict", "offsets", "modes", "impulse", "velocity_after", "margin", "index", "proven"):
            assert getattr(one, name).tobytes() == getattr(other, name).tobytes()
        assert one.error == other.error and one.notes == other.notes
    none = ramone.impacts(q[:0], v[:0], friction=0.3)
    assert len(none) == 0 and none.offsets.tolist() == [0] and none.impulse.shape == (0, 2, 2)
    assert none.to_arrow().num_rows == 0


def test_lists_and_unaligned_arrays_are_converted(ramone, walk):
    q, v = walk(5)
    mu, e = np.linspace(0.1, 0.9, 5), np.full(5, 0.5)
    expected = ramone.impacts(q, v, friction=mu, restitution=e, place="lowest")
    packed = np.zeros(5, dtype=[("byte", "u1"), ("q", "f8", (7,))])
    packed["q"] = q
    for own_q, own_mu, own_e in [(q, mu.tolist(), tuple(e)), (packed["q"], mu, e)]:
        found = ramone.impacts(own_q, v, friction=own_mu, restitution=own_e, place="lowest")
        assert found.velocity_after.tobytes() == expected.velocity_after.tobytes()
    unaligned = np.frombuffer(b"0" + q.tobytes(), dtype="u1")[1:].view("f8").reshape(q.shape)
    found = ramone.impacts(unaligned, v, friction=mu, restitution=e, place="lowest")
    assert not unaligned.flags.aligned and found.velocity_after.tobytes() == expected.velocity_after.tobytes()
    rough = [ramone.impacts(q, v, friction=mu, place="lowest").impulse.tobytes() for mu in ("inf", "infinite", np.inf)]
    assert len(set(rough)) == 1


@pytest.mark.parametrize("aspect", ["impacts", "forces"])
def test_answers_go_to_other_processes(ramone, walk, aspect):
    q, v = walk(50)
    q[3, 1] = np.nan
    answers = getattr(ramone, aspect)(q, v, friction=0.4, place="lowest", contacts=[{"link": "torso"}])
    fresh = pickle.loads(pickle.dumps(answers))
    names = [name for name in dir(answers) if not name.startswith(("_", "to_")) and hasattr(answers, name)]
    assert {"verdict", "offsets", "modes", "error"} < set(names)
    for again in (fresh, pickle.loads(pickle.dumps(answers))):
        assert repr(again) == repr(answers) and again.to_arrow().equals(answers.to_arrow())
        for name in names:
            np.testing.assert_array_equal(getattr(again, name), getattr(answers, name))


def test_damaged_pickles_are_refused(ramone, walk):
    q, v = walk(4)
    q[1, 1] = np.nan
    restore, (data,) = ramone.impacts(q, v, friction=0.4, place="lowest").__reduce__()
    refused = 0
    for at in range(len(data)):
        try:
            answers = restore(data[:at] + bytes([data[at] ^ 0xFF]) + data[at + 1 :])
            for name in dir(answers):
                getattr(answers, name, None)
            repr(answers)
            answers.to_arrow()
        except ValueError:
            refused += 1
        with pytest.raises(ValueError):
            restore(data[:at])
    assert refused > len(data) // 10


def test_fields_of_a_state_are_read_again_if_they_change(ramone, walk):
    q, v = walk(3)
    ground, answers = {"slope": 0.1}, {}
    for slope in (0.1, 0.2, True):
        ground["slope"] = slope
        if slope is True:
            with pytest.raises(heelstrike.Refused, match="slope"):
                ramone.impacts(q, v, friction=0.5, place="lowest", ground=ground)
        else:
            for _ in range(2):
                answers[slope] = ramone.impacts(q, v, friction=0.5, place="lowest", ground=ground).impulse.tobytes()
    assert answers[0.1] != answers[0.2]
    other = heelstrike.Robot(ROOT / "urdf/ramone.urdf").impacts(q, v, friction=0.5, place="lowest", ground={"slope": 0.2})
    assert other.impulse.tobytes() == answers[0.2]


def test_answers_do_not_depend_on_earlier_ones(ramone, walk):
    q, v = walk(5)
    scene = {"friction": 0.5, "place": "lowest"}
    fresh = heelstrike.Robot(ROOT / "urdf/ramone.urdf").impacts(q, v, **scene)
    for rows in (5, 2, 5):
        earlier = ramone.impacts(q[:rows], v[:rows], **scene)
        assert earlier.offsets[0] == 0 and len(earlier.offsets) == rows + 1
        assert len(earlier.modes) == len(earlier.impulse) == len(earlier.margin) == earlier.offsets[-1]
        del earlier
        assert ramone.impacts(q, v, **scene).to_arrow().equals(fresh.to_arrow())


def test_texts_are_made_once(ramone, walk):
    answers = ramone.impacts(*walk(5), friction=0.5)
    for name in ("error", "notes", "border", "families"):
        assert getattr(answers, name) is getattr(answers, name)
    with pytest.raises(ValueError, match="id has 3 entries for 5 states"):
        answers.to_arrow([1, 2, 3])
