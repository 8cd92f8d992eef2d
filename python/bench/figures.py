"""The cost of Python and of tables relative to the Rust library, as ratios of processor time.

    cargo build --release -p heelstrike-python --example library
    python python/bench/figures.py target/release/examples/library

Each measurement alternates with one of the library, so that a busy machine slows both. Medians are shown, also of the
ratios. The states are random poses of RAMone, the lowest foot on the ground, on one thread. Needs Linux and pyarrow.
"""

import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

import heelstrike

URDF = pathlib.Path(__file__).parents[2] / "urdf/ramone.urdf"
FRICTION = 0.5
STATES = int(os.environ.get("STATES", 1_000_000))
PAIRS = int(os.environ.get("PAIRS", 11))
TOOL = [sys.executable, "-c", "import sys; from heelstrike._command import main; sys.exit(main())"]


def states(count):
    q, v = np.random.default_rng(7).uniform(-1.2, 1.2, (2, count, 7))
    v[:, 1] -= 1.5
    return q, v


def impacts(robot, q, v, **fields):
    return robot.impacts(q, v, friction=FRICTION, place="lowest", threads=1, **fields)


def measured(work):
    """Seconds of processor time of this thread; the result is freed outside of them."""
    start = time.thread_time()
    made = work()
    end = time.thread_time()
    del made
    return end - start


def of_command(arguments):
    """Seconds of processor time of a run of the command."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([*TOOL, *arguments], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def paired(name, work, other, limit):
    pairs = [(work(), other()) for _ in range(PAIRS)]
    own, library = (statistics.median(times) for times in zip(*pairs))
    ratio = statistics.median(a / b for a, b in pairs)
    print(f"{name}: {own:.2f} s, library {library:.2f} s, ratio {ratio:.3f} (at most {limit})", flush=True)


def one_row(robot):
    """Print what a call with one row costs beyond the row's share of a call with many equal rows."""
    count = 20_000
    lowest = {"place": "lowest"}
    for name, fields in [("plain", {}), ("place", lowest), ("ground", {**lowest, "ground": {"slope": 0.1}})]:
        q, v = states(1)
        many = [np.repeat(rows, count, axis=0) for rows in (q, v)]

        def calls():
            for _ in range(count):
                robot.impacts(q, v, friction=FRICTION, threads=1, **fields)

        def rows():
            robot.impacts(*many, friction=FRICTION, threads=1, **fields)

        pairs = [(measured(calls), measured(rows)) for _ in range(PAIRS)]
        calls_us, rows_us = (1e6 * statistics.median(times) / count for times in zip(*pairs))
        beyond = 1e6 * statistics.median(a - b for a, b in pairs) / count
        print(f"one row, {name}: {calls_us:.2f} us, of many {rows_us:.2f}, beyond {beyond:.2f} (at most 2)", flush=True)


MEMORY = '''
import sys
sys.path.insert(0, {folder!r})
import figures, heelstrike
def peak():
    """The most memory so far, in bytes."""
    line = next(line for line in open("/proc/self/status") if line.startswith("VmHWM"))
    return 1024 * int(line.split()[1])
robot = heelstrike.Robot(figures.URDF)
figures.impacts(robot, *figures.states(1000))
before = peak()
q, v = figures.states({count})
answers = figures.impacts(robot, q, v)
names = "verdict all_proven offsets modes impulse velocity_after margin index proven family".split()
arrays = q.nbytes + v.nbytes + sum(getattr(answers, name).nbytes for name in names)
print(f"memory: {{(peak() - before) / arrays:.3f}} of the arrays of {{arrays / 1e6:.0f}} MB (at most 1.2)")
'''


def table(path, q, v, robot):
    import pyarrow as pa
    import pyarrow.parquet

    names = ["base_x", "base_z", "base_pitch", *robot.coordinates[3:]]
    columns = {f"{part}_{name}": rows[:, at] for part, rows in zip("qv", (q, v)) for at, name in enumerate(names)}
    pa.parquet.write_table(pa.table(columns), path)


def main(library):
    robot = heelstrike.Robot(URDF)
    q, v = states(STATES)
    with tempfile.TemporaryDirectory() as folder:
        rows, source, target = (os.path.join(folder, name) for name in ("rows", "in.parquet", "out.parquet"))
        np.hstack([q, v]).tofile(rows)
        table(source, q, v, robot)
        peer = subprocess.Popen(
            [library, URDF, rows, str(FRICTION)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

        def of_library(what):
            def spent():
                return int(pathlib.Path(f"/proc/{peer.pid}/schedstat").read_text().split()[0]) / 1e9

            before = spent()
            peer.stdin.write(what + "\n")
            peer.stdin.flush()
            peer.stdout.readline()
            return spent() - before

        paired("impacts", lambda: measured(lambda: impacts(robot, q, v)), lambda: of_library("arrays"), 1.1)
        scene = ["--place", "lowest", "--friction", str(FRICTION), "--threads", "1"]
        batch = ["batch", str(URDF), source, "-o", target, "--brief", "--quiet", *scene]
        paired("Parquet to Parquet --brief", lambda: of_command(batch), lambda: of_library("brief"), 1.2)
        peer.stdin.close()
        peer.wait()
    one_row(robot)
    memory = MEMORY.format(folder=os.path.dirname(os.path.abspath(__file__)), count=STATES)
    subprocess.run([sys.executable, "-c", memory], check=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
