#!/usr/bin/env bash
# How processor time grows: for each row sizes, seconds, and the exponent fitted from the second size on (1 is linear).
#
#   benches/growth.sh [ROW…]
#
# Rows: pieces, slivers, bake, photos, tagless, variants; all when left out. Needs Python 3 with Pillow. Build first, by any ./run command, or name the
# program by SCALEPROOF. Seconds are those of the processor, user and system, of one run each.
set -euo pipefail
home=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
exec python3 - "$home" "${SCALEPROOF:-$home/target/release/scaleproof}" "$@" <<'PYTHON'
import json, math, os, pathlib, shutil, subprocess, sys, tempfile

home, program, names = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3:]
work = pathlib.Path(tempfile.mkdtemp())
pattern = ["--pattern", str(home / "print_templates/random16.png"), "--tile-mm", "118"]
located = ["--scene", str(home / "captures/skyline/scene.toml"), "--camera", str(home / "calibration/skyline.yaml")]


def seconds(*arguments, may_refuse=False):
    before = os.times()
    done = subprocess.run([program, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    after = os.times()
    if done.returncode and not may_refuse:
        sys.exit(f"{' '.join(map(str, arguments))}: {done.stderr.splitlines()[-1]}")
    return after.children_user - before.children_user + after.children_system - before.children_system


def mesh(name, corners, faces):
    lines = ["v %.6f %.6f %.6f" % c for c in corners] + ["f %d %d %d" % f for f in faces]
    (work / name).write_text("\n".join(lines) + "\n")
    return ["--mesh", work / name, "--length-mm", 400, "--mesh-front", "+x", "--mesh-up", "+z"]


def boxes(count):
    """So many cubes that do not touch, each of which becomes pieces of its own."""
    corners, faces = [], []
    for i in range(count):
        at = (2 * (i % 10), 2 * (i // 10), 0)
        first = len(corners) + 1
        corners += [(at[0] + x, at[1] + y, at[2] + z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        faces += [(first + q[a], first + q[b], first + q[c]) for q in quads for a, b, c in [(0, 1, 2), (0, 2, 3)]]
    return mesh(f"boxes_{count}.obj", corners, faces)


def fan(count):
    ring = [(2 * math.cos(2 * math.pi * i / count), math.sin(2 * math.pi * i / count), 0.0) for i in range(count)]
    return mesh(f"fan_{count}.obj", [(0.0, 0.0, 1.0), *ring], [(1, 2 + i, 2 + (i + 1) % count) for i in range(count)])


def filled(folder, count, tagless=False):
    """Copies of the stored photos, or grey ones of noise, each with its own bytes, and a name of its own among all folders."""
    folder.mkdir(parents=True)
    stored = sorted((home / "captures/skyline").glob("normal_*.jpg"))
    if tagless:
        from PIL import Image
        stored = [work / "tagless.jpg"]
        Image.effect_noise((1280, 960), 40).convert("RGB").save(stored[0], quality=90)
    for i in range(count):
        (folder / f"{folder.name}_{i:05}.jpg").write_bytes(stored[i % len(stored)].read_bytes() + str((folder, i)).encode())
    return folder


def results(folders):
    """A detector's list for these photos: a box in the middle of each."""
    photos = [photo for folder in folders for photo in sorted(folder.iterdir())]
    images = [{"id": i, "file_name": photo.name, "width": 1280, "height": 960} for i, photo in enumerate(photos)]
    found = [{"image_id": i, "category_id": 3, "bbox": [400, 300, 480, 360], "score": 0.3 + i % 7 / 10} for i in range(len(photos))]
    (work / "images.json").write_text(json.dumps({"images": images, "annotations": [], "categories": [{"id": 3, "name": "car"}]}))
    (work / "found.json").write_text(json.dumps(found))
    return ["--results", f"given={work}/found.json", "--images", work / "images.json"]


def scored(command, variants, photos, tagless=False):
    root = pathlib.Path(tempfile.mkdtemp(dir=work))
    folders = [filled(root / f"v{v:03}", photos, tagless) for v in range(variants)]
    detector = results(folders)
    named = [f"{folder.name}={folder}" for folder in folders]
    return seconds(command, *named, *located, *detector, "--cache", root / "cache", "-o", root / "out", may_refuse=tagless)


def out(name):
    return ["-o", pathlib.Path(tempfile.mkdtemp(dir=work)) / name]


rows = {
    "pieces": ([8, 16, 32, 64], lambda n: seconds("print", "wrap", *boxes(n), *pattern, "--paper", "a3", "--dpi", 72, "--pieces", 6 * n, *out("w.pdf"))),
    "slivers": ([1250, 2500, 5000, 10000], lambda n: seconds("texture", "bake", *fan(n), *pattern, "--size", 256, *out("b.png"))),
    "bake": ([512, 1024, 2048, 4096], lambda n: seconds("texture", "bake", *boxes(4), *pattern, "--size", n, *out("b.png"))),
    "photos": ([8, 16, 32, 64], lambda n: scored("score", 1, n)),
    "tagless": ([4, 8, 16, 32], lambda n: scored("score", 1, n, tagless=True)),
    "variants": ([10, 20, 40, 80], lambda n: scored("compare", n, 4)),
}
units = {"pieces": "boxes of 6 faces", "slivers": "triangles of a fan, 256² px", "bake": "side, px", "photos": "photos", "tagless": "photos without tags", "variants": "variants of 4 photos"}

print("| | sizes | processor seconds | exponent from the second size on |")
print("|---|---|---|---|")
try:
    for name in names or rows:
        sizes, run = rows[name]
        took = [run(size) for size in sizes]
        # Of pixels, not of the side.
        of = [2 * math.log(s) if name == "bake" else math.log(s) for s in sizes][1:]
        log = [math.log(max(t, 0.01)) for t in took][1:]
        x, y = sum(of) / len(of), sum(log) / len(log)
        exponent = sum((a - x) * (b - y) for a, b in zip(of, log)) / sum((a - x) ** 2 for a in of)
        print(f"| {name} ({units[name]}) | {', '.join(map(str, sizes))} | {', '.join('%.2f' % t for t in took)} | {exponent:.2f} |", flush=True)
finally:
    shutil.rmtree(work)
PYTHON
