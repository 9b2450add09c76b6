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
    loss_and_gradient=None,
    partial_gradient=False,
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

    loss_and_gradient(image, box, labels, least_iou) lets patterns be made against the detector. image has height × width × 3 numbers of 32 bits from
    0 to 1, red first. Of the boxes that overlap box (left, top, right, bottom) with an IoU of least_iou or more, before any suppression, the one with
    the highest confidence C of a label among labels (numbers from 0) counts: it returns −ln(1 − C) and its derivative by each number of the image, an
    array of the image's shape; or None where no box overlaps so much. partial_gradient=True says that the derivative leaves out a part, as that of
    detectors of two stages, whose proposals are detached; only its sign and scale are checked then.
    """
    hello = {
        "scaleproof_detector": PROTOCOL,
        "name": name,
        "version": version,
        "labels": labels if isinstance(labels, str) else list(labels),
        "input": input,
        "files": [os.fspath(file) for file in files],
        "deterministic": deterministic,
        "gradients": loss_and_gradient is not None and ("partial" if partial_gradient else True),
        "workers": workers,
    }
    about = {"title": title, "licence": licence, "origin": origin}
    _say({**hello, **{key: text for key, text in about.items() if text is not None}})
    requests = sys.stdin.buffer
    for line in iter(requests.readline, b""):
        request = json.loads(line)
        differentiates = request["task"] == "loss_and_gradient"
        image = _pixels(request, requests, "<f4" if differentiates else "u1") if "bytes" in request else request["path"]
        data = b""
        try:
            if differentiates:
                answer, data = _loss(loss_and_gradient(image, request["box"], request["labels"], request["least_iou"]))
            else:
                answer = {"detections": [_plain(found) for found in _list(detect(image))]}
        except Exception as error:
            answer = {"error": f"{type(error).__name__}: {error}"}
        _say({"id": request["id"], **answer}, data)


def _pixels(request, requests, kind):
    import numpy

    data = requests.read(request["bytes"])
    return numpy.frombuffer(data, kind).reshape(request["height"], request["width"], 3)


def _loss(found):
    import numpy

    if found is None:
        return {"loss": None}, b""
    loss, gradient = found
    gradient = numpy.ascontiguousarray(gradient, "<f4")
    return {"loss": float(loss), "shape": gradient.shape}, gradient.tobytes()


_FORM = "give (label, confidence, (left, top, right, bottom)) for each box"


def _list(found):
    """What detect returned, unless it cannot be a list of boxes."""
    if isinstance(found, dict):
        keys = ", ".join(map(repr, found))
        raise ValueError(f"detect returned a dict ({keys}): {_FORM}, as zip(d['labels'], d['scores'], d['boxes']) does for torchvision's")
    if found is None:
        raise ValueError(f"detect returned None: {_FORM}, and [] for none")
    return found


def _plain(found):
    """Numbers of any library as Python's own."""
    if isinstance(found, dict):
        raise ValueError(f"a box is a dict ({', '.join(map(repr, found))}): {_FORM}")
    try:
        label, score, box = found
    except (TypeError, ValueError):
        raise ValueError(f"a box is {str(found)[:80]!r}: {_FORM}") from None
    label = label if isinstance(label, str) else int(label)
    numbers = [float(score), *(float(number) for number in box)]
    if len(numbers) != 5 or not all(math.isfinite(number) for number in numbers):
        raise ValueError(f"a box is not four finite numbers with a finite confidence: {numbers[1:]}, {numbers[0]}")
    return {"label": label, "score": numbers[0], "box": numbers[1:]}


def _say(message, data=b""):
    _answers.write(json.dumps(message).encode() + b"\n" + data)
    _answers.flush()
