"""What the Python module costs beside the program: `score` with a function against the built-in network, `locate_many` against `locate`.

    python benches/python_overhead.py SESSION WEIGHTS [--threads 2] [--rounds 5]

SESSION is a folder with a session.json (benches/score_12_megapixels.sh makes one of 12-megapixel photos, FOLDER/tags); WEIGHTS has yolox_nano.onnx.
Python has the wheel of `./run wheel`, onnxruntime and opencv-python-headless. The function is that of python/examples/score_a_function.py. Both ways
take turns; medians of the rounds are printed, and whether the answers are the same.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "python" / "examples"))

import scaleproof
from score_a_function import Yolox


def seconds(work: Callable[[], object]) -> tuple[float, float, object]:
    """Wall time, processor time with that of children, and what the work gives."""
    before, start = os.times(), time.perf_counter()
    given = work()
    wall, after = time.perf_counter() - start, os.times()
    return wall, sum(after[:4]) - sum(before[:4]), given


def turns(name: str, ways: dict[str, Callable[[], object]], rounds: int) -> list[object]:
    taken: dict[str, list[tuple[float, float]]] = {way: [] for way in ways}
    for _ in range(rounds):
        given = []
        for way, work in ways.items():
            *times, result = seconds(work)
            taken[way].append(tuple(times))
            given.append(result)
    medians = {way: [statistics.median(one[i] for one in times) for i in (0, 1)] for way, times in taken.items()}
    for way, (wall, processor) in medians.items():
        print(f"{name}: {way:<24} {wall:7.3f} s of wall time  {processor:7.3f} s of processor time")
    first, second = medians.values()
    print(f"{name}: ratio {second[0] / first[0]:.3f} (wall), {second[1] / first[1]:.3f} (processor)")
    return given


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("session", type=Path)
    asked.add_argument("weights", type=Path)
    asked.add_argument("--threads", type=int, default=2)
    asked.add_argument("--rounds", type=int, default=5)
    options = asked.parse_args()
    weights, threads = options.weights / "yolox_nano.onnx", options.threads

    def score(detector: object) -> scaleproof.Scores:
        with tempfile.TemporaryDirectory() as cache:
            return scaleproof.score(options.session, detector, weights=options.weights, threads=threads, cache=cache, progress=False)

    function = scaleproof.Detector(Yolox(str(weights)), "yolox", deterministic=True)
    built_in, mine = turns("score", {"built in": lambda: score("yolox_nano"), "a function": lambda: score(function)}, options.rounds)
    for variant in sorted({one.variant for one in built_in.summaries}):
        both = [scores.summary(name, variant).overall for scores, name in ((built_in, "yolox_nano"), (mine, "yolox"))]
        print(f"score: {variant}: AP@0.5 {both[0].ap50:.4f} and {both[1].ap50:.4f}")

    files = sorted(str(photo) for photo in options.session.glob("*.jpg"))
    scene, camera = options.session / "scene.toml", options.session / "camera.yaml"
    command = [sys.executable, "-m", "scaleproof", "locate", *files, "--scene", str(scene), "--camera", str(camera), "--json"]
    lines, found = turns(
        "locate",
        {
            "scaleproof locate": lambda: subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False).stdout,
            "locate_many": lambda: scaleproof.locate_many(files, scaleproof.Scene(scene), scaleproof.Camera(camera), threads=threads, progress=False),
        },
        options.rounds,
    )
    theirs = [json.loads(line) for line in lines.splitlines()]
    print(f"locate: the same answers: {theirs == [one.json for one in found]}")


if __name__ == "__main__":
    main()
