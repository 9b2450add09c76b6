# %% [markdown]
# # A loss of your own
#
# A view's image in any pattern is a formula of plain arrays, so any loss can move a pattern that the printer prints. Here the loss is the difference
# between the car and the ground around it: a camouflage, made in numpy. In PyTorch `scaleproof.torch.render` does the same, with `backward()`.

# %%
import tempfile
from pathlib import Path

import numpy

import scaleproof

frames = scaleproof.Frames(Path("../..") / "captures/skyline_frames")  # notebooks run in their own folder
views = [frames.view(index, cells=8, tile_mm=480, form="affine") for index in range(len(frames))]
[(view.name, view.shape, len(view.weights)) for view in views]

# %% [markdown]
# The light of a pixel's paint is a weighted sum of its cells' light, and the pixel a polynomial of that in sRGB; `help(scaleproof.View)` has the
# formula. This follows it back: from the gradient by a view's pixels to that by the cells.


# %%
def decode(x):  # sRGB to light, and its derivative
    dark = x <= 0.04045
    base = (x + 0.055) / 1.055
    return numpy.where(dark, x / 12.92, base**2.4), numpy.where(dark, 1 / 12.92, 2.4 / 1.055 * base**1.4)


def encode(y):  # light to sRGB, and its derivative
    dark, y_ = y <= 0.0031308, numpy.maximum(y, 0.0031308)
    return numpy.where(dark, 12.92 * y, 1.055 * y_ ** (1 / 2.4) - 0.055), numpy.where(dark, 12.92, 1.055 / 2.4 * y_ ** (1 / 2.4 - 1))


def pull_back(view, pattern, gradient):
    light, by_pattern = decode(pattern.reshape(-1, 3))
    pixels = numpy.repeat(numpy.arange(len(view.starts) - 1), numpy.diff(view.starts))
    paint = numpy.zeros((len(view.starts) - 1, 3))
    numpy.add.at(paint, pixels, view.weights[:, None] * light[view.cells])
    t, by_paint = encode(paint)
    a, b, c = numpy.moveaxis(view.terms, 2, 0)
    y = a + t * (b + t * c)
    by_light = numpy.where((0 < y) & (y < 1), gradient.reshape(-1, 3) * (b + 2 * t * c), 0) * by_paint
    by_cells = numpy.zeros_like(light)
    numpy.add.at(by_cells, view.cells, view.weights[:, None] * by_light[pixels])
    return (by_cells * by_pattern).reshape(pattern.shape)


# %% [markdown]
# The loss: how far the car's pixels are from the mean colour beside it. One number of the gradient is checked against a difference.


# %%
def loss(view, pattern):
    car = view.mask > 0.5
    # A pixel that shows no cell has no paint on it.
    car &= numpy.diff(view.starts).reshape(view.shape) > 0
    gap = (view.render(pattern) - view.background[view.mask == 0].mean(0)) * car[..., None]
    return (gap**2).sum() / car.sum(), pull_back(view, pattern, 2 * gap / car.sum())


pattern = numpy.random.default_rng(1).random((8, 8, 3))
step = numpy.zeros_like(pattern)
step[7, 4, 1] = 1e-5
difference = (loss(views[0], pattern + step)[0] - loss(views[0], pattern - step)[0]) / 2e-5
bool(abs(difference / loss(views[0], pattern)[1][7, 4, 1] - 1) < 1e-4)

# %% [markdown]
# Forty steps, smaller and smaller.

# %%
for number in range(41):
    losses, gradients = zip(*(loss(view, pattern) for view in views))
    if number % 10 == 0:
        print(number, f"{numpy.mean(losses):.4f}")
    pattern = (pattern - 0.08 * 0.93**number * numpy.sign(sum(gradients))).clip(0, 1)

# %% [markdown]
# The pattern is saved with a card that says how wide a repeat is, so that the sheets need no size of it.

# %%
out = Path(tempfile.mkdtemp())
saved = scaleproof.Pattern.save(out / "pattern.png", pattern, tile_mm=480, made_by="own_loss")
scaleproof.print_template(saved, out / "sheets.pdf", size_mm=(480, 240), paper="a3")["cell_mm"]
