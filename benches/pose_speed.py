"""What benches/pose_speed.sh measures scaleproof against: tags by C AprilTag or OpenCV, pose by SQPnP and Levenberg-Marquardt.

    pose_speed.py make SESSION FOLDER             the sets of photos
    pose_speed.py locate SESSION PHOTOS DETECTOR  one JSON object a line; apriltag-1, apriltag-2 (decimate) or aruco
    pose_speed.py table SESSION FOLDER            medians, ratios, and what was answered
"""

import json
import shutil
import statistics
import sys
import tomllib
from collections import defaultdict
from pathlib import Path

import cv2
import numpy as np

COPIES = 3


def stored(session):
    """The sixteen photos that the figures are of: the plain model and the random pattern."""
    return sorted([*session.glob("normal_*.jpg"), *session.glob("random_*.jpg")])


def make(session, folder):
    for name in ["clean", "large", "spoiled"]:
        (folder / name).mkdir(parents=True, exist_ok=True)
    for photo in stored(session):
        picture = cv2.imread(str(photo))
        large = cv2.resize(picture, (4000, 3000), interpolation=cv2.INTER_CUBIC)
        for copy in range(COPIES):
            shutil.copy(photo, folder / "clean" / f"{copy}_{photo.name}")
        cv2.imwrite(str(folder / "large" / f"0_{photo.name}"), large, [cv2.IMWRITE_JPEG_QUALITY, 92])
    for seed in range(1, COPIES + 1):
        spoil(session, folder / "spoiled", seed)


def spoil(session, folder, seed):
    """Four copies of each photo, each spoiled in one way by a random amount."""
    rng = np.random.default_rng(seed)
    for photo in stored(session):
        whole = cv2.imread(str(photo)).astype(np.float32)
        for copy in range(4):
            kind = WAYS[rng.integers(len(WAYS))]
            picture = np.clip(kind(whole, rng), 0, 255).astype(np.uint8)
            quality = int(rng.integers(40, 92))
            cv2.imwrite(str(folder / f"{seed}{copy}_{photo.name}"), picture, [cv2.IMWRITE_JPEG_QUALITY, quality])


def blurred(picture, rng):
    return cv2.GaussianBlur(picture, (0, 0), rng.uniform(1, 6))


def moved(picture, rng):
    length = int(rng.integers(5, 45))
    kernel = np.zeros((length, length), np.float32)
    kernel[length // 2] = 1
    turn = cv2.getRotationMatrix2D((length / 2, length / 2), rng.uniform(0, 180), 1)
    kernel = cv2.warpAffine(kernel, turn, (length, length))
    return cv2.filter2D(picture, -1, kernel / kernel.sum())


def dark(picture, rng):
    return picture * rng.uniform(0.02, 0.25) + rng.normal(0, 4, picture.shape)


def noisy(picture, rng):
    return picture + rng.normal(0, rng.uniform(15, 70), picture.shape)


def small(picture, rng):
    scale = rng.uniform(0.12, 0.5)
    # A share instead of sizes in whole pixels: the copy is enlarged by up to 0.3 %, as by another focal length, and pose doubt has to hold it.
    reduced = cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    return cv2.resize(reduced, picture.shape[1::-1], interpolation=cv2.INTER_LINEAR)


def window(picture, rng):
    height, width = picture.shape[:2]
    w, h = int(width * rng.uniform(0.12, 0.4)), int(height * rng.uniform(0.12, 0.4))
    x, y = int(rng.uniform(0, width - w)), int(rng.uniform(0.35 * height, height - h))
    cut = np.full_like(picture, 100)
    cut[y : y + h, x : x + w] = picture[y : y + h, x : x + w]
    return cut


def covered(picture, rng):
    picture = picture.copy()
    height, width = picture.shape[:2]
    for _ in range(int(rng.integers(10, 40))):
        centre = (int(rng.uniform(0, width)), int(rng.uniform(0.3 * height, height)))
        cv2.circle(picture, centre, int(rng.uniform(15, 90)), tuple(map(float, rng.uniform(0, 255, 3))), -1)
    return picture


WAYS = [blurred, moved, dark, noisy, small, window, covered]


def finder(name, family="36h11"):
    """Grey image to (id, corners in the order top-left, top-right, bottom-right, bottom-left)."""
    if name == "aruco":
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
        dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_APRILTAG_{family}"))
        detector = cv2.aruco.ArucoDetector(dictionary, parameters)

        def find(grey):
            corners, ids, _ = detector.detectMarkers(grey)
            # Its images of AprilTags are turned by 180°.
            pairs = [] if ids is None else zip(ids.ravel(), corners)
            return [(int(i), c.reshape(4, 2)[[2, 3, 0, 1]]) for i, c in pairs]

        return find
    from pupil_apriltags import Detector

    detector = Detector(f"tag{family}", nthreads=1, quad_decimate=float(name.split("-")[1]))
    sure = lambda d: d.hamming <= 1 and d.decision_margin > 20
    return lambda grey: [(d.tag_id, d.corners[::-1] - 0.5) for d in detector.detect(grey) if sure(d)]


def camera(path):
    """Matrix, distortion and image width of OpenCV's camera file."""
    stored = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    matrix, lens = (stored.getNode(n).mat() for n in ["camera_matrix", "distortion_coefficients"])
    return matrix, lens, stored.getNode("image_width").real()


def tags(scene):
    """Corners of a scene's tags by id, mm, and the point that viewpoints are seen from."""
    corners = {}
    for tag in scene["tag"]:
        centre, right, up = (np.array(tag[k]) for k in ["centre_mm", "right", "up"])
        half = tag["size_mm"] / 2
        corners[tag["id"]] = centre + half * np.array([up - right, up + right, right - up, -right - up])
    return corners, np.array([0, 0, scene["model"]["size_mm"][2] / 2])


def from_target(seen, matrix, lens, target):
    """Where the camera stands from the target, mm, by pairs of corners (mm, px): SQPnP and Levenberg-Marquardt."""
    points, pixels = (np.concatenate(side).astype(float) for side in zip(*seen))
    _, turn, shift = cv2.solvePnP(points, pixels, matrix, lens, flags=cv2.SOLVEPNP_SQPNP)
    turn, shift = cv2.solvePnPRefineLM(points, pixels, matrix, lens, turn, shift)
    return -cv2.Rodrigues(turn)[0].T @ shift.ravel() - target


def locate(session, photos, name):
    cv2.setNumThreads(1)
    matrix, lens, width = camera(session / "camera.yaml")
    corners, target = tags(tomllib.loads((session / "scene.toml").read_text()))
    find = finder(name)
    for photo in sorted(photos.glob("*.jpg")):
        grey = cv2.imread(str(photo), cv2.IMREAD_GRAYSCALE)
        scale = grey.shape[1] / width
        scaled = np.diag([scale, scale, 1]) @ matrix
        scaled[:2, 2] += (scale - 1) / 2
        seen = [(corners[i], c) for i, c in find(grey) if i in corners]
        line = {"file": photo.name, "status": "abstained"}
        if seen:
            view = from_target(seen, scaled, lens, target)
            line |= {"status": "located", "azimuth_deg": float(np.degrees(np.arctan2(view[1], view[0])) % 360)}
        print(json.dumps(line))


def table(session, folder):
    times = defaultdict(lambda: defaultdict(list))
    for line in (folder / "times.txt").read_text().splitlines():
        photos, name, ms = line.split()
        times[photos][name].append(float(ms))
    truth = {p["file"]: p["azimuth_deg"] for p in json.loads((session / "truth.json").read_text())["photos"]}
    for photos, programs in times.items():
        ours = statistics.median(programs["cascade"])
        for name, ms in programs.items():
            lines = [json.loads(line) for line in (folder / f"{photos}.{name}.json").read_text().splitlines()]
            located = [line for line in lines if line["status"] == "located"]
            off = [abs((line["azimuth_deg"] - truth[Path(line["file"]).name.split("_", 1)[1]] + 180) % 360 - 180) for line in located]
            median, worst = (statistics.median(off), max(off)) if off else (0, 0)
            print(
                f"{photos:<8} {name:<15} {statistics.median(ms):7.1f} ms a photo, {statistics.median(ms) / ours:5.2f} of ours; "
                f"{len(located)} of {len(lines)} answered, azimuth off {median:.4f}° in the middle, {worst:.2f}° at worst, "
                f"{sum(o > 5 for o in off)} by more than 5°"
            )


if __name__ == "__main__":
    what, session, folder, *rest = sys.argv[1:]
    {"make": make, "locate": locate, "table": table}[what](Path(session), Path(folder), *rest)
