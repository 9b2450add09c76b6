"""Commands that write, each killed (SIGKILL) at random moments: what is lost, and what lies there after the next run.

    python kills.py PROGRAM FOLDER [KILLS [COMMAND]]

PROGRAM is scaleproof, built with the attack; FOLDER is made anew. Each command is run to its end twice, which tells its files and which of them are the same
each time. Then it is killed KILLS (20) times, each time after a random share of that time (a run that ends sooner counts as none), and run to its end where the killed
run stopped: its files must be those, and nothing else may lie there; inputs and the files of a finished run must be as they were.
"""

import hashlib
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

program, place = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).absolute()
kills = int(sys.argv[3]) if len(sys.argv) > 3 else 20
home = pathlib.Path(__file__).resolve().parent.parent
# What a command writes goes into the folder `out`.
COMMANDS = {
    "calibrate": "calibrate --board board.toml " + " ".join(f"board/board_{n:02}.jpg" for n in (0, 1, 2, 6, 7, 8, 11, 12)) + " -o out/camera.yaml --report out/camera.html",
    "merge": "merge PARTS -o out/report",
    "print wrap": "print wrap --mesh car.obj --length-mm 440 --pattern p.png --tile-mm 40 --paper a3 -o out/pieces.pdf",
    "texture bake": "texture bake --mesh car.obj --length-mm 440 --pattern p.png --tile-mm 40 --size 2048 -o out/baked.png",
    "session new": "session new out/session normal=photos --scene session/scene.toml --camera session/camera.yaml --copy",
    "session from-video": "session from-video walk/normal.mp4 --scene walk/scene.toml --camera walk/camera.yaml --variant normal --place here -o out/session",
    "score": "score session --recorded --cache out/cache -o out/report",
    "attack run": "attack run frames --detector detectors/scaleproof_car.toml --cells 8 --batch 2 --steps 24 -o out/pattern",
}


def run(command, kill_after=None):
    started = time.monotonic()
    child = subprocess.Popen([program, *command.split()], cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True)
    try:
        _, said = child.communicate(timeout=kill_after)
    except subprocess.TimeoutExpired:
        os.killpg(child.pid, signal.SIGKILL)
        child.communicate()
        return None
    if child.returncode:
        sys.exit(f"{command}: {said.decode()}")
    return time.monotonic() - started


def files(folder):
    found = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in found}


def fill():
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    shutil.copytree(home / "captures/skyline", place / "session")
    shutil.copytree(home / "captures/board", place / "board")
    shutil.copytree(home / "captures/skyline_frames", place / "frames")
    shutil.copytree(home / "detectors", place / "detectors")
    shutil.copytree(home / "captures/walk", place / "walk")
    (place / "photos").mkdir()
    for photo in (place / "session").glob("normal_*.jpg"):
        shutil.copy(photo, place / "photos")
    for name in ["car.obj", "paint.mtl", "ok.png"]:
        shutil.copy(home / "tests/data/cases" / name, place)
    run("pattern random --cells 8 --seed 1 -o p.png")
    run("print board --type charuco --squares 9x7 --square-mm 22 --marker-mm 16 -o board.pdf --definition board.toml")
    for part in (1, 2):
        run(f"score session --recorded --shard {part}/2 -o parts")


def inputs():
    return {name: digest for name, digest in files(place).items() if not name.startswith("out/")}


def faults(command, whole, same, before):
    """What is wrong after a killed run and the next."""
    if any(".partial" in name for name in files(place / "out")):
        time.sleep(10.5)  # a run leaves what is younger than ten seconds: another may be at work on it
    if files(place / "out").keys() != whole.keys():
        run(command)
    after = files(place / "out")
    names = [f"left over: {name}" for name in after.keys() - whole.keys()] + [f"lost: {name}" for name in whole.keys() - after.keys()]
    names += [f"differs: {name}" for name in same if name in after and after[name] != whole[name]]
    return names + ([] if inputs() == before else ["an input changed"])


def main():
    fill()
    rng, failed = random.Random(1), 0
    print("| command | whole run, s | kills before its end | files, the same each time | wrong after the next run |\n|---|---|---|---|---|")
    for name, command in COMMANDS.items():
        command = command.replace("PARTS", " ".join(f"parts/{path.name}" for path in sorted((place / "parts").iterdir())))
        if len(sys.argv) > 4 and sys.argv[4] != name:
            continue
        before, runs, seconds = inputs(), [], 0
        for _ in range(2):
            shutil.rmtree(place / "out", ignore_errors=True)
            (place / "out").mkdir()
            seconds = run(command)
            runs.append(files(place / "out"))
        whole, same = runs[1], [path for path, digest in runs[1].items() if runs[0].get(path) == digest]
        killed, tries, wrong = 0, 0, []
        while killed < kills:
            shutil.rmtree(place / "out")
            (place / "out").mkdir()
            tries += 1
            killed += run(command, rng.random() * seconds) is None
            wrong += faults(command, whole, same, before)
        failed += len(wrong)
        print(f"| `{name}` | {seconds:.1f} | {killed} of {tries} | {len(whole)}, {len(same)} | {'; '.join(sorted(set(wrong))) or 'nothing'} |", flush=True)
    sys.exit(1 if failed else 0)


main()
