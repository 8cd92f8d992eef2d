"""Python values as JSON and CSV, and back; called by the Rust half."""

from __future__ import annotations

import csv
import io
import json
import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

from ._core import Answers, Robot


class Result(dict[str, Any]):
    """A result, as the JSON of the command has it, that ``heelstrike.plot`` can draw."""

    _drawn: Any = None
    """The robot and the question, which are not pickled."""

    def __reduce__(self) -> tuple[Any, ...]:
        return Result, (dict(self),)


def read(path: str | os.PathLike[str]) -> bytes:
    with open(path, "rb") as file:
        return file.read()


def robot(text: str, path: os.PathLike[str], options: dict[str, Any] | None) -> Robot:
    """Restore a pickled robot."""
    return Robot._again(text, path, options)


def answers(data: bytes) -> Answers:
    """Restore pickled answers."""
    return Answers._again(data)


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a {type(value).__name__} is no part of JSON")


def to_json(value: Any) -> str | bytes:
    """JSON of a dictionary, or the content of the file of a path; text that begins with a brace is JSON already."""
    if isinstance(value, str):
        return value if value.lstrip().startswith("{") else read(value)
    if isinstance(value, os.PathLike):
        return read(value)
    if isinstance(value, Mapping) and "friction" in value:
        value = {**value, "friction": _friction(value["friction"])}
    return json.dumps(value, default=_plain)


def from_json(text: bytes, drawn: Any) -> Any:
    if drawn is None:
        return json.loads(text)
    result = Result(json.loads(text))
    result._drawn = drawn
    return result


def _friction(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _friction(entry) for name, entry in value.items()}
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, (list, tuple)):
        return [_friction(entry) for entry in value]
    return "infinite" if value == "inf" or isinstance(value, float) and value == math.inf else value


def problem(delassus: Any, velocity: Any, friction: Any, restitution: Any) -> str | bytes:
    # Data frames become arrays.
    delassus, velocity = (own.to_numpy() if hasattr(own, "to_numpy") else own for own in (delassus, velocity))
    velocity = velocity.tolist() if hasattr(velocity, "tolist") else velocity
    for name, value in (("G", delassus), ("c", velocity)):
        if not isinstance(value, (list, tuple)) and not hasattr(value, "shape"):
            raise TypeError(f"{name} is an array or a list, not a {type(value).__name__}")
    # A flat list of numbers, of NumPy or Python, becomes pairs.
    if velocity and not hasattr(velocity[0], "__len__"):
        velocity = [velocity[at : at + 2] for at in range(0, len(velocity), 2)]
    fields = {"delassus": delassus, "velocity_before": velocity, "friction": friction}
    return to_json(fields if restitution is None else {**fields, "restitution": restitution})


def to_csv(table: Any) -> bytes:
    """A table as CSV: a path of text, a data frame, an Arrow table, or columns by name."""
    if isinstance(table, (str, os.PathLike)):
        return read(table)
    if hasattr(table, "to_csv"):
        # pandas writes fewer digits of a float32 than its value has.
        wide = {"float32": "float64", "float16": "float64", "Float32": "Float64"}
        narrow = {name: wide[str(own)] for name, own in table.dtypes.items() if str(own) in wide}
        return str(table.astype(narrow).to_csv(index=False)).encode()
    if hasattr(table, "to_pydict"):
        table = table.to_pydict()
    if not isinstance(table, Mapping):
        what = type(table).__name__
        raise TypeError(f"a table is a path, a data frame, an Arrow table or a dictionary of columns, not a {what}")
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(table)
    columns = {name: column.tolist() if hasattr(column, "tolist") else column for name, column in table.items()}
    for name, column in columns.items():
        if not isinstance(column, Sequence) or isinstance(column, str):
            raise TypeError(f"column {name} is a {type(column).__name__}, not a list")
    if len(counts := {name: len(column) for name, column in columns.items()}) and len({*counts.values()}) > 1:
        raise ValueError(f"the columns have different lengths: {counts}")
    writer.writerows(zip(*columns.values(), strict=True))
    return text.getvalue().encode()
