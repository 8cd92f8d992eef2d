"""Parquet and Arrow through the command, against what pyarrow writes and reads."""

import subprocess

import pyarrow as pa
import pyarrow.csv
import pyarrow.feather
import pyarrow.parquet
import pytest
from conftest import COMMAND, ROOT

WALK = ROOT / "examples/gait/ramone_walk.csv"


def batch(source, target, *options):
    arguments = ["batch", "urdf/ramone.urdf", str(source), "--friction", "0.6", "-o", str(target), *options]
    done = subprocess.run([*COMMAND, *arguments], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return done.stderr


def write(table, path, **options):
    if path.suffix == ".parquet":
        pa.parquet.write_table(table, path, **options)
    elif path.suffix == ".arrow":
        pa.feather.write_feather(table, path, **options)
    else:
        with pa.ipc.new_stream(path, table.schema) as stream:
            stream.write_table(table, max_chunksize=30)


def read(path):
    if path.suffix == ".parquet":
        return pa.parquet.read_table(path)
    return pa.ipc.open_stream(path).read_all() if path.suffix == ".arrows" else pa.feather.read_table(path)


def walk():
    table = pa.csv.read_csv(WALK)
    count = len(table)
    foreign = {
        "phase": pa.array([None if row % 5 == 0 else row for row in range(count)], pa.int32()),
        "side": pa.array(["left" if row % 2 else "right" for row in range(count)]).dictionary_encode(),
        "load": pa.array([0.1] * count, pa.float32()),
        "when": pa.array(range(count), pa.timestamp("ms", "UTC")),
        "path": pa.array([[row, 1] for row in range(count)], pa.list_(pa.int64())),
    }
    for name, column in foreign.items():
        table = table.append_column(name, column)
    return table, foreign


@pytest.mark.parametrize("options", [(), ("--brief",), ("--touchdowns",)])
@pytest.mark.parametrize("ending", ["parquet", "arrow", "arrows"])
def test_columns_are_answered_as_the_csv(tmp_path, ending, options):
    table, foreign = walk()
    source, target = tmp_path / f"walk.{ending}", tmp_path / f"answers.{ending}"
    write(table, source)
    notes = batch(source, target, *options)
    assert notes.splitlines()[0] == batch(WALK, tmp_path / "answers.csv", *options).splitlines()[0]
    text = ["id", "error", "notes", "families", "border"]
    types = {name: pa.string() for name in text}
    convert = pa.csv.ConvertOptions(column_types=types, null_values=[""], strings_can_be_null=True)
    expected = pa.csv.read_csv(tmp_path / "answers.csv", convert_options=convert)
    found = read(target)
    found.validate(full=True)
    for name in set(expected.column_names) - {"line", "touchdown_row"}:
        assert found[name].to_pylist() == expected[name].to_pylist(), name
    for name in ["line", "touchdown_row"]:
        if name in found.column_names:
            # Lines of a CSV count its header; rows of columns have none.
            assert [row + 1 for row in found[name].to_pylist()] == expected[name].to_pylist()
    for name, column in foreign.items():
        # A file of Arrow has one dictionary for all blocks.
        values = ending == "arrow" and pa.types.is_dictionary(column.type)
        assert found[name].type == (column.type.value_type if values else column.type), name
        if not options:
            rows = [line - 1 for line in found["line"].to_pylist()]
            assert found[name].to_pylist() == column.take(rows).to_pylist(), name


@pytest.mark.parametrize("compression", ["none", "snappy", "gzip", "lz4", "zstd"])
def test_compressions_are_read_or_refused_with_a_remedy(tmp_path, compression):
    source = tmp_path / "walk.parquet"
    write(pa.csv.read_csv(WALK), source, compression=compression)
    if compression == "zstd":
        with pytest.raises(AssertionError, match="hint: write it with the compression snappy"):
            batch(source, tmp_path / "answers.csv")
    else:
        batch(source, tmp_path / "answers.csv")


def test_numbers_of_other_types_mean_what_they_are(tmp_path):
    table = pa.csv.read_csv(WALK)
    narrow = table.set_column(3, "q_base_z", table["q_base_z"].cast(pa.float32()))
    wide = narrow.set_column(3, "q_base_z", narrow["q_base_z"].cast(pa.float64()))
    answers = []
    for name, states in [("narrow", narrow), ("wide", wide)]:
        write(states, tmp_path / f"{name}.parquet")
        batch(tmp_path / f"{name}.parquet", tmp_path / f"{name}.csv")
        answers.append((tmp_path / f"{name}.csv").read_text())
    assert answers[0] == answers[1]


def test_data_frames_are_read_as_flat_lines(tmp_path):
    pandas = pytest.importorskip("pandas")
    pandas.read_csv(WALK).to_json(tmp_path / "walk.ndjson", orient="records", lines=True, double_precision=15)
    batch(tmp_path / "walk.ndjson", tmp_path / "answers.csv")
    batch(WALK, tmp_path / "expected.csv")
    verdicts = [pandas.read_csv(tmp_path / name).verdict for name in ("answers.csv", "expected.csv")]
    assert list(verdicts[0]) == list(verdicts[1])
