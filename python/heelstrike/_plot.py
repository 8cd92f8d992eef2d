"""Pictures of robots and results."""

from __future__ import annotations

import os

from ._core import Answers, Robot
from ._values import Result


class Plot:
    """A picture as SVG, which a notebook shows, and the same as text, which a terminal shows."""

    def __init__(self, svg: str | None, text: str) -> None:
        self.svg = svg
        self.text = text

    def _repr_svg_(self) -> str | None:
        return self.svg

    def __repr__(self) -> str:
        return self.text

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the SVG to a file, whose name ends with .svg."""
        if self.svg is None:
            raise ValueError("there is nothing to draw, or not to scale")
        if not os.fspath(path).lower().endswith(".svg"):
            raise ValueError("a picture is saved as SVG: give a name that ends with .svg, or use `heelstrike --plot`")
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.svg)


def plot(result: Result | Robot) -> Plot:
    """Draw a robot, or the result of `Robot.impact`, `Robot.forces` of one state or `Robot.sweep`.

    The question of a result is answered again for its picture: that of a sweep on as many threads, and within the same
    budget, which also covers the picture."""
    if isinstance(result, Robot):
        return Plot(*result._drawn())
    if isinstance(result, Result):
        if result._drawn is None:
            raise ValueError("the result was copied or comes from another process: ask its robot again to draw it")
        robot, *question = result._drawn
        return Plot(*robot._picture(*question))
    what = "Answers have" if isinstance(result, Answers) else f"a {type(result).__name__} has"
    raise TypeError(f"{what} no picture: give a Robot, or the result of one state or of a sweep")
