"""The answers as a table, with the columns that `batch` writes."""

from __future__ import annotations

from typing import Any

from ._core import Answers


def to_arrow(answers: Answers, id: Any = None) -> Any:
    try:
        import pyarrow as pa  # type: ignore[import-untyped, unused-ignore]
    except ModuleNotFoundError as error:
        needs = "a table needs pyarrow, and a data frame pandas as well: pip install pyarrow pandas"
        raise ModuleNotFoundError(needs, name=error.name) from None

    table = pa.ipc.open_stream(answers._stream()).read_all()
    if id is None:
        return table
    ids = id if isinstance(id, (pa.Array, pa.ChunkedArray)) else pa.array(id)
    if len(ids) != len(answers):
        raise ValueError(f"id has {len(ids)} entries for {len(answers)} states")
    return table.set_column(0, "id", ids.take(table["id"]))


def to_pandas(answers: Answers, id: Any = None) -> Any:
    import pandas as pd  # type: ignore[import-untyped, unused-ignore]

    # A refused state has no outcome: with these types its row does not change those of the columns.
    types = {"bool": pd.BooleanDtype(), "int64": pd.Int64Dtype()}
    return to_arrow(answers, id).to_pandas(types_mapper=lambda own: types.get(str(own)))
