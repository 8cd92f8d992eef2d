"""The cost of a row on a local Spark against a plain loop over the same file, from Parquet to Parquet.

    python python/bench/spark.py

Both alternate in pairs, after the session has started and done the work once. Shown are wall-clock time, which is
meaningful only on an idle machine, and processor time; Spark's is that of Java and of its workers. Needs Linux.
"""

import functools
import os
import pathlib
import shutil
import statistics
import sys
import tempfile
import time

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from pyspark.sql import SparkSession

ROOT = pathlib.Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "examples/spark"))
import map_in_arrow  # noqa: E402

URDF = str(ROOT / "urdf/ramone.urdf")
STATES = int(os.environ.get("STATES", 1_000_000))
PAIRS = int(os.environ.get("PAIRS", 7))


def states():
    q, v = np.random.default_rng(7).uniform(-1.2, 1.2, (2, STATES, 7))
    q[::50, 4] = np.nan
    names = ["base_x", "base_z", "base_pitch", *map_in_arrow.robot(URDF).coordinates[3:]]
    columns = {f"{part}_{name}": rows[:, at] for part, rows in zip("qv", (q, v)) for at, name in enumerate(names)}
    return pa.table({"id": np.arange(STATES), **columns, "friction": np.full(STATES, 0.5)})


def spent_by(root):
    """Seconds of processor time of a process and of all processes that it started."""
    parents, spent = {}, {}
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        own = int(path.parent.name)
        parents[own] = int(fields[1])
        # The process's own time and that of its ended children.
        spent[own] = sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")

    def is_of_root(own):
        return own == root or own in parents and is_of_root(parents[own])

    return sum(time for own, time in spent.items() if is_of_root(own))


def loop(source, target):
    writer = None
    for batch in pq.ParquetFile(source).iter_batches(10_000):
        answers = map_in_arrow.table(URDF, pa.Table.from_batches([batch]))
        writer = writer or pq.ParquetWriter(target, answers.schema)
        writer.write_table(answers)
    writer.close()


def main():
    os.environ["PYSPARK_PYTHON"] = sys.executable
    session = SparkSession.builder.master("local[1]").config("spark.ui.enabled", False).getOrCreate()
    session.sparkContext.setLogLevel("ERROR")
    session.sparkContext.addPyFile(str(ROOT / "examples/spark/map_in_arrow.py"))
    with tempfile.TemporaryDirectory() as folder:
        source, target = os.path.join(folder, "states.parquet"), os.path.join(folder, "results")
        pq.write_table(states(), source)

        def spark():
            shutil.rmtree(target, ignore_errors=True)
            map_in_arrow.answer(session, URDF, session.read.parquet(source)).write.parquet(target)

        def seconds(work, spent):
            start = np.array([time.perf_counter(), spent()])
            work()
            return [time.perf_counter(), spent()] - start

        def of_spark():
            return spent_by(session.sparkContext._gateway.proc.pid)

        plain = functools.partial(loop, source, target + ".parquet")
        spark()
        pairs = [(seconds(spark, of_spark), seconds(plain, time.process_time)) for _ in range(PAIRS)]
    for at, name in enumerate(["clock", "processor"]):
        own, other = (1e6 / STATES * statistics.median(times[at] for times in side) for side in zip(*pairs))
        beyond = 1e6 / STATES * statistics.median(a[at] - b[at] for a, b in pairs)
        print(f"{name}: Spark {own:.2f} us a row, plain loop {other:.2f}, beyond {beyond:.2f} (at most 1 by the clock)")


if __name__ == "__main__":
    main()
