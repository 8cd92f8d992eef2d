"""The answers as a table, with the columns that `batch` writes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ._core import Answers


def _import(name: str) -> Any:
    try:
        return __import__(name)
    except ModuleNotFoundError as error:
        needs = "a table needs pyarrow, and a data frame pandas as well: pip install pyarrow pandas"
        raise ModuleNotFoundError(needs, name=error.name) from None


def to_arrow(answers: Answers, id: Any = None) -> Any:
    pa = _import("pyarrow.compute")
    import numpy as np

    from . import Mode, Verdict

    outcomes = np.diff(answers.offsets)
    # A state without outcome has a row as well.
    state = np.repeat(np.arange(len(answers)), np.maximum(outcomes, 1))
    verdict, nothing = answers.verdict[state], outcomes[state] == 0
    outcome = np.cumsum(~nothing) - 1
    at = pa.array(outcome, mask=nothing)

    def per_outcome(values: Any) -> Any:
        # NaN becomes null.
        return pa.array(values, from_pandas=True).take(at)

    def named(values: Any, names: list[str]) -> Any:
        return pa.array(names).take(pa.array(values, mask=values < 0))

    def texts(values: Sequence[str | None], places: Sequence[int | None]) -> Any:
        # `take` is limited to 2 GiB of text.
        return pa.array((None if place is None else values[place] for place in places), pa.string())

    ids = np.arange(len(answers)) if id is None else id
    ids = ids if isinstance(ids, (pa.Array, pa.ChunkedArray)) else pa.array(ids)
    if len(ids) != len(answers):
        raise ValueError(f"id has {len(ids)} entries for {len(answers)} states")
    all_proven = pa.array(answers.all_proven[state], mask=verdict == Verdict.REFUSED)
    is_forces = hasattr(answers, "force")
    vectors = answers.force if is_forces else answers.impulse
    cells = [
        ids.take(pa.array(state)),
        named(verdict, [own.name.lower() for own in Verdict]),
        pa.array(outcome - answers.offsets[state] + 1, mask=nothing),
        per_outcome(answers.margin),
        pa.compute.if_else(pa.array(nothing), all_proven, per_outcome(answers.proven)),
    ]
    modes = [own.name.lower().replace("_plus", "+").replace("_minus", "-") for own in Mode if own >= 0]
    for contact in range(len(answers.contacts)):
        cells.append(named(answers.modes[:, contact], modes).take(at))
        cells += [per_outcome(vectors[:, contact, axis]) for axis in (0, 1)]
    cells += map(per_outcome, (answers.acceleration if is_forces else answers.velocity_after).T)
    own, of_state = at.to_pylist(), state.tolist()
    cells += [texts(answers.border, own), per_outcome(answers.family), texts(answers.families, own)]
    cells += [texts(answers.error, of_state), texts(answers.notes, of_state)]
    return pa.table(cells, names=answers.columns)


def to_pandas(answers: Answers, id: Any = None) -> Any:
    pd = _import("pandas")

    # A refused state has null cells; these nullable types keep the types of the columns.
    types = {"bool": pd.BooleanDtype(), "int64": pd.Int64Dtype()}
    return to_arrow(answers, id).to_pandas(types_mapper=lambda own: types.get(str(own)))
