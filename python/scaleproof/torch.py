"""The renderer in a training loop: a pattern that any loss on any PyTorch model can move, and that our printer prints."""

from __future__ import annotations

from collections.abc import Sequence

import torch

from ._process import Error
from .frames import View


def render(cells: torch.Tensor, views: Sequence[View]) -> torch.Tensor:
    """The images of a pattern in some views of one size: views × 3 × height × width, sRGB, 0 to 1, differentiable by the cells.

    ``cells`` has 3 × rows × columns numbers, sRGB, 0 to 1, as an image that PyTorch has; the images are on its device and of its type.
    """
    if not views:
        raise Error("no view is given")
    columns, rows = views[0].grid
    if any(view.grid != views[0].grid or view.shape != views[0].shape for view in views):
        raise Error("the views are of different grids or sizes: render them one by one")
    if tuple(cells.shape) != (3, rows, columns) or not cells.is_floating_point():
        raise Error(f"the cells have the shape {tuple(cells.shape)} of {cells.dtype}: give 3 × {rows} × {columns} floating-point numbers")
    light = _decode(_within(cells)).reshape(3, -1).t()
    return torch.stack([_view(light, view) for view in views])


def _view(light: torch.Tensor, view: View) -> torch.Tensor:
    def on_device(array: object, kind: torch.dtype) -> torch.Tensor:
        tensor: torch.Tensor = torch.as_tensor(array, device=light.device)
        return tensor.to(kind)

    starts, cells = on_device(view.starts, torch.int64), on_device(view.cells, torch.int64)
    weights, terms = on_device(view.weights.copy(), light.dtype), on_device(view.terms.copy(), light.dtype)
    counts = starts.diff()
    pixels = torch.repeat_interleave(torch.arange(len(counts), device=light.device), counts)
    paint = light.new_zeros(len(counts), 3).index_add(0, pixels, weights[:, None] * light[cells])
    paint = torch.where(counts.eq(0)[:, None], light.mean(0), paint)
    t = _encode(paint) if view.power is None else paint
    a, b, c = terms.unbind(2)
    y = (a + t * (b + t * c)).clamp(0, 1)
    if view.power is not None:
        y = _encode(_power(y, 1 / view.power))
    return y.t().reshape(3, *view.shape)


def _within(cells: torch.Tensor) -> torch.Tensor:
    """Cells from 0 to 1. The derivative at 0 and 1 is 1 in every version of PyTorch, so that black and white cells can change."""
    return torch.where(cells.ge(0) & cells.le(1), cells, cells.detach().clamp(0, 1))


def _power(y: torch.Tensor, exponent: float) -> torch.Tensor:
    """y to a power, whose derivative at 0 is 0, as the renderer's is where it clips."""
    inside = y.gt(0)
    return torch.where(inside, torch.where(inside, y, torch.ones_like(y)).pow(exponent), torch.zeros_like(y))


def _decode(x: torch.Tensor) -> torch.Tensor:
    return torch.where(x.le(0.04045), x.div(12.92), x.clamp(min=0.04045).add(0.055).div(1.055).pow(2.4))


def _encode(y: torch.Tensor) -> torch.Tensor:
    """sRGB of light (IEC 61966-2-1)."""
    return torch.where(y.le(0.0031308), y.mul(12.92), y.clamp(min=0.0031308).pow(1 / 2.4).mul(1.055).sub(0.055))
