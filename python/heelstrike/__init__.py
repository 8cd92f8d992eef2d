"""Every outcome of the rigid frictional impact of a planar legged robot.

>>> import heelstrike, numpy
>>> robot = heelstrike.Robot("urdf/ramone.urdf")
>>> robot.coordinates
['x', 'z', 'pitch', 'left_hip', 'left_knee', 'right_hip', 'right_knee']
>>> q, v = numpy.zeros((2, 1000, 7))
>>> v[:, 1] = -1.0
>>> answers = robot.impacts(q, v, friction=0.8, place="lowest")
>>> (answers.verdict == heelstrike.Verdict.UNIQUE).all()
"""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING, Any

from ._core import Answers, Refused, Robot, __version__, solve
from ._plot import Plot, plot
from ._values import Result

if TYPE_CHECKING:
    from ._convert import Layout, from_drake, from_mujoco, from_pinocchio

__all__ = [
    "Answers",
    "Layout",
    "Mode",
    "Plot",
    "Refused",
    "Result",
    "Robot",
    "Verdict",
    "__version__",
    "from_drake",
    "from_mujoco",
    "from_pinocchio",
    "plot",
    "solve",
]


def __getattr__(name: str) -> Any:
    # NumPy is imported only when it is needed, so that the command starts without it.
    if name not in ("Layout", "from_drake", "from_mujoco", "from_pinocchio"):
        raise AttributeError(f"module 'heelstrike' has no attribute '{name}'")
    from . import _convert

    return getattr(_convert, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


class Verdict(enum.IntEnum):
    """The answer to a state in one word, as `Answers.verdict` has it."""

    UNIQUE = 0
    """Exactly one outcome."""
    AMBIGUOUS = 1
    """Several outcomes are equally valid."""
    NONE = 2
    """No outcome is consistent."""
    UNDECIDED = 3
    """No precision settled some sign, or the budget of work was spent first."""
    NO_IMPACT = 4
    """The only outcome has zero impulse."""
    NO_CONTACT = 5
    """Nothing touches the ground."""
    REFUSED = 6
    """The state was not accepted; `Answers.error` says why."""


class Mode(enum.IntEnum):
    """How a contact ends, as `Answers.modes` has it."""

    OPEN = -1
    """It was not closed before the impact."""
    SEPARATE = 0
    """It leaves the ground."""
    STICK = 1
    """It stays where it is."""
    SLIDE_PLUS = 2
    """It slides along +t: forward on level ground."""
    SLIDE_MINUS = 3
    """It slides along -t: backward on level ground."""
