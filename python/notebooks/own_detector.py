# %% [markdown]
# # A detector of your own
#
# Any function is a detector: a PyTorch model, a service, an ensemble. This one needs no weights: it takes the red of a photo for a car. Photos need no
# session: a folder for each texture does.

# %%
import shutil
import tempfile
from pathlib import Path

import numpy

import scaleproof

skyline, photos = Path("../..") / "captures/skyline", Path(tempfile.mkdtemp())  # notebooks run in their own folder
for texture in ("normal", "random"):
    (photos / texture).mkdir()
    for photo in skyline.glob(f"{texture}_*.jpg"):
        shutil.copy(photo, photos / texture)
folders = {texture: photos / texture for texture in ("normal", "random")}
session = scaleproof.Session.of_folders(folders, scene=skyline / "scene.toml", camera=skyline / "camera.yaml", place="yard")

# %% [markdown]
# The function gets a list of images, height × width × 3 bytes, red first, and returns for each a list of (label, confidence, box). A box is left, top,
# right, bottom in pixels of the image.

# %%
def find_red(images):
    return [find_in(image.astype(int)) for image in images]


def find_in(image):
    red, green, blue = numpy.moveaxis(image, 2, 0)
    rows, columns = numpy.nonzero(red > 40 + 1.4 * numpy.maximum(green, blue))
    if len(rows) < 2000:
        return []
    left, right = numpy.quantile(columns, [0.005, 0.995])
    top, bottom = numpy.quantile(rows, [0.005, 0.995])
    return [("car", min(1.0, len(rows) / 20000), (left, top, right, bottom))]


# %% [markdown]
# `Detector` says what the report shall say of it, and how many images it takes at a time.

# %%
detector = scaleproof.Detector(find_red, "red", version="a threshold", deterministic=True, batch=8)
scores = scaleproof.score(session, detector)
print(scores)

# %% [markdown]
# Each photo and its box is a row of a table, for pandas, pyarrow or polars.

# %%
for row in scores.photos.rows()[::4]:
    print(row["file"], row["verdict"], row["confidence"])

# %% [markdown]
# The detector sees the red car in six photos of eight and the patterned one in none: a drop that eight pairs can show.

# %%
(drop,) = scores.compare().drops
drop.drop, drop.interval_95, drop.p, drop.effect

# %% [markdown]
# What the function does wrong is one sentence. What it raises is the cause of that error.

# %%
try:
    scaleproof.score(session, lambda images: [[("zeppelin", 0.9, (0, 0, 10, 10))] for image in images], threads=1)
except scaleproof.Error as error:
    print(error)
