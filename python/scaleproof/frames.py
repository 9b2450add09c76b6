"""What the surrogate renderer of a view is made of, as arrays: any framework can put a pattern into the image."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy
import numpy.typing

from . import _native
from ._process import Error, PathLike, path

Array = numpy.typing.NDArray[numpy.float64]

#: sRGB's linear part, below which a value is 12.92 times its light (IEC 61966-2-1).
_LINEAR_BELOW = 0.0031308


@dataclass(frozen=True)
class View:
    """One pose in one light: the image of any pattern on the model, of N = height · width pixels, row by row.

    The light of a pixel's paint is the weighted sum of its cells' light: those of pixel p are ``cells[starts[p]:starts[p + 1]]`` with ``weights`` likewise;
    a pixel without any has the mean of all cells. With that light ρ (in sRGB instead where ``power`` is None), a channel is
    y = a + b·ρ + c·ρ² with ``terms[p, channel] = (a, b, c)``, clipped to 0 … 1, and the image is sRGB's curve of y^(1 / power), or y itself without a power.
    """

    #: Name of its first frame.
    name: str
    #: Height and width, px.
    shape: tuple[int, int]
    #: Columns and rows of the pattern.
    grid: tuple[int, int]
    #: N + 1.
    starts: numpy.typing.NDArray[numpy.int64] = field(repr=False)
    cells: numpy.typing.NDArray[numpy.int64] = field(repr=False)
    weights: Array = field(repr=False)
    #: N × 3 × 3: pixel, channel, term.
    terms: Array = field(repr=False)
    power: float | None
    #: Height × width, 0 to 1: how much of each pixel the model covers.
    mask: Array = field(repr=False)
    #: Height × width × 3: the image in a pattern of middle grey, whose pixels beside the model are the background.
    background: Array = field(repr=False)

    def render(self, pattern: Array) -> Array:
        """The image, height × width × 3 in sRGB 0 to 1, of a pattern of rows × columns × 3 in sRGB 0 to 1; in numpy, for comparison."""
        columns, rows = self.grid
        colours = numpy.asarray(pattern, numpy.float64)
        if colours.shape != (rows, columns, 3) or not numpy.isfinite(colours).all():
            raise Error(f"the pattern has the shape {colours.shape}: give rows × columns × 3 = {rows} × {columns} × 3 finite numbers, sRGB, 0 to 1")
        light = _decode(colours.reshape(-1, 3).clip(0, 1))
        pixels = numpy.repeat(numpy.arange(len(self.starts) - 1), numpy.diff(self.starts))
        paint = numpy.zeros((len(self.starts) - 1, 3))
        numpy.add.at(paint, pixels, self.weights[:, None] * light[self.cells])
        paint[numpy.diff(self.starts) == 0] = light.mean(0)
        t = _encode(paint) if self.power is None else paint
        a, b, c = numpy.moveaxis(self.terms, 2, 0)
        y = (a + t * (b + t * c)).clip(0, 1)
        return (y if self.power is None else _encode(y ** (1 / self.power))).reshape(*self.shape, 3)


def _decode(x: Array) -> Array:
    return numpy.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def _encode(y: Array) -> Array:
    return numpy.where(y <= _LINEAR_BELOW, 12.92 * y, 1.055 * y ** (1 / 2.4) - 0.055)


class Frames:
    """Frames of a model in flat colours: a folder with a ``frames.json``."""

    def __init__(self, folder: PathLike) -> None:
        self.folder: str = path(folder)
        self._native = _native.Frames(self.folder)
        views, (width, height) = self._native.about()
        #: How many views it has.
        self.views: int = views
        #: Height and width of the images, px.
        self.shape: tuple[int, int] = (height, width)

    def __len__(self) -> int:
        return self.views

    def view(self, index: int, *, cells: int | tuple[int, int] = 16, tile_mm: float, form: str = "quadratic-curve") -> View:
        """The view of a number from 0, for patterns of so many cells (columns, rows) whose repeat is ``tile_mm`` wide on the model.

        ``form`` is ``affine``, ``quadratic``, ``affine-curve`` or ``quadratic-curve``; the last needs three flat colours. The pattern is world-aligned,
        as printed panels have it.
        """
        grid = (cells, cells) if isinstance(cells, int) else cells
        if not (len(grid) == 2 and all(isinstance(side, int) and 1 <= side <= 4096 for side in grid)) or not 0 < tile_mm < 1e6:
            raise Error(f"the pattern has {cells!r} cells on {tile_mm!r} mm: give columns and rows from 1 to 4096, and mm above 0")
        if not isinstance(index, int) or not 0 <= index < self.views:
            raise Error(f"there is no view {index!r}: they are numbered from 0 to {self.views - 1}")
        starts, found, weights, terms, power, mask, name = self._native.view(index, grid, float(tile_mm), form)
        grey = self._native.render(index, grid, float(tile_mm), form, [[0.2158605, 0.2158605, 0.2158605]] * (grid[0] * grid[1]))
        return View(
            name=name,
            shape=self.shape,
            grid=grid,
            starts=numpy.frombuffer(starts, numpy.uint64).astype(numpy.int64),
            cells=numpy.frombuffer(found, numpy.uint32).astype(numpy.int64),
            weights=numpy.frombuffer(weights, numpy.float64),
            terms=numpy.frombuffer(terms, numpy.float64).reshape(-1, 3, 3),
            power=power,
            mask=numpy.frombuffer(mask, numpy.uint8).reshape(self.shape) / 255,
            background=numpy.frombuffer(grey, numpy.float64).reshape(*self.shape, 3),
        )
