"""The package in a process: the command, Ctrl-C, threads, a light import, typed stubs."""

import signal
import subprocess
import sys
import threading
import time

import pytest
from conftest import COMMAND, ROOT

import heelstrike

SLOW = """
import heelstrike, numpy, signal, sys, time
urdf = {urdf!r}
robot = heelstrike.Robot(urdf)
q, v = numpy.random.default_rng(7).uniform(-1, 1, (2, 2_000_000, 7))

def slow(rows, threads):
    contacts = [dict(link="torso", offset=[0.1 * at, 0, -0.3 - 1e-9 * at * at]) for at in range(6)]
    unlimited = heelstrike.Robot(urdf, budget=None)
    unlimited.impacts(0 * q[:rows], 0 * v[:rows] + [0, -1, 0.3, 0, 0, 0, 0], friction=0.8, threads=threads,
        contacts=contacts)

def handler(*_):
    try:
        robot.impacts(q[:5], v[:5], friction=0.5, threads=1)
    except KeyboardInterrupt:
        pass

print("ready", flush=True)
try:
    {call}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""

CALLS = {
    "rows": 'robot.impacts(q, v, friction=0.5, place="lowest", threads=1)',
    "threads": 'robot.impacts(q, v, friction=0.5, place="lowest", threads=2)',
    "slow rows": "slow(600, 2)",
    "few slow rows": "slow(250, 1)",
    "a handler that calls": "signal.signal(signal.SIGALRM, handler), signal.setitimer(0, 0.1, 0.1), slow(3000, 1)",
    "sweep": """robot.sweep({"parameters": {"a": {"from": -1, "to": 1, "steps": 1000000}}, "state": {
        "position": {"joints": {"left_hip": "a"}}, "velocity": {"base": {"z": -1}}, "friction": 0.5, "place": "lowest"}},
        budget=None)""",
    "touchdowns": f"""heelstrike.Robot({str(ROOT / "tests/data/robots/h1/h1.urdf")!r}).touchdowns(dict(
        time=numpy.arange(2e5) / 100, q_base_z=1 + numpy.sin(numpy.arange(2e5) / 5) / 10),
        velocity="central", friction=1)""",
}


@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_ends_a_long_call(name):
    script = SLOW.format(urdf=str(ROOT / "urdf/ramone.urdf"), call=CALLS[name])
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.5)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    start = time.monotonic()
    out, _ = process.communicate(timeout=30)
    assert out == "interrupted\n" and process.returncode == 0
    assert time.monotonic() - start < 5


def test_calls_of_two_threads_run_at_once(ramone, walk):
    q, v = walk(60_000)
    done, answered = threading.Event(), 0

    def work():
        ramone.impacts(q, v, friction=0.5, place="lowest", threads=1)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        ramone.impacts(q[:100], v[:100], friction=0.5, place="lowest", threads=1)
        answered += 1
    thread.join()
    assert answered > 20


def test_command_is_the_tool():
    def run(*arguments):
        return subprocess.run([*COMMAND, *arguments], capture_output=True, text=True, cwd=ROOT)

    assert run("--version").stdout.startswith(f"heelstrike {heelstrike.__version__}")
    assert run("impact", "urdf/ramone.urdf", "examples/ramone.json").returncode == 0
    refused = run("impact", "urdf/ramone.urdf", "no.json")
    assert (refused.returncode, refused.stdout) == (1, "") and "no.json" in refused.stderr
    assert run("impact").returncode == 2
    installed = subprocess.run(
        f"'{sys.executable[: sys.executable.rindex('/')]}/heelstrike' inspect urdf/ramone.urdf --format json | head -c 10",
        shell=True, capture_output=True, text=True, cwd=ROOT,
    )
    assert (installed.stdout, installed.stderr) == ('{"name":"r', "")


def test_package_lists_what_it_has():
    assert {"from_pinocchio", "from_mujoco", "from_drake", "Layout"} <= set(dir(heelstrike))


def test_command_and_import_take_no_numpy():
    script = "import sys, heelstrike._command; assert not {'numpy', 'pandas', 'pyarrow'} & set(sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_stubs_are_those_of_the_package():
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "heelstrike"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    files = ["-p", "heelstrike"]
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", *files], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
