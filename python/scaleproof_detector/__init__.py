"""Lets scaleproof score a detector that is written in Python.

Import this first: from then on, what is printed goes to standard error, since standard output belongs to the protocol.
docs/guide/detector-programs.md describes that.
"""

import json
import math
import os
import sys

__all__ = ["run"]

PROTOCOL = 1

# The protocol keeps the standard output that this process was started with; everybody else gets standard error for it.
_answers = os.fdopen(os.dup(1), "wb")
os.dup2(2, 1)


def run(
    detect,
    *,
    name,
    version,
    labels,
    input="rgb",
    files=(),
    deterministic=False,
    workers=1,
    title=None,
    licence=None,
    origin=None,
):
    """Answers until scaleproof closes standard input.

    detect(image) gets an array of height × width × 3 bytes, red first, upright, or with input="path" the path of the photo's file, which it
    turns as EXIF says. It returns or yields (label, confidence, (left, top, right, bottom)) for each box, in pixels of the upright photo: label
    is a name or a number from 0, and the box may be any sequence of four numbers. Give all boxes from confidence 0.001 up. What it raises
    leaves the photo out, with the exception as the reason.

    labels is "coco80", "coco91" (numbers are COCO's category ids), "voc20" or a list of names. version is a line for the report. files are those
    that the answers depend on, such as weights; their hashes are kept. With deterministic=True answers are kept from run to run. workers is
    how many of this program may run side by side.
    """
    hello = {
        "scaleproof_detector": PROTOCOL,
        "name": name,
        "version": version,
        "labels": labels if isinstance(labels, str) else list(labels),
        "input": input,
        "files": [os.fspath(file) for file in files],
        "deterministic": deterministic,
        "workers": workers,
    }
    about = {"title": title, "licence": licence, "origin": origin}
    _say({**hello, **{key: text for key, text in about.items() if text is not None}})
    requests = sys.stdin.buffer
    for line in iter(requests.readline, b""):
        request = json.loads(line)
        image = _pixels(request, requests) if "bytes" in request else request["path"]
        try:
            answer = {"detections": [_plain(*found) for found in detect(image)]}
        except Exception as error:
            answer = {"error": f"{type(error).__name__}: {error}"}
        _say({"id": request["id"], **answer})


def _pixels(request, requests):
    import numpy

    data = requests.read(request["bytes"])
    return numpy.frombuffer(data, numpy.uint8).reshape(request["height"], request["width"], 3)


def _plain(label, score, box):
    """Numbers of any library as Python's own."""
    label = label if isinstance(label, str) else int(label)
    numbers = [float(score), *(float(number) for number in box)]
    if len(numbers) != 5 or not all(math.isfinite(number) for number in numbers):
        raise ValueError(f"a box is not four finite numbers with a finite confidence: {numbers[1:]}, {numbers[0]}")
    return {"label": label, "score": numbers[0], "box": numbers[1:]}


def _say(message):
    _answers.write(json.dumps(message).encode() + b"\n")
    _answers.flush()
