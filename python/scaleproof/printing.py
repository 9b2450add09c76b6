"""Patterns, sheets and cameras: what a script around a printer needs."""

from __future__ import annotations

import json
from typing import Any

import numpy
import numpy.typing

from . import _native
from ._process import Error, PathLike, answer, options, path, shown
from .locating import Camera


class Pattern:
    """A repeated pattern: a PNG file with one pixel per cell.

    Raises :class:`Error` for a file that cannot be read or is none.
    """

    def __init__(self, file: PathLike) -> None:
        self.file: str = path(file)
        columns, rows, colours, sha256 = _native.pattern_load(self.file)
        #: sRGB, rows × columns × 3 bytes.
        self.colours: numpy.typing.NDArray[numpy.uint8] = numpy.frombuffer(colours, numpy.uint8).reshape(rows, columns, 3)
        #: Of the file.
        self.sha256: str = sha256

    @classmethod
    def random(cls, file: PathLike, *, cells: int = 16, seed: int | None = None) -> Pattern:
        """A square of uniformly random colours, written to a file: the baseline that an optimised pattern must beat."""
        answer("pattern", "random", *options(cells=cells, seed=seed, output=path(file)))
        return cls(file)

    @classmethod
    def save(cls, file: PathLike, colours: numpy.typing.ArrayLike, *, tile_mm: float | None = None, **about: Any) -> Pattern:
        """Writes a pattern of rows × columns × 3 colours, sRGB: bytes, or numbers from 0 to 1.

        With ``tile_mm``, the width of a repeat on the model, its card is written beside it, which says that and whatever else is given in ``about``.
        """
        cells = numpy.asarray(colours)
        if cells.ndim != 3 or cells.shape[2] != 3 or not 1 <= min(cells.shape[:2]) <= max(cells.shape[:2]) <= 4096:
            raise Error(f"the pattern has the shape {cells.shape}: give rows × columns × 3, at most 4096 cells a side")
        if cells.dtype != numpy.uint8:
            if not (numpy.issubdtype(cells.dtype, numpy.floating) and (cells >= 0).all() and (cells <= 1).all()):
                raise Error(f"the pattern's colours are {cells.dtype} or not from 0 to 1: give bytes, or numbers from 0 to 1")
            cells = (255 * cells).round().astype(numpy.uint8)
        if tile_mm is not None and not 0 < tile_mm < 1e6:
            raise Error(f"tile_mm is {tile_mm}: give the width of a repeat, mm")
        if own := about.keys() & {"pattern_sha256", "sides"}:
            raise Error(f"{min(own)} is written by save itself: give it another name")
        try:
            text = json.dumps(about, allow_nan=False)
        except (TypeError, ValueError) as error:
            raise Error(f"what is said about the pattern makes no JSON: {error}") from None
        rows, columns = cells.shape[:2]
        if not path(file).lower().endswith(".png"):
            raise Error(f"{shown(path(file))} would hold PNG: let its name end in .png")
        _native.pattern_save(path(file), columns, rows, cells.tobytes(), tile_mm, text)
        return cls(file)

    def __repr__(self) -> str:
        return f"Pattern({self.file!r}): {self.colours.shape[1]} × {self.colours.shape[0]} cells"


def _pattern(pattern: Pattern | PathLike) -> str:
    return pattern.file if isinstance(pattern, Pattern) else path(pattern)


def print_template(pattern: Pattern | PathLike, output: PathLike, *, size_mm: tuple[float, float], **more: Any) -> dict[str, Any]:
    """Sheets of a pattern in true millimetres, a PDF or SVG: what ``scaleproof print template --json`` prints.

    ``size_mm`` is the width and height of the whole. ``more`` are the command's options, as ``tile_mm=118, paper="a3", printer="printer.toml"``.
    """
    try:
        width, height = (float(side) for side in size_mm)
    except (TypeError, ValueError):
        raise Error(f"size_mm is {shown(size_mm)}: give width and height, mm") from None
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
    found = answer("calibrate", *words, paths=[path(one) for one in given])
    return Camera(output), found
