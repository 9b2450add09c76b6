"""Small Darknet networks with random weights, and what OpenCV's importer makes of them.

pip install opencv-python-headless==4.10.0.84; python make_darknet.py writes NAME.cfg, NAME.weights and expected.json: the rows of the network's
output layers (centre and size as shares of the image, objectness, objectness times label) for the image ((7 i + 3) mod 101) / 100.
"""

import json
import pathlib

import cv2
import numpy as np

HERE = pathlib.Path(__file__).parent
NET = "[net]\nwidth=64\nheight=96\nchannels=3\nbatch=1\n\n"


def conv(filters, size=1, stride=1, activation="leaky", bn=True, groups=1):
    lines = ["[convolutional]"] + (["batch_normalize=1"] if bn else [])
    lines += [f"filters={filters}", f"size={size}", f"stride={stride}", "pad=1"]
    lines += [f"groups={groups}"] if groups > 1 else []
    return "\n".join(lines + [f"activation={activation}", "", ""])


def section(kind, **settings):
    return f"[{kind}]\n" + "".join(f"{k}={v}\n" for k, v in settings.items()) + "\n"


def yolo(mask, anchors, scale=1.0):
    return section("yolo", mask=mask, anchors=anchors, classes=4, num=6, scale_x_y=scale)


ANCHORS = "6,9, 12,10, 18,24, 30,20, 36,60, 60,44"
SMALL = {
    # As YOLOv4-tiny: groups of a route, maxpools, two grids, scale_x_y.
    "tiny_v4": NET + conv(6, 3, 2) + conv(8, 3, 2) + conv(8, 3) + section("route", layers="-1", groups=2, group_id=1) + conv(4, 3)
    + conv(4, 3) + section("route", layers="-1,-2") + conv(8) + section("route", layers="-6,-1")
    + section("maxpool", size=2, stride=2) + conv(12, 3) + section("maxpool", size=2, stride=2) + conv(10)
    + section("maxpool", size=2, stride=2) + conv(10, 3) + conv(27, activation="linear", bn=False)
    + yolo("3,4,5", ANCHORS, 1.05) + section("route", layers="-3") + conv(6) + section("upsample", stride=2)
    + section("route", layers="-1,12") + conv(27, activation="linear", bn=False) + yolo("0,1,2", ANCHORS, 1.05),
    # As YOLOv3 and v4: shortcuts, mish, a pyramid of maxpools, a stride of 1 at the size of 2.
    "v4": NET + conv(6, 3, 2, "mish") + conv(8, 3, 2, "mish") + conv(4, activation="mish") + conv(8, 3, 1, "mish")
    + section("shortcut", **{"from": -3, "activation": "linear"}) + conv(8, 3, 2) + conv(10, 3, 2) + conv(6)
    + section("maxpool", size=5, stride=1) + section("route", layers="-2") + section("maxpool", size=3, stride=1)
    + section("route", layers="-1,-3,-4") + conv(8) + section("maxpool", size=2, stride=1) + conv(10, 3, 2, "swish")
    + conv(27, activation="linear", bn=False) + yolo("3,4,5", ANCHORS, 1.2),
    # As YOLO-Fastest: depthwise convolutions, dropout.
    "fastest": NET + conv(8, 3, 2) + conv(8, 3, 2, "leaky", True, 8) + conv(6, activation="linear") + conv(6)
    + conv(6, 3, 1, "leaky", True, 6) + conv(6, activation="linear") + section("dropout", probability=".15")
    + section("shortcut", **{"from": -5, "activation": "linear"}) + conv(10, 3, 2, "relu") + conv(8, 3, 2)
    + conv(27, activation="linear", bn=False) + yolo("0,1,2", ANCHORS),
}


def weights(cfg, rng):
    """Random weights whose activations stay near 1, in Darknet's order."""
    chunks, shapes = [np.array([0, 2, 5], "<i4").tobytes() + np.array([0], "<i8").tobytes()], []
    for block in cfg.split("[")[1:]:
        kind, body = block.split("]", 1)
        s = dict(line.split("=", 1) for line in body.split("\n") if "=" in line)
        last = shapes[-1] if shapes else 3
        channels = last
        if kind == "convolutional":
            channels, size, groups = int(s["filters"]), int(s["size"]), int(s.get("groups", 1))
            each = last // groups * size * size
            chunks.append(rng.normal(0, 0.3, channels).astype("<f4").tobytes())
            if "batch_normalize" in s:
                for values in (rng.uniform(0.7, 1.4, channels), rng.normal(0, 0.2, channels), rng.uniform(0.5, 1.5, channels)):
                    chunks.append(values.astype("<f4").tobytes())
            chunks.append((rng.normal(0, 1.3, channels * each) / each**0.5).astype("<f4").tobytes())
        elif kind == "route":
            of = [shapes[int(i)] for i in s["layers"].split(",")]
            channels = sum(of) // int(s.get("groups", 1))
        elif kind == "net":
            continue
        shapes.append(channels)
    return b"".join(chunks)


def main():
    rng = np.random.default_rng(42)
    image = ((7 * np.arange(3 * 96 * 64) + 3) % 101 / 100).astype(np.float32).reshape(1, 3, 96, 64)
    expected = {}
    for name, cfg in SMALL.items():
        (HERE / f"{name}.cfg").write_text(cfg)
        (HERE / f"{name}.weights").write_bytes(weights(cfg, rng))
        net = cv2.dnn.readNetFromDarknet(str(HERE / f"{name}.cfg"), str(HERE / f"{name}.weights"))
        net.setInput(image)
        rows = np.concatenate(net.forward(net.getUnconnectedOutLayersNames()))
        expected[name] = [[round(float(v), 6) for v in row] for row in rows]
        print(name, rows.shape, rows[:3])
    (HERE / "expected.json").write_text(json.dumps(expected, separators=(",", ":")) + "\n")


main()
