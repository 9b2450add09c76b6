"""A filmed calibration board: a video file, and the camera that it was rendered with.

    filmed_board.py OUT [--board BOARD.toml] ...

Writes OUT.mp4 and OUT.camera.yaml. The camera stands, and a hand holds the board (a plane) into the parts of the image, tilted each time to another side, and waits there a moment. It shakes
as the hand of walk_around.py. Every row of the image is exposed for `--exposure-ms` and starts later than the row above it (`--readout-ms` in all); each is the mean, in linear light, of
six moments, each at another place within the pixel. Then come noise, sRGB, H.264.

Needs: pip install numpy opencv-python-headless moderngl trimesh scipy (walk_around.py); ffmpeg.
"""

import argparse
import subprocess
import tomllib
from pathlib import Path

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from walk_around import ROOT, Hand, camera_file

MOMENTS = 6  # of one exposure
PX_PER_MM, MARGIN_MM = 5, 12
# Where the board's middle is in the image (shares of its half sides), how far it is tilted and turned (degrees), and how far away it is (mm).
STATIONS = [(0, 0, 0, 0, 0, 330), (-0.45, -0.4, 35, 0, 5, 420), (0.45, -0.4, 0, 38, -8, 420), (0.45, 0.4, -36, 0, 12, 400), (-0.45, 0.4, 0, -38, -4, 420), (0, 0, 30, 30, 20, 360),
            (-0.5, 0, -28, 28, 0, 430), (0.5, 0, -28, -30, -15, 430), (0, -0.4, 40, -10, 0, 400), (0, 0.4, -40, 10, 90, 450)]


class Held:
    """`T_camera_board` at any time: from station to station, each reached and left slowly."""

    def __init__(self, args, camera, size_mm):
        self.args, self.camera, self.size_mm = args, camera, size_mm
        self.hand = Hand(args.seed, args.shake)

    def pose(self, t):
        share = np.clip(t / self.args.seconds, 0, 1) * (len(STATIONS) - 1)
        at = min(int(share), len(STATIONS) - 2)
        way = np.clip((share - at - 0.15) / 0.7, 0, 1)
        x, y, tilt, turn, roll, away = np.array(STATIONS[at]) + (3 * way**2 - 2 * way**3) * np.subtract(STATIONS[at + 1], STATIONS[at])
        shaken, shift = self.hand.at(t)
        rotation = Rotation.from_euler("zyx", [roll, turn, tilt], degrees=True).as_matrix() @ Rotation.from_rotvec(shaken).as_matrix()
        middle = away * np.array([x * self.args.size[0] / 2 / self.camera["fx"], y * self.args.size[1] / 2 / self.camera["fy"], 1]) + shift
        return rotation, middle - rotation @ [self.size_mm[0] / 2, self.size_mm[1] / 2, 0]


def sheet(board):
    """The board's image in linear light, with a white margin; its size in mm."""
    size_mm = board["squares"][0] * board["square_mm"], board["squares"][1] * board["square_mm"]
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, board["dictionary"]))
    drawn = cv2.aruco.CharucoBoard(tuple(board["squares"]), board["square_mm"], board["marker_mm"], dictionary)
    drawn.setLegacyPattern(board["legacy_layout"])
    image = drawn.generateImage(tuple(round(PX_PER_MM * mm) for mm in size_mm), marginSize=0)
    margin = PX_PER_MM * MARGIN_MM
    return np.float32(np.where(cv2.copyMakeBorder(image, *[margin] * 4, cv2.BORDER_CONSTANT, value=255) > 127, 0.8, 0.04)), size_mm


def rays(camera, size):
    """Where each pixel looks, undistorted, with half a pixel's room."""
    v, u = np.mgrid[: size[1], : size[0]].astype(float)
    x = seen_x = (u - camera["cx"]) / camera["fx"]
    y = seen_y = (v - camera["cy"]) / camera["fy"]
    for _ in range(30):
        r2 = x**2 + y**2
        bent = 1 + camera["k1"] * r2 + camera["k2"] * r2**2
        x, y = seen_x / bent, seen_y / bent
    return x.astype(np.float32), y.astype(np.float32)


def frame(image, held, looks, start, random):
    """The image (linear light) whose first row's exposure begins at `start`."""
    args, (x, y) = held.args, looks
    height = args.size[1]
    light = np.zeros((height, args.size[0]), np.float32)
    exposure, readout = args.exposure_ms / 1e3, args.readout_ms / 1e3
    for moment in range(MOMENTS):
        # The motion within the read-out is smooth: poses in between are those of a few rows.
        rows = np.linspace(0, height - 1, 9)
        to_board = []
        for row in rows:
            rotation, shift = held.pose(start + row / height * readout + (moment + 0.5) / MOMENTS * exposure)
            to_board.append(np.linalg.inv(np.column_stack([rotation[:, 0], rotation[:, 1], shift])).ravel())
        m = np.stack([np.interp(np.arange(height), rows, column) for column in np.transpose(to_board)]).astype(np.float32)[:, :, None]
        off = (random.random(2) - 0.5) / [held.camera["fx"], held.camera["fy"]]
        px, py = x + np.float32(off[0]), y + np.float32(off[1])
        w = m[6] * px + m[7] * py + m[8]
        across = ((m[0] * px + m[1] * py + m[2]) / w + MARGIN_MM) * PX_PER_MM - 0.5
        down = ((m[3] * px + m[4] * py + m[5]) / w + MARGIN_MM) * PX_PER_MM - 0.5
        light += cv2.remap(image, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0.25) / MOMENTS
    return light


def main():
    parse = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("out", type=Path)
    parse.add_argument("--board", type=Path, default=ROOT / "calibration/charuco_9x7_22mm.toml")
    parse.add_argument("--size", type=lambda text: tuple(map(int, text.split("x"))), default=(1280, 720))
    parse.add_argument("--fps", type=float, default=30.0)
    parse.add_argument("--seconds", type=float, default=20.0)
    parse.add_argument("--exposure-ms", type=float, default=8.0)
    parse.add_argument("--readout-ms", type=float, default=20.0)
    parse.add_argument("--shake", type=float, default=1.0)
    parse.add_argument("--noise", type=float, default=2.0, help="sigma, levels of 255")
    parse.add_argument("--mbit", type=float, default=10.0)
    parse.add_argument("--seed", type=int, default=1)
    args = parse.parse_args()
    scale, middle = args.size[0] / 1920, [(side - 1) / 2 for side in args.size]
    camera = {"fx": 1420 * scale, "fy": 1420 * scale, "cx": middle[0] + 8.4 * scale, "cy": middle[1] - 5.2 * scale, "k1": -0.06, "k2": 0.02}
    Path(f"{args.out}.camera.yaml").write_text(camera_file(camera, args.size))
    image, size_mm = sheet(tomllib.loads(args.board.read_text()))
    held, looks, random = Held(args, camera, size_mm), rays(camera, args.size), np.random.default_rng(args.seed)
    raw = ["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "gray", "-s", "{}x{}".format(*args.size), "-r", str(args.fps), "-i", "-"]
    film = subprocess.Popen([*raw, "-c:v", "libx264", "-preset", "veryfast", "-pix_fmt", "yuv420p", "-b:v", f"{args.mbit}M", f"{args.out}.mp4"], stdin=subprocess.PIPE)
    for number in range(round(args.seconds * args.fps)):
        light = frame(image, held, looks, number / args.fps, random)
        tone = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.power(np.maximum(light, 1e-6), 1 / 2.4) - 0.055)
        noisy = 255 * tone + args.noise * random.standard_normal(tone.shape, np.float32)
        film.stdin.write(np.clip(np.rint(noisy), 0, 255).astype(np.uint8).tobytes())
    film.stdin.close()
    if film.wait():
        raise SystemExit("ffmpeg failed")


if __name__ == "__main__":
    main()
