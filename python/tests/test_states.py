"""Single states, sweeps, touchdowns, problems and pictures: what the command writes, as dictionaries."""

import json
import math
import pickle
import subprocess
import warnings

import numpy as np
import pytest
from conftest import COMMAND, ROOT

import heelstrike


def command(*arguments, input=None):
    done = subprocess.run([*COMMAND, *map(str, arguments)], input=input, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout) if "--format" in arguments else done.stdout


URDF, STATE = ROOT / "urdf/ramone.urdf", ROOT / "examples/ramone.json"


def test_result_is_that_of_the_command(ramone):
    one = ramone.impact(json.loads(STATE.read_text()), explain=True, matrices=True)
    assert one == command("impact", URDF, STATE, "--format", "json", "--explain", "--matrices")
    assert ramone.impact(STATE) == ramone.impact(STATE.read_text())
    standing = ROOT / "examples/ramone_stands.json"
    assert ramone.forces(standing) == command("forces", URDF, standing, "--format", "json")
    assert ramone.inspect() == command("inspect", URDF, "--format", "json")
    assert ramone.impact(STATE, next=True)["outcomes"][0]["next"]["verdict"]


def test_numpy_numbers_are_numbers(ramone):
    state = {"position": {"base": {"pitch": np.float64(0.25)}}, "stance": "left_foot", "friction": np.float64(0.5)}
    assert ramone.impact(state) == ramone.impact(json.loads(json.dumps(state)))
    assert ramone.impact({"stance": "left_foot"}, friction=math.inf) == ramone.impact(
        {"stance": "left_foot", "friction": "infinite"}
    )


def test_refusal_names_place_and_remedy(ramone):
    with pytest.raises(heelstrike.Refused, match="left_hipp.*did you mean left_hip") as error:
        ramone.impact({"position": {"joints": {"left_hipp": 0.1}}, "friction": 1})
    assert error.value.place.startswith("position.joints") and error.value.hint == "did you mean left_hip?"
    assert str(error.value).startswith("position.joints")
    with pytest.raises(heelstrike.Refused):
        heelstrike.Robot.from_string("<robot/>")
    with pytest.raises(FileNotFoundError):
        heelstrike.Robot("no.urdf")
    with pytest.raises(TypeError, match="plan"):
        heelstrike.Robot(URDF, plan="xz")
    with pytest.raises(TypeError, match="package_path: a list of folders is expected"):
        heelstrike.Robot(URDF, package_path=".")
    with pytest.raises(heelstrike.Refused, match="did you mean link") as error:
        heelstrike.Robot(URDF, feet=[{"lnk": "torso"}])
    assert str(error.value).startswith("feet[0].lnk: unknown field")
    with pytest.raises(TypeError, match="by link it is a dictionary, which rows take"):
        ramone.impact(STATE, friction={"default": 0.8})
    for option in ("hold", "plane", "contact_tolerance"):
        with pytest.raises(TypeError, match=f"^{option}: "):
            heelstrike.Robot(URDF, **{option: {"left_knee": "x"}})
    with pytest.raises(ValueError, match="plane is one of auto, xz, yz, xy, zy, zx, yx, not"):
        heelstrike.Robot(URDF, plane="zz")


@pytest.mark.parametrize("option", ["resting_speed", "axis_tolerance", "contact_tolerance", "budget"])
@pytest.mark.parametrize("value", [-1.0, math.nan, math.inf])
def test_options_are_checked_as_those_of_the_command(option, value):
    with pytest.raises(ValueError, match=f"{option}: expected a number .*from 0 on"):
        heelstrike.Robot(URDF, **{option: value})
    flag = f"--{option.replace('_', '-')}={value}"
    refused = subprocess.run([*COMMAND, "impact", URDF, STATE, flag], capture_output=True, text=True)
    assert refused.returncode == 2 and "from 0 on" in refused.stderr


def test_budget_of_a_sweep_is_checked(ramone):
    with pytest.raises(ValueError, match="budget: expected a number of seconds from 0 on"):
        ramone.sweep({}, budget=-1)
    assert heelstrike.Robot(URDF, budget=None) and heelstrike.Robot(URDF, budget="infinite")


def test_one_state_of_forces_takes_no_other_arguments(ramone):
    standing = ROOT / "examples/ramone_stands.json"
    for other in ({"contacts": []}, {"restitution": 0.5}, {"threads": 1}, {"place": "lowest"}):
        with pytest.raises(TypeError, match="one state takes friction, explain and matrices"):
            ramone.forces(standing, **other)
    explained = ramone.forces(standing, explain=True, matrices=True)
    assert explained["mass_matrix"] and explained["rejected"]
    with pytest.raises(TypeError, match="of one state, not of rows"):
        ramone.forces(np.zeros((1, 7)), np.zeros((1, 7)), explain=True)


def test_file_that_is_not_utf_8_is_refused_with_a_remedy(tmp_path):
    file = tmp_path / "latin.urdf"
    file.write_bytes('<robot name="h\xfcpfer"/>'.encode("latin-1"))
    with pytest.raises(heelstrike.Refused, match="not UTF-8.*iconv") as error:
        heelstrike.Robot(file)
    assert error.value.file == file
    file.write_bytes('{"id": "h\xfcpfer"}'.encode("latin-1"))
    for answer in (heelstrike.Robot(URDF).impact, heelstrike.Robot(URDF).sweep):
        with pytest.raises(heelstrike.Refused, match="latin.urdf.*not UTF-8.*iconv"):
            answer(file)


def test_robots_and_results_go_into_other_processes(ramone):
    robot = heelstrike.Robot(URDF, hold={"left_knee": -0.5}, contact_tolerance=1e-3)
    again = pickle.loads(pickle.dumps(robot))
    assert (again.coordinates, again.held) == (robot.coordinates, robot.held)
    state = {"place": "lowest", "friction": 1}
    assert again.impact(state) == robot.impact(state)
    result = ramone.impact(STATE)
    other = pickle.loads(pickle.dumps(result))
    assert type(other) is heelstrike.Result and other == result
    with pytest.raises(ValueError, match="ask its robot again"):
        heelstrike.plot(other)


def test_pickled_robot_is_the_same_whatever_happens_around_it(tmp_path, monkeypatch):
    text = URDF.read_text()
    for name in ("package://ramone/foot.obj", "foot.obj"):
        text = text.replace('<sphere radius="0.02815"/>', f'<mesh filename="{name}"/>', 1)
    (tmp_path / "meshes/ramone").mkdir(parents=True)
    (tmp_path / "meshes/ramone/foot.obj").write_text("v 0 0 0\nv 0.1 0.1 0\nv 0 0.1 0.1\nf 1 2 3\n")
    (tmp_path / "foot.obj").write_text("v 0 0 0\nv 0.2 0.1 0\nv 0 0.1 0.1\nf 1 2 3\n")
    monkeypatch.chdir(tmp_path)
    hold, feet = {"left_knee": -0.5}, [{"link": "torso"}]
    robot = heelstrike.Robot.from_string(text, hold=hold, feet=feet, package_path=["meshes"])
    data, inspected = pickle.dumps(robot), robot.inspect()
    hold["left_knee"] = 0.1
    feet.clear()
    monkeypatch.chdir("/")
    again = pickle.loads(data)
    assert (again.held, again.inspect()) == ({"left_knee": -0.5}, inspected)


def test_cautions_and_unused_friction_are_warnings(ramone):
    text = URDF.read_text().replace('<sphere radius="0.02815"/>', '<mesh filename="package://ramone/foot.obj"/>', 1)
    with pytest.warns(UserWarning, match="1 collision mesh is left out"):
        heelstrike.Robot.from_string(text)
    with pytest.warns(UserWarning, match="`friction` is not used where a state has its own"):
        ramone.impact(STATE, friction=0.1)


def test_notes_of_the_command_are_warnings(ramone, tmp_path):
    rows = (ROOT / "examples/gait/ramone_walk.csv").read_text().splitlines()
    own = [f"{row},{'friction' if at == 0 else 0.5}" for at, row in enumerate(rows)]
    own[0] = own[0].replace("v_right_knee", "remark")
    table = tmp_path / "walk.csv"
    table.write_text("\n".join(own))
    arguments = ["batch", URDF, table, "--touchdowns", "--friction", "0.8"]
    said = " ".join(subprocess.run([*COMMAND, *arguments], capture_output=True, text=True).stderr.split())
    with pytest.warns(UserWarning) as warned:
        ramone.touchdowns(table, friction=0.8)
    notes = [str(warning.message).replace("`friction`", "--friction") for warning in warned]
    assert any("taken as 0: v_right_knee" in note for note in notes) and any("has its own" in note for note in notes)
    assert all(note in said for note in notes), said
    study = {"parameters": {"a": {"from": -1, "to": 1, "steps": 3}}, "state": {"friction": 1, "place": "lowest"}}
    with pytest.warns(UserWarning, match="depends on a"):
        ramone.sweep(study)


def test_robot_is_read_as_asked():
    text = URDF.read_text()
    held = heelstrike.Robot.from_string(text, hold={"left_knee": -0.5}, base="floating", feet=[{"link": "torso"}])
    assert held.coordinates == ["x", "z", "pitch", "left_hip", "right_hip", "right_knee"]
    assert held.held == {"left_knee": -0.5}
    assert "torso" in [foot["link"] for foot in held.inspect()["feet"]]
    assert repr(held).startswith('Robot("ramone", coordinates=')


def test_sweep_is_that_of_the_command(tmp_path):
    urdf, study = ROOT / "urdf/minimalistic.urdf", ROOT / "examples/paper/figure_7.json"
    sweep = heelstrike.Robot(urdf).sweep(study)
    assert sweep == command("sweep", urdf, study, "--format", "json")
    assert heelstrike.Robot(urdf).sweep(json.loads(study.read_text()), threads=1) == sweep


def test_touchdowns_are_those_of_the_command(ramone, tmp_path):
    pandas = pytest.importorskip("pandas")
    table = ROOT / "examples/gait/ramone_walk.csv"
    lines = command("batch", URDF, table, "--touchdowns", "--friction", 0.8, "--quiet")
    found = ramone.touchdowns(table, friction=0.8)
    assert found and found == [json.loads(line) for line in lines.splitlines()]
    frame = pandas.read_csv(table)
    assert ramone.touchdowns(frame, friction=0.8) == found
    assert ramone.touchdowns({name: frame[name].to_numpy() for name in frame}, friction=0.8) == found
    frame.to_csv(tmp_path / "walk.tsv", sep="\t", index=False)
    assert ramone.touchdowns(tmp_path / "walk.tsv", friction=0.8) == found
    for ending in ("parquet", "feather"):
        file = tmp_path / f"walk.{ending}"
        getattr(frame, f"to_{ending}")(file, compression="lz4")
        lines = command("batch", URDF, file, "--touchdowns", "--friction", 0.8, "--quiet")
        assert ramone.touchdowns(str(file), friction=0.8) == [json.loads(line) for line in lines.splitlines()]
    raised = tmp_path / "raised.csv"
    frame.assign(q_base_z=frame["q_base_z"] + 0.05).to_csv(raised, index=False)
    for source, field, flag, value, any_found in [
        (table, "drop", "--drop", 0.2, False),
        (raised, "ground_height", "--ground-height", 0.02, False),
        (raised, "ground_height", "--ground-height", 0.1, True),
    ]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            own = ramone.touchdowns(source, friction=0.8, **{field: value})
        lines = command("batch", URDF, source, "--touchdowns", "--friction", 0.8, flag, value).splitlines()
        assert bool(own) == any_found and own == [json.loads(line) for line in lines], (field, value)
    with pytest.warns(UserWarning, match="no touchdown found: the lowest foot comes to z = 0 m; a foot must descend"):
        assert ramone.touchdowns(frame[:3], friction=0.8) == []
    narrow = {name: frame[name].to_numpy("float32") for name in frame.select_dtypes("number")}
    assert ramone.touchdowns(pandas.DataFrame(narrow), friction=0.8) == ramone.touchdowns(narrow, friction=0.8)
    with pytest.raises(ValueError, match="the columns have different lengths: {'time': 1, 'q_left_hip': 2}"):
        ramone.touchdowns({"time": [0.0], "q_left_hip": [0.0, 1.0]}, friction=0.8)
    with pytest.raises(TypeError, match="column time is a float, not a list"):
        ramone.touchdowns({"time": 0.0}, friction=0.8)
    with pytest.raises(TypeError, match="drop: must be real number, not str"):
        ramone.touchdowns(frame, friction=0.8, drop="1")
    with pytest.raises(TypeError, match="a table is a path.*not a list"):
        ramone.touchdowns([[0.0]])
    lines = frame.assign(remark=1.0)
    lines.to_json(tmp_path / "walk.ndjson", orient="records", lines=True, double_precision=15)
    with pytest.raises(heelstrike.Refused, match='give `foreign="restituion"`'):
        ramone.touchdowns(frame.assign(restituion=1.0), friction=0.8)
    for foreign in ("restituion", ["restituion"]):
        assert len(ramone.touchdowns(frame.assign(restituion=1.0), friction=0.8, foreign=foreign)) == len(found)
    assert len(ramone.touchdowns(tmp_path / "walk.ndjson", friction=0.8)) == len(found)
    # The format of a file follows from its name.
    for name, remedy in {"walk.tsv": "if these are commas, end the file's name in `.csv`$",
                         "walk.parquet": "or give the command `--input-format csv`$"}.items():
        (tmp_path / name).write_text((ROOT / "examples/gait/ramone_walk.csv").read_text())
        with pytest.raises(heelstrike.Refused, match=remedy):
            ramone.touchdowns(tmp_path / name, friction=0.8)
    broken = frame.assign(friction=0.8)
    broken.loc[broken.index[1:], "friction"] = -1
    with pytest.warns(UserWarning, match="touchdowns are refused: see `error`"):
        assert all("error" in touchdown for touchdown in ramone.touchdowns(broken))
    with pytest.raises(heelstrike.Refused, match="time"):
        ramone.touchdowns({"q_left_hip": [0.0], "v_left_hip": [0.0]}, friction=0.8)


def test_problem_is_that_of_the_command():
    matrix, velocity = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([[0.5, -1.0]])
    text = json.dumps({"delassus": matrix.tolist(), "velocity_before": velocity.tolist(), "friction": 0.5})
    expected = command("solve", "-", "--format", "json", input=text)
    assert heelstrike.solve(matrix, velocity, 0.5) == expected
    assert heelstrike.solve(matrix, velocity.ravel(), [0.5], 0.0) == expected
    for same in (list(velocity), list(velocity.ravel()), tuple(velocity.ravel())):
        assert heelstrike.solve(matrix, same, 0.5) == expected
    for infinite in (math.inf, "inf", np.array([math.inf])):
        assert heelstrike.solve(matrix, velocity, infinite)["verdict"] == "unique"
    with pytest.raises(TypeError, match="c is an array or a list, not a float"):
        heelstrike.solve(matrix, 0.5, 0.5)
    with pytest.raises(heelstrike.Refused, match="friction"):
        heelstrike.solve(matrix, velocity, -1.0)


def test_budget_of_a_problem_leaves_it_undecided():
    # Four contacts of a body in a row, each with small motions of its own.
    own = 1e-8 * np.random.default_rng(1).uniform(-1, 1, (8, 8))
    jacobian = np.hstack([np.array([row for x in range(4) for row in ([1, 0, 1], [0, 1, x])]), own])
    problem = (jacobian @ jacobian.T, jacobian[:, :3] @ [0.3, -1, 0.2], 0.5)
    assert heelstrike.solve(*problem)["verdict"] == "unique"
    beyond = heelstrike.solve(*problem, budget=0)
    assert beyond["verdict"] == "undecided" and beyond["open"]["beyond_budget"]


def test_picture_of_a_sweep_has_its_budget_and_threads():
    walker = heelstrike.Robot(ROOT / "urdf/minimalistic.urdf")
    sweep = walker.sweep(ROOT / "examples/paper/figure_7.json", threads=2, budget=30)
    assert sweep._drawn[-2:] == (2, 30.0)
    sweep._drawn = (*sweep._drawn[:-1], 0.0)
    with pytest.raises(heelstrike.Refused, match="0 s of processor time were not enough"):
        heelstrike.plot(sweep)


def test_pictures_are_those_of_the_command(ramone, tmp_path):
    for own, arguments in [
        (ramone.impact(STATE), ("impact", URDF, STATE)),
        (ramone, ("inspect", URDF)),
        (
            heelstrike.Robot(ROOT / "urdf/minimalistic.urdf").sweep(ROOT / "examples/paper/figure_7.json"),
            ("sweep", ROOT / "urdf/minimalistic.urdf", ROOT / "examples/paper/figure_7.json"),
        ),
    ]:
        file, plot = tmp_path / "drawn.svg", heelstrike.plot(own)
        text = command(*arguments, "--plot", file)
        assert plot._repr_svg_() == file.read_text()
        assert repr(plot).splitlines()[0] == text.splitlines()[0]
        plot.save(tmp_path / "own.svg")
        assert (tmp_path / "own.svg").read_text() == file.read_text()
    with pytest.raises(ValueError, match="ends with .svg"):
        plot.save(tmp_path / "own.png")
    with pytest.raises(TypeError, match="has no picture"):
        heelstrike.plot({})
    with pytest.raises(TypeError, match="Answers have no picture"):
        heelstrike.plot(ramone.impacts(np.zeros((1, 7)), np.zeros((1, 7))))
