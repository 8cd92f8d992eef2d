from collections.abc import Sequence
from os import PathLike
from typing import Any, Literal, TypeAlias, TypedDict, final, overload, type_check_only

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

from ._values import Result

__all__ = ["Answers", "Refused", "Robot", "__version__", "main", "solve"]

__version__: str

_Friction: TypeAlias = float | Literal["infinite", "inf"]

@type_check_only
class _Reading(TypedDict, total=False):
    plane: Literal["auto", "xz", "yz", "xy", "zy", "zx", "yx"] | None
    hold: dict[str, float]
    base: Literal["fixed", "floating"] | None
    axis_tolerance: float | None
    package_path: Sequence[str | PathLike[str]]
    feet: list[dict[str, Any]]
    contact_tolerance: float | None
    resting_speed: float | None
    strict_limits: bool
    budget: float | Literal["infinite"] | None

@type_check_only
class _Scene(TypedDict, total=False):
    ground: dict[str, Any]
    stance: str
    place: Literal["lowest", "given"]
    held: list[str]
    rotor_inertia: dict[str, float]
    loops: list[dict[str, Any]]
    impulse: list[dict[str, Any]]
    gravity: float
    torque: dict[str, float]
    virtual: list[dict[str, Any]]

class Refused(ValueError):
    """An input was refused."""

    place: str | None
    hint: str | None
    file: PathLike[str] | str
    """Of a robot that was read from a file."""

@final
class Robot:
    def __new__(cls, path: str | PathLike[str], **options: Unpack[_Reading]) -> Robot: ...
    @staticmethod
    def from_string(text: str, **options: Unpack[_Reading]) -> Robot: ...
    @property
    def name(self) -> str: ...
    @property
    def coordinates(self) -> list[str]: ...
    @property
    def plane(self) -> Literal["xz", "yz", "xy", "zy", "zx", "yx"]: ...
    @property
    def held(self) -> dict[str, float]: ...
    def inspect(self) -> dict[str, Any]: ...
    def impact(
        self,
        state: dict[str, Any] | str | PathLike[str],
        *,
        friction: _Friction | None = None,
        explain: bool = False,
        matrices: bool = False,
        next: bool = False,
    ) -> Result: ...
    def impacts(
        self,
        q: ArrayLike,
        v: ArrayLike,
        *,
        friction: _Friction | dict[str, _Friction] | ArrayLike | None = None,
        restitution: float | dict[str, float] | ArrayLike | None = None,
        contacts: list[dict[str, Any]] | None = None,
        threads: int | None = None,
        **scene: Unpack[_Scene],
    ) -> Answers: ...
    @overload
    def forces(
        self,
        q: dict[str, Any] | str | PathLike[str],
        v: None = None,
        *,
        friction: _Friction | None = None,
        explain: bool = False,
        matrices: bool = False,
    ) -> Result: ...
    @overload
    def forces(
        self,
        q: ArrayLike,
        v: ArrayLike,
        *,
        friction: _Friction | dict[str, _Friction] | ArrayLike | None = None,
        restitution: float | dict[str, float] | ArrayLike | None = None,
        contacts: list[dict[str, Any]] | None = None,
        threads: int | None = None,
        **scene: Unpack[_Scene],
    ) -> Answers: ...
    def sweep(
        self,
        study: dict[str, Any] | str | PathLike[str],
        *,
        friction: _Friction | None = None,
        threads: int | None = None,
        budget: float | Literal["infinite"] | None = ...,
    ) -> Result: ...
    def touchdowns(
        self,
        table: Any,
        *,
        friction: _Friction | None = None,
        velocity: Literal["central", "backward"] | None = None,
        at: Literal["crossing", "row"] | None = None,
        touching: str | None = None,
        drop: float | None = None,
        ground_height: float | None = None,
        simulated: bool = False,
        foreign: str | Sequence[str] | None = None,
    ) -> list[dict[str, Any]]: ...
    @staticmethod
    def _again(text: str, path: str | PathLike[str], options: dict[str, Any] | None) -> Robot: ...
    def _drawn(self) -> tuple[str | None, str]: ...
    def _picture(
        self, kind: str, question: str, friction: str | None, threads: int | None, budget: float | None
    ) -> tuple[str | None, str]: ...

@final
class Answers:
    @property
    def coordinates(self) -> list[str]: ...
    @property
    def contacts(self) -> list[str]: ...
    @property
    def columns(self) -> list[str]: ...
    @property
    def verdict(self) -> NDArray[np.uint8]: ...
    @property
    def all_proven(self) -> NDArray[np.bool_]: ...
    @property
    def offsets(self) -> NDArray[np.int64]: ...
    @property
    def modes(self) -> NDArray[np.int8]: ...
    @property
    def impulse(self) -> NDArray[np.float64]: ...
    @property
    def force(self) -> NDArray[np.float64]: ...
    @property
    def velocity_after(self) -> NDArray[np.float64]: ...
    @property
    def acceleration(self) -> NDArray[np.float64]: ...
    @property
    def margin(self) -> NDArray[np.float64]: ...
    @property
    def index(self) -> NDArray[np.int8]: ...
    @property
    def proven(self) -> NDArray[np.bool_]: ...
    @property
    def family(self) -> NDArray[np.bool_]: ...
    @property
    def error(self) -> list[str | None]: ...
    @property
    def notes(self) -> list[str | None]: ...
    @property
    def border(self) -> list[str | None]: ...
    @property
    def families(self) -> list[str | None]: ...
    def __len__(self) -> int: ...
    @staticmethod
    def _again(bytes: bytes) -> Answers: ...
    def to_arrow(self, id: Any = None) -> Any: ...
    def to_pandas(self, id: Any = None) -> Any: ...

def solve(
    G: ArrayLike,
    c: ArrayLike,
    friction: _Friction | ArrayLike,
    restitution: ArrayLike | None = None,
    *,
    explain: bool = False,
    budget: float | Literal["infinite"] | None = ...,
) -> dict[str, Any]: ...
def main(arguments: list[str]) -> int: ...
