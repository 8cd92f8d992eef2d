"""The arrays of answers as a table, with the columns that `batch` writes as CSV."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._core import Answers

VERDICTS = ("unique", "ambiguous", "none", "undecided", "no_impact", "no_contact", "refused")
MODES = ("separate", "stick", "slide+", "slide-")


def summary(answers: Answers) -> str:
    counts = np.bincount(answers.verdict, minlength=len(VERDICTS))
    verdicts = ", ".join(f"{count} {name}" for name, count in zip(VERDICTS, counts) if count)
    return f"Answers({len(answers)} states: {verdicts or 'none'}; contacts {', '.join(answers.contacts) or 'none'})"


def to_arrow(answers: Answers, id: Any = None) -> Any:
    import pyarrow as pa  # type: ignore[import-untyped, unused-ignore]

    counts = np.diff(answers.offsets)
    rows = np.maximum(counts, 1)
    state = np.repeat(np.arange(len(answers)), rows)
    number = np.arange(len(state)) - np.repeat(np.cumsum(rows) - rows, rows)
    # A state without outcome has a row with the cells of outcomes empty.
    empty = np.repeat(counts == 0, rows)
    place = pa.array(answers.offsets[state] + number, mask=empty)
    refused = answers.verdict[state] == VERDICTS.index("refused")

    def of_outcome(values: Any) -> Any:
        return pa.array(values, from_pandas=True).take(place)

    def texts(values: list[str | None]) -> Any:
        return pa.array(values, type=pa.string())

    impact = hasattr(answers, "impulse")
    given, after = (answers.impulse, answers.velocity_after) if impact else (answers.force, answers.acceleration)
    proven = of_outcome(answers.proven).fill_null(False).to_numpy(zero_copy_only=False)
    if not isinstance(id, (pa.Array, pa.ChunkedArray)):
        id = pa.array(np.arange(len(answers)) if id is None else id)
    if len(id) != len(answers):
        raise ValueError(f"id has {len(id)} entries for {len(answers)} states")
    columns = [
        id.take(pa.array(state)),
        pa.array(VERDICTS).take(pa.array(answers.verdict)).take(pa.array(state)),
        pa.array(number + 1, mask=empty),
        of_outcome(answers.margin),
        pa.array(np.where(empty, answers.all_proven[state], proven), mask=refused),
    ]
    for at in range(len(answers.contacts)):
        modes = answers.modes[:, at]
        columns.append(pa.array(MODES).take(pa.array(modes, mask=modes < 0)).take(place))
        columns += [of_outcome(given[:, at, entry]) for entry in range(2)]
    columns += [of_outcome(after[:, at]) for at in range(len(answers.coordinates))]
    columns += [
        texts(answers.border).take(place),
        of_outcome(answers.family),
        texts(answers.families).take(place),
        texts(answers.error).take(pa.array(state)),
        texts(answers.notes).take(pa.array(state)),
    ]
    return pa.Table.from_arrays(columns, names=answers.columns)


def to_pandas(answers: Answers, id: Any = None) -> Any:
    return to_arrow(answers, id).to_pandas()
