# %% [markdown]
# # A first experiment from Python
#
# Does a pattern make detectors miss a 1:10 car? Stored photos, which are renders, stand in for a camera, and stored detections for detectors' weights.

# %%
import tempfile
from pathlib import Path

import scaleproof

clone = Path("../..")  # notebooks run in their own folder
out = Path(tempfile.mkdtemp())

# %% [markdown]
# A pattern has one pixel per cell. Its sheets are true millimetres: 118 mm a repeat.

# %%
pattern = scaleproof.Pattern.random(out / "pattern.png", cells=16, seed=1)
sheets = scaleproof.print_template(pattern, out / "sheets.pdf", size_mm=(600, 300), tile_mm=118)
pattern.colours.shape, sheets["sheets"], sheets["cell_mm"]

# %% [markdown]
# AprilTags around the model tell where each photo was taken from.

# %%
photos = sorted((clone / "captures/skyline").glob("normal_*.jpg"))
scene = scaleproof.Scene(clone / "captures/skyline/scene.toml")
camera = scaleproof.Camera(clone / "captures/skyline/camera.yaml")
for found in scaleproof.locate_many(photos, scene, camera):
    name = Path(found.file).name
    print(name, f"{found.azimuth_deg:.0f}° ± {found.sigma_azimuth_deg:.3f}°" if found else found.reason)

# %% [markdown]
# The session names each photo's texture: the plain model, a random pattern, and one that was made against two other detectors. Figures and files are
# those of the program, to the digits; `print(scores)` has its whole table.

# %%
session = scaleproof.Session(clone / "captures/skyline")
scores = scaleproof.score(session, recorded=True)
for one in scores.summaries:
    print(f"{one.detector:13} {one.variant:11} AP@0.5 {one.overall.ap50:.3f}, hits {one.overall.hit_rate.count} of {one.overall.photos}")

# %%
page = scores.write(out / "report")  # report.html, with tables for LaTeX, CSV and COCO beside it
for row in scores.photos.rows():
    if row["detector"] == "yolox_nano" and row["verdict"] == "missed":
        print(row["file"], f"taken for a {row['other_label']}" if row["other_label"] else "not seen")

# %% [markdown]
# Are the drops real? Photos of one direction are paired, and the tests are corrected for their number.

# %%
for drop in scores.compare().drops:
    print(f"{drop.variant:11} {drop.detector:13} {drop.base:.2f} → {drop.other:.2f}, {drop.effect}")

# %% [markdown]
# How many photos does a drop of the confidence by 0.2 take, where it varies from view to view as here?

# %%
scaleproof.plan(0.2, session)
