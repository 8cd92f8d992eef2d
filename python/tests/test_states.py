"""Single states, sweeps, touchdowns, problems and pictures: what the command writes, as dictionaries."""

import json
import math
import subprocess

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
    with pytest.raises(heelstrike.Refused):
        heelstrike.Robot.from_string("<robot/>")
    with pytest.raises(FileNotFoundError):
        heelstrike.Robot("no.urdf")
    with pytest.raises(TypeError, match="plan"):
        heelstrike.Robot(URDF, plan="xz")
    with pytest.raises(ValueError, match="plane is one of xz, yz, xy"):
        heelstrike.Robot(URDF, plane="zx")


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


def test_touchdowns_are_those_of_the_command(ramone):
    pandas = pytest.importorskip("pandas")
    table = ROOT / "examples/gait/ramone_walk.csv"
    lines = command("batch", URDF, table, "--touchdowns", "--friction", 0.8, "--quiet")
    found = ramone.touchdowns(table, friction=0.8)
    assert found and found == [json.loads(line) for line in lines.splitlines()]
    frame = pandas.read_csv(table)
    assert ramone.touchdowns(frame, friction=0.8) == found
    assert ramone.touchdowns({name: frame[name].to_numpy() for name in frame}, friction=0.8) == found
    with pytest.raises(heelstrike.Refused, match="time"):
        ramone.touchdowns({"q_left_hip": [0.0], "v_left_hip": [0.0]}, friction=0.8)


def test_problem_is_that_of_the_command():
    matrix, velocity = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([[0.5, -1.0]])
    text = json.dumps({"delassus": matrix.tolist(), "velocity_before": velocity.tolist(), "friction": 0.5})
    expected = command("solve", "-", "--format", "json", input=text)
    assert heelstrike.solve(matrix, velocity, 0.5) == expected
    assert heelstrike.solve(matrix, velocity.ravel(), [0.5], 0.0) == expected
    assert heelstrike.solve(matrix, velocity, math.inf)["verdict"] == "unique"
    with pytest.raises(heelstrike.Refused, match="friction"):
        heelstrike.solve(matrix, velocity, -1.0)


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
    with pytest.raises(TypeError, match="has no picture"):
        heelstrike.plot({})
