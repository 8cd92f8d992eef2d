"""The examples for Spark, if it is installed: joined results equal those of one process, broken rows included."""

import importlib
import json
import os
import shutil
import sys

import numpy as np
import pytest
from conftest import ROOT
from test_rows import command, state

pytest.importorskip("pyspark")
pa = pytest.importorskip("pyarrow")
STATES = 100_000


def example(spark, name):
    path = ROOT / f"examples/spark/{name}.py"
    spark.sparkContext.addPyFile(str(path))
    return importlib.import_module(name)


@pytest.fixture(scope="module")
def spark():
    if not shutil.which("java"):
        pytest.skip("no Java")
    from pyspark.sql import SparkSession

    os.environ["PYSPARK_PYTHON"] = sys.executable
    session = SparkSession.builder.master("local[2]").config("spark.ui.enabled", False).getOrCreate()
    session.sparkContext.setLogLevel("ERROR")
    yield session
    session.stop()


@pytest.fixture(scope="module")
def rows():
    random = np.random.default_rng(11)
    q, v = random.uniform(-1, 1, (2, STATES, 7))
    v[:, 1] -= 2
    q[::50, 4] = np.nan
    return q, v


def test_map_in_arrow_gives_what_one_process_gives(spark, ramone, rows, tmp_path):
    import pyarrow.parquet

    names = ["base_x", "base_z", "base_pitch", *ramone.coordinates[3:]]
    columns = {f"{part}_{name}": rows["qv".index(part)][:, at] for part in "qv" for at, name in enumerate(names)}
    table = pa.table({"id": np.arange(STATES), **columns, "friction": np.full(STATES, 0.5)})
    pa.parquet.write_table(table, tmp_path / "states.parquet")
    own = example(spark, "map_in_arrow")
    urdf = str(ROOT / "urdf/ramone.urdf")
    states = spark.read.parquet(str(tmp_path / "states.parquet")).repartition(7)
    own.answer(spark, urdf, states).write.parquet(str(tmp_path / "results"))
    joined = pa.parquet.read_table(tmp_path / "results").sort_by([("id", "ascending"), ("outcome", "ascending")])
    expected = ramone.impacts(*rows, friction=0.5, place="lowest").to_arrow(np.arange(STATES))
    assert joined.equals(expected.cast(joined.schema))
    assert sum(verdict == "refused" for verdict in joined["verdict"].to_pylist()) == STATES // 50


def test_pipe_gives_what_one_process_gives(spark, ramone, rows, tmp_path):
    states = [state(ramone, *row, friction=0.5, place="lowest", id=at) for at, row in enumerate(zip(*rows))]
    lines = [json.dumps(state) for state in states]
    lines[7] = "oops"
    urdf = ROOT / "urdf/ramone.urdf"
    tool = shutil.which("heelstrike", path=sys.executable.rpartition("/")[0])
    piped = example(spark, "pipe").answer(spark.sparkContext.parallelize(lines, 7), str(urdf), tool).collect()
    (tmp_path / "states.ndjson").write_text("\n".join(lines))
    expected = command("batch", urdf, tmp_path / "states.ndjson", "--refused", "ok", "--quiet").splitlines()

    def without_line(line):
        head, _, rest = line.partition('"line":')
        return head + rest.partition(",")[2]

    assert [without_line(line) for line in piped] == [without_line(line) for line in expected]
