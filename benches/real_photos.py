"""Real photos with independent truth: what benches/real_photos.sh prints.

    real_photos.py sessions PHOTOS FOLDER   each set with truth as sessions, FOLDER/SCENE/SET, for `chart sigma`
    real_photos.py sigma CHARTS .           Markdown: the shares of errors within 1, 2 and 3 σ in CHARTS/sigma.json
    real_photos.py table PHOTOS PROGRAM     Markdown: scaleproof beside C AprilTag and OpenCV's ArUco, each with SQPnP and Levenberg-Marquardt

PHOTOS holds a folder a set with its camera.yaml, scenes and truth.json (photo -> view: azimuth °, pitch °, distance mm).
"""

import functools
import json
import os
import statistics
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter, defaultdict
from pathlib import Path

import cv2
import numpy as np

from pose_speed import camera, finder, from_target, tags

# σ of the truth: degrees of azimuth and pitch, mm of the distance. Each set's NOTES.md says where it comes from: adjusted over all photos
# (swatbotics, veldrovive), or from one photo by C AprilTag's corners among tags that stand as drawn (photonvision: "approximate", 50 to 150 mm from the
# places measured by tape).
TRUTH_SIGMA = {"swatbotics": (0.3, 20.0), "veldrovive": (0.3, 10.0), "photonvision": (1.0, 100.0)}
# Wrong in truth.json (NOTES.md).
WITHOUT_TRUTH = {"IMG_1415.JPG"}
PEERS = {"C AprilTag + SQPnP": "apriltag-1", "OpenCV ArUco + SQPnP": "aruco"}


def photos_of(folder):
    """By scene file, each photo that is there, with its truth."""
    by_scene = defaultdict(list)
    for name, truth in json.loads((folder / "truth.json").read_text()).items():
        # Some names say where the photo came from: the longest end of it that is a file here counts.
        parts = Path(name).parts
        ends = [Path(*parts[i:]) for i in range(len(parts))]
        path = next((folder / end for end in ends if (folder / end).is_file()), None)
        scene = truth.get("wall") or truth.get("scene")
        if path and truth.get("view") and path.name not in WITHOUT_TRUTH:
            by_scene[folder / (f"scene_{scene}.toml" if scene else "scene.toml")].append((path, truth))
    return by_scene


def sessions(photos, out):
    for name, (degrees, mm) in TRUTH_SIGMA.items():
        sigma = {"azimuth_deg": degrees, "pitch_deg": degrees, "distance_mm": mm}
        for scene, entries in photos_of(photos / name).items():
            folder = out / scene.stem / name
            folder.mkdir(parents=True, exist_ok=True)
            for path in [scene, scene.parent / "camera.yaml", *(path for path, _ in entries)]:
                (folder / path.name).unlink(missing_ok=True)
                (folder / path.name).symlink_to(path)
            stored = [{"file": path.name, "variant": "normal"} for path, _ in entries]
            session = {"scene": scene.name, "camera": "camera.yaml", "photos": stored}
            (folder / "session.json").write_text(json.dumps(session))
            views = [dict(zip(["azimuth_deg", "pitch_deg", "distance_mm"], truth["view"])) for _, truth in entries]
            known = [view | {"file": path.name, "sigma": sigma} for view, (path, _) in zip(views, entries)]
            (folder / "truth.json").write_text(json.dumps({"photos": known}))


def ours(program, scene, paths):
    """What `locate` says of each photo: view and σ, or the reason why there is none."""
    command = [program, "locate", *paths, "--scene", scene, "--camera", scene.parent / "camera.yaml", "--json", "--quiet"]
    lines = subprocess.run(command, capture_output=True, text=True).stdout.splitlines()
    answers = []
    for line in map(json.loads, lines):
        keys = ["azimuth_deg", "pitch_deg", "distance_mm"]
        is_located = line["status"] == "located"
        answers.append(([line[k] for k in keys], [line["sigma"][k] for k in keys]) if is_located else line["code"])
    return answers


# C AprilTag's memory does not survive that several detectors end: each is made once, and the program ends without ending them.
finder = functools.cache(finder)


def theirs(detector, scene_path, paths):
    scene = tomllib.loads(scene_path.read_text())
    matrix, lens, _ = camera(scene_path.parent / "camera.yaml")
    corners, target = tags(scene)
    find = finder(detector, scene["tag"][0].get("family", "tag36h11").removeprefix("tag"))
    answers = []
    for path in paths:
        seen = [(corners[i], c) for i, c in find(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)) if i in corners]
        if not seen:
            answers.append("no_known_tag")
            continue
        x, y, z = from_target(seen, matrix, lens, target)
        distance = float(np.linalg.norm([x, y, z]))
        view = [np.degrees(np.arctan2(y, x)) % 360, np.degrees(np.arcsin(z / distance)), distance]
        answers.append((list(map(float, view)), None))
    return answers


def turn(a, b):
    return (a - b + 180) % 360 - 180


def is_in_wrong_bin(view, true, step):
    """Another azimuth bin than the true one, the truth being more than 1° inside its bin."""
    off_centre = abs(turn(true, step * round(true / step)))
    return off_centre < step / 2 - 1 and round(view / step) % (360 / step) != round(true / step) % (360 / step)


def tape_mm(view, truth, target):
    """How far the camera is from where its place on the floor was measured; None where it was not."""
    if not truth.get("measured_field_mm"):
        return None
    azimuth, pitch = np.radians(view[:2])
    place = target + view[2] * np.array([np.cos(pitch) * np.cos(azimuth), np.cos(pitch) * np.sin(azimuth), np.sin(pitch)])
    place = np.array(truth["A"]) @ place + truth["o"]
    return float(np.linalg.norm((place - np.array([*truth["measured_field_mm"][:2], 0]))[:2]))


def row(name, program, answers, truth_sigma):
    """A line of the table, from (answer, truth, bin step, target) of each photo."""
    located = [(a[0], a[1], *rest) for a, *rest in answers if not isinstance(a, str)]
    off = [[abs(turn(v[0], t["view"][0])), abs(v[1] - t["view"][1]), abs(v[2] - t["view"][2])] for v, _, t, *_ in located]
    angles = [max(o[:2]) for o in off]
    taped = [mm for v, _, t, _, target in located if (mm := tape_mm(v, t, target)) is not None]
    wrong = sum(is_in_wrong_bin(v[0], t["view"][0], step) for v, _, t, step, _ in located)
    within = "–"
    if program == "scaleproof":
        true = [truth_sigma[0], truth_sigma[0], truth_sigma[1]]
        sigmas = [o / np.hypot(s, t) for offs, (_, sigma, *_) in zip(off, located) for o, s, t in zip(offs, sigma, true)]
        within = " / ".join(f"{100 * np.mean([s <= k for s in sigmas]):.0f} %" for k in [1, 2, 3])
    refused = Counter(a for a, *_ in answers if isinstance(a, str))
    pair = lambda values, digits: f"{statistics.median(values):.{digits}f} / {max(values):.{digits}f}" if values else "–"
    cells = [
        name,
        program,
        f"{len(located)} of {len(answers)}",
        pair(angles, 2),
        pair([o[2] for o in off], 0),
        pair(taped, 0),
        f"{sum(a > 3 for a in angles)}, {wrong}",
        within,
        ", ".join(f"{count} `{code}`" for code, count in refused.most_common()) or "none",
    ]
    return "| " + " | ".join(cells) + " |"


def table(photos, program):
    print("| set | program | answered | azimuth or pitch, °: median / worst | distance, mm | from the tape, mm | off by more than 3°, in a wrong bin | errors within 1 / 2 / 3 σ | refused |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, sigma in TRUTH_SIGMA.items():
        by_scene = photos_of(photos / name)
        for who in ["scaleproof", *PEERS]:
            answers = []
            for scene, entries in by_scene.items():
                paths = [path for path, _ in entries]
                found = ours(program, scene, paths) if who == "scaleproof" else theirs(PEERS[who], scene, paths)
                told = tomllib.loads(scene.read_text())
                target = tags(told)[1]
                answers += [(a, t, told["bins"]["azimuth_deg"], target) for a, (_, t) in zip(found, entries)]
            print(row(name, who, answers, sigma))
    print()
    grid(photos / "aprilgrid", program)


def sigma(charts, _):
    """A row a material, a column a number of tags: shares over azimuth, pitch and distance, the poses, and the wrong ones of the bins that were sure."""
    rows = json.loads((charts / "sigma.json").read_text())["rows"]
    print("| errors within 1 / 2 / 3 σ, % (poses of views; wrong of the bins stated with 99 % or more) | one tag | two tags | three tags | four or more |")
    print("|---|---|---|---|---|")
    print("| normal errors" + " | 68 / 95 / 99.7" * 4 + " |")
    for material in dict.fromkeys(row["material"] for row in rows):
        cells = ["–"] * 4
        for row in (row for row in rows if row["material"] == material and row["answered"]):
            shares = [np.mean([row[key][i]["met"] for key in ["azimuth", "pitch", "distance"]]) for i in [1, 3, 5]]
            wrong = f"{row['wrong_sure_bins']} of {row['sure_bins']}"
            cells[row["tags"] - 1] = " / ".join(f"{100 * share:.0f}" for share in shares) + f" ({row['answered']} of {row['views']}; {wrong})"
        print(f"| {material} | " + " | ".join(cells) + " |")


def grid(folder, program):
    """Corners found of a Kalibr board of 36 tags, in photos without truth, and the focal length that `calibrate` takes from them."""
    photos = sorted(folder.glob("*.jpg"))
    with tempfile.TemporaryDirectory() as work:
        command = [program, "calibrate", *photos, "--board", folder / "board.toml", "-o", Path(work) / "camera.yaml", "--json", "--quiet"]
        found = json.loads(subprocess.run(command, capture_output=True, text=True).stdout)
    corners = {photo["file"]: photo["corners"] for photo in found["photos"]}
    read = {"scaleproof calibrate": [corners.get(photo.name, 0) for photo in photos]}
    for who, name in PEERS.items():
        greys = (cv2.imread(str(photo), cv2.IMREAD_GRAYSCALE) for photo in photos)
        read[who.split(" +")[0]] = [4 * len({i for i, _ in finder(name)(grey) if i < 36}) for grey in greys]
    print("| aprilgrid: corners of 144 | " + " | ".join(photo.stem for photo in photos) + " |")
    print("|---" * (len(photos) + 1) + "|")
    for who, counts in read.items():
        print(f"| {who} | " + " | ".join(map(str, counts)) + " |")
    diagonal = np.hypot(found["image_width_px"], found["image_height_px"])
    exif = 24 / np.hypot(36, 24) * diagonal
    print(f"\nFocal length {found['fx_px']:.0f} ± {found['fx_sigma_px']:.0f} px; by EXIF (24 mm, rounded: ± 2 %) {exif:.0f} px.")


if __name__ == "__main__":
    what, photos, other = sys.argv[1:]
    photos, other = Path(photos).resolve(), Path(other).resolve()
    {"sessions": sessions, "sigma": sigma, "table": table}[what](photos, other)
    sys.stdout.flush()
    os._exit(0)
