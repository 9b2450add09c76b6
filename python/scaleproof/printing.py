"""Patterns, sheets and cameras: what a script around a printer needs."""

from __future__ import annotations

import os
from typing import Any

from ._process import Error, PathLike, answer, options, path
from .locating import Camera


class Pattern:
    """A repeated pattern: a PNG file with one pixel per cell."""

    def __init__(self, file: PathLike) -> None:
        self.file: str = path(file)
        if not os.path.isfile(self.file):
            raise Error(f"{self.file} is no file: give a pattern's PNG")

    @classmethod
    def random(cls, file: PathLike, *, cells: int = 16, seed: int | None = None) -> Pattern:
        """A square of uniformly random colours, written to a file: the baseline that an optimised pattern must beat."""
        answer("pattern", "random", *options(cells=cells, seed=seed, output=path(file)))
        return cls(file)

    def __repr__(self) -> str:
        return f"Pattern({self.file!r})"


def _pattern(pattern: Pattern | PathLike) -> str:
    return pattern.file if isinstance(pattern, Pattern) else path(pattern)


def print_template(pattern: Pattern | PathLike, output: PathLike, *, size_mm: tuple[float, float], **more: Any) -> dict[str, Any]:
    """Sheets of a pattern in true millimetres, a PDF or SVG: what ``scaleproof print template --json`` prints.

    ``size_mm`` is the width and height of the whole. ``more`` are the command's options, as ``tile_mm=118, paper="a3", printer="printer.toml"``.
    """
    try:
        width, height = (float(side) for side in size_mm)
    except (TypeError, ValueError):
        raise Error(f"size_mm is {size_mm!r}: give width and height, mm") from None
    return answer("print", "template", *options(pattern=_pattern(pattern), size_mm=f"{width:g}x{height:g}", output=path(output), **more))


def print_wrap(output: PathLike, *, pattern: Pattern | PathLike | None = None, **more: Any) -> dict[str, Any]:
    """A model's paint as pieces on sheets, a PDF or SVG: what ``scaleproof print wrap --json`` prints.

    ``more`` are the command's options, as ``scene="scene.toml"``, ``mesh="car.glb"``, ``panels=True``, ``tile_mm=118``.
    """
    return answer("print", "wrap", *options(pattern=None if pattern is None else _pattern(pattern), output=path(output), **more))


def calibrate(photos: list[PathLike] | PathLike, *, board: PathLike, output: PathLike, report: PathLike | None = None) -> tuple[Camera, dict[str, Any]]:
    """A camera from photos of a calibration board, or folders of them: the camera that was written, and what ``scaleproof calibrate --json`` prints."""
    given = photos if isinstance(photos, list) else [photos]
    words = options(board=path(board), output=path(output), report=report)
    found = answer("calibrate", *words, *map(path, given))
    return Camera(output), found
