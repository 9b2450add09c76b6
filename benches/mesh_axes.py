"""Whether `scene new --mesh` finds front and top of meshes however they lie: each OBJ is turned into all 24 ways, in a random unit.

    mesh_axes.py PROGRAM FRONT,UP=CAR.obj ...        as in +x,+y=p406.obj (the cars of torcs_cars.py) +x,+z=model_save.obj

Prints how often the answer was right, wrong, or a question. Needs NumPy.
"""

import itertools
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

AXES = {sign + letter: (1 if sign == "+" else -1) * np.eye(3)["xyz".index(letter)] for sign in "+-" for letter in "xyz"}


def turns():
    """The 24 rotations that take axes to axes."""
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            turn = np.diag(signs)[list(order)]
            if np.linalg.det(turn) > 0:
                yield turn


def write(lines, turn, unit, path):
    """The OBJ, turned and scaled."""
    with path.open("w") as file:
        for line in lines:
            if line.startswith("v "):
                line = "v {:.6f} {:.6f} {:.6f}".format(*(turn @ [float(v) for v in line.split()[1:4]] * unit))
            if not line.startswith("mtllib"):
                file.write(line + "\n")


def answer(program, mesh):
    """(front, up), or None where it asks."""
    scene = mesh.with_suffix(".toml")
    for old in (scene, scene.with_name(f"{scene.stem}_mesh.png")):
        old.unlink(missing_ok=True)
    done = subprocess.run([program, "scene", "new", "--mesh", mesh, "--length-mm", "457", "--paint", "all", "-o", scene], capture_output=True)
    if done.returncode:
        return None
    text = scene.read_text()
    return tuple(re.search(f'mesh_{key} = "(..)"', text).group(1) for key in ("front", "up"))


def main(program, cars):
    random.seed(1)
    with tempfile.TemporaryDirectory() as folder:
        for car in cars:
            axes, _, path = car.partition("=")
            front, up = (AXES[word] for word in axes.split(","))
            lines = Path(path).read_text().splitlines()
            counts = {"right": 0, "wrong": 0, "asked": 0}
            for turn in turns():
                mesh = Path(folder) / "turned.obj"
                write(lines, turn, random.choice((1, 100, 1000, 0.1)), mesh)
                found = answer(program, mesh)
                right = tuple(next(word for word, axis in AXES.items() if np.allclose(turn @ way, axis)) for way in (front, up))
                counts["asked" if found is None else "right" if found == right else "wrong"] += 1
            print(Path(path).name, counts, flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
