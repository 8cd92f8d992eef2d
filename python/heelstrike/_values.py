"""Python values as JSON and CSV, and back; called by the Rust half."""

from __future__ import annotations

import csv
import io
import json
import math
import os
from typing import Any


class Result(dict[str, Any]):
    """A result, as the JSON of the command has it, that ``heelstrike.plot`` can draw."""

    _drawn: Any


def read(path: str | os.PathLike[str]) -> str:
    with open(path, encoding="utf-8-sig") as file:
        return file.read()


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a {type(value).__name__} is no part of JSON")


def to_json(value: Any) -> str:
    """JSON of a dictionary, or of the file of a path; text that begins with a brace is JSON already."""
    if isinstance(value, str):
        return value if value.lstrip().startswith("{") else read(value)
    return read(value) if isinstance(value, os.PathLike) else json.dumps(value, default=_plain)


def from_json(text: bytes, drawn: Any) -> Any:
    if drawn is None:
        return json.loads(text)
    result = Result(json.loads(text))
    result._drawn = drawn
    return result


def _friction(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        return [_friction(entry) for entry in value]
    return "infinite" if isinstance(value, float) and math.isinf(value) and value > 0 else value


def problem(delassus: Any, velocity: Any, friction: Any, restitution: Any) -> str:
    velocity, friction = (value.tolist() if hasattr(value, "tolist") else value for value in (velocity, friction))
    if velocity and not isinstance(velocity[0], (list, tuple)):
        velocity = [velocity[at : at + 2] for at in range(0, len(velocity), 2)]
    fields = {"delassus": delassus, "velocity_before": velocity, "friction": _friction(friction)}
    return to_json(fields if restitution is None else {**fields, "restitution": restitution})


def to_csv(table: Any) -> bytes:
    """A table as CSV: a path, a data frame, an Arrow table, or columns by name."""
    if isinstance(table, (str, os.PathLike)):
        with open(table, "rb") as file:
            return file.read()
    if hasattr(table, "to_csv"):
        return str(table.to_csv(index=False)).encode()
    if hasattr(table, "to_pydict"):
        table = table.to_pydict()
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(table)
    columns = (column.tolist() if hasattr(column, "tolist") else column for column in table.values())
    writer.writerows(zip(*columns, strict=True))
    return text.getvalue().encode()
