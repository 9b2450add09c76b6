"""The package as a user meets it, on the stored photos and frames, against the program."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy
import pytest

import scaleproof
from scaleproof import _process

HOME = Path(__file__).parents[2]
STORED = HOME / "captures/skyline"
FRAMES = HOME / "captures/skyline_frames"

# A shell's background processes are started deaf to Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)


def two_textures(folder):
    """The stored session without its third texture: the sixteen photos that the figures of these tests are of."""
    shutil.copytree(STORED, folder, ignore=shutil.ignore_patterns("two_targets_*"))
    session = json.loads((STORED / "session.json").read_text())
    session["photos"] = [photo for photo in session["photos"] if photo["variant"] != "two_targets"]
    (folder / "session.json").write_text(json.dumps(session))
    return folder


KEPT = tempfile.TemporaryDirectory()
SKYLINE = two_textures(Path(KEPT.name) / "skyline")


def program(*words):
    return subprocess.run([sys.executable, "-m", "scaleproof", *map(str, words)], capture_output=True, text=True)


@pytest.fixture(scope="module")
def scene():
    return scaleproof.Scene(SKYLINE / "scene.toml")


@pytest.fixture(scope="module")
def camera():
    return scaleproof.Camera(SKYLINE / "camera.yaml")


def test_the_program_is_in_the_package():
    assert program("--version").stdout == f"scaleproof {scaleproof.__version__}\n"
    wrong = program("locate", "a.jpg")
    assert wrong.returncode == 2 and wrong.stderr.startswith("error: ") and not wrong.stdout


def test_photos_are_located_as_by_the_program(scene, camera):
    photos = sorted(SKYLINE.glob("*.jpg"))
    by_program = program("locate", *photos, "--scene", scene.file, "--camera", camera.file, "--json").stdout.splitlines()
    found = scaleproof.locate_many(photos, scene, camera, progress=False)
    assert [one.json for one in found] == [json.loads(line) for line in by_program] and len(found) == 16
    one = scaleproof.locate(photos[0], scene, camera)
    assert one and one.pose.shape == (4, 4) and one.bin == (0.0, 15.0, 850.0) and 0 < one.sigma_azimuth_deg < 0.1
    # The camera's centre is where the viewpoint says: from the model's middle, in the model frame.
    centre = -one.pose[:3, :3].T @ one.pose[:3, 3]
    assert abs(numpy.degrees(numpy.arctan2(centre[1], centre[0])) % 360 - one.azimuth_deg) < 1.0


def test_the_truth_box_is_that_of_the_report(scene, camera):
    pose = scaleproof.locate(SKYLINE / "normal_000.jpg", scene, camera).pose
    row = scaleproof.score(SKYLINE, "yolox_nano", recorded=True).photos.rows()[0]
    expected = [row[f"truth_{side}_px"] for side in ("x1", "y1", "x2", "y2")]
    assert numpy.allclose(scaleproof.truth_box(scene, pose, camera), expected, atol=1e-6)


def test_an_image_without_tags_has_no_pose_and_says_why(scene, camera):
    found = scaleproof.locate(numpy.zeros((960, 1280, 3), numpy.uint8), scene, camera)
    assert not found and found.pose is None and found.code and found.reason


@pytest.fixture(scope="module")
def recorded():
    return scaleproof.score(scaleproof.Session(SKYLINE), "yolox_nano", recorded=True, progress=False)


def test_figures_are_those_of_the_program(recorded, tmp_path):
    ran = program("score", SKYLINE, "--recorded", "--detector", "yolox_nano", "-o", tmp_path / "by_program")
    assert ran.returncode == 0, ran.stderr
    recorded.write(tmp_path / "here")
    for name in ("summary.json", "photos.csv", "figures.csv", "table.tex", "report.html"):
        assert (tmp_path / "here" / name).read_bytes() == (tmp_path / "by_program" / name).read_bytes(), name
    assert recorded.to_html() == (tmp_path / "here/report.html").read_text()
    assert recorded.to_latex() == (tmp_path / "here/table.tex").read_text()
    assert recorded.summary("yolox_nano", "normal").overall.hit_rate.count == 6
    assert "<table>" in recorded._repr_html_() and "YOLOX-Nano 416" in str(recorded)


def test_a_function_that_finds_what_is_recorded_has_the_recorded_figures(recorded):
    # Boxes by the photo's number in the session.
    boxes = {}
    for one in json.loads((SKYLINE / "recorded/yolox_nano.json").read_text()):
        left, top, width, height = one["bbox"]
        found = (one["category_id"], one["score"], (left, top, left + width, top + height))
        boxes.setdefault(one["image_id"], []).append(found)
    numbers = iter(range(1, 17))

    def find(images):
        assert images[0].shape == (960, 1280, 3) and images[0].dtype == numpy.uint8
        return [boxes[next(numbers)] for _ in images]

    # One thread takes the photos in their order.
    detector = scaleproof.Detector(find, "replayed", labels="coco91", deterministic=True)
    found = scaleproof.score(SKYLINE, detector, threads=1, progress=False)
    for variant in ("normal", "random"):
        assert found.summary("replayed", variant).overall == recorded.summary("yolox_nano", variant).overall
    (by,) = found.json["provenance"]["detectors"]
    assert by["name"] == "replayed" and by["source"] == "function"


def test_functions_are_called_in_batches_in_the_calling_thread():
    calls = []

    def find(images):
        calls.append((threading.get_ident(), len(images)))
        time.sleep(0.02)
        return ([] for _ in images)

    scaleproof.score(SKYLINE, [scaleproof.Detector(find, "mine", batch=3)], threads=4, progress=False)
    counts = [count for _, count in calls]
    assert {ident for ident, _ in calls} == {threading.get_ident()} and sum(counts) == 16
    assert 1 < max(counts) <= 3


def test_tables_are_read_through_arrow(recorded):
    nanoarrow = pytest.importorskip("nanoarrow")
    for table in (recorded.table, recorded.photos):
        read = nanoarrow.Array(table)
        columns = {field.name: list(read.child(i).iter_py()) for i, field in enumerate(read.schema.fields)}
        assert columns == table.columns
    empty = scaleproof.Table({"a": [None, None], "b": [True, None], "c": [1, None], "d": [0.5, 2]})
    assert list(nanoarrow.Array(empty).iter_py()) == empty.rows()
    for _ in range(100):
        empty.__arrow_c_stream__()
    from scaleproof import tables

    del read
    import gc

    gc.collect()
    assert not tables._kept


def test_a_comparison_and_a_plan():
    scores = scaleproof.score(SKYLINE, "yolox_nano", recorded=True, progress=False)
    found = scores.compare()
    (drop,) = found.drops
    assert (drop.variant, drop.pairs, drop.effect) == ("random", 8, "nothing_shown")
    confidence = {name: [photo["confidence"] or 0 for photo in scores.photos.rows() if photo["variant"] == name] for name in ("normal", "random")}
    assert (drop.base, drop.other) == pytest.approx((sum(confidence["normal"]) / 8, sum(confidence["random"]) / 8))
    assert drop.p > drop.level == 0.05 and drop.json["hit_rate"]["base"] == 0.75
    assert "\\begin{tabular}" in found.to_latex() and len(found.table) == 3
    with pytest.raises(scaleproof.Error, match="did you mean random"):
        scaleproof.compare(SKYLINE, "yolox_nano", recorded=True, progress=False, control="randon")


def test_a_plan_is_that_of_the_program():
    plan = scaleproof.plan(0.2)
    assert (plan.detectors, plan.textures, plan.photos) == (5, 1, 16 * plan.places)
    assert plan.json == _process.answer("plan", "--drop", "0.2") and plan.views <= 8 * plan.places
    more = scaleproof.plan(0.2, SKYLINE, comparisons=(5, 2))
    assert more.json == _process.answer("plan", str(SKYLINE), "--drop", "0.2", "--comparisons", "5x2")
    assert more.json["spread"]["from"] == "paired_photos" and more.photos == 24 * more.places


def test_average_precision_of_boxes():
    truth = [[(0, 0, 10, 10)], [(0, 0, 10, 10)]]
    found = [[(0.9, (0, 0, 10, 10))], [(0.8, (20, 20, 30, 30))]]
    # One of two is found, before a wrong one: recall points 0 to 0.5 have precision 1.
    assert scaleproof.ap(truth, found) == pytest.approx(51 / 101)
    assert scaleproof.ap([[]], [[]]) is None


@pytest.mark.parametrize(
    ("what", "words"),
    [
        (lambda s, c: scaleproof.locate("nowhere.jpg", s, c), "nowhere.jpg"),
        (lambda s, c: scaleproof.locate(numpy.zeros((4, 4, 3)), s, c), "float64"),
        (lambda s, c: scaleproof.locate(numpy.zeros((0, 4, 3), numpy.uint8), s, c), "4 × 0"),
        (lambda s, c: scaleproof.locate(numpy.zeros((4, 4), numpy.uint8), s, c), "shape"),
        (lambda s, c: scaleproof.locate(7, s, c), "7 is no path"),
        (lambda s, c: scaleproof.locate_many("a.jpg", s, c), "list"),
        (lambda s, c: scaleproof.locate("a.jpg", c, s), "scaleproof.Scene"),
        (lambda s, c: scaleproof.locate("a.jpg", s, c, tag_detector="best"), "best"),
        (lambda s, c: scaleproof.Scene("a\0b"), "byte 0"),
        (lambda s, c: scaleproof.locate(b"a.jpg", s, c), "give a str"),
        (lambda s, c: scaleproof.Scene("a\udcff.toml"), "UTF-8"),
        (lambda s, c: scaleproof.score(SKYLINE, []), "no detector is named"),
        (lambda s, c: scaleproof.score(SKYLINE, scaleproof.Detector(lambda images: [], "yolox_nano")), "of the program"),
        (lambda s, c: scaleproof.score(SKYLINE, scaleproof.Detector(lambda images: [], "mine", files=["/dev/zero"])), "not a file"),
        (lambda s, c: scaleproof.ap([[]], [[(float("nan"), (0, 0, 1, 1))]]), "no confidence"),
        (lambda s, c: scaleproof.Scene(SKYLINE / "camera.yaml"), "camera.yaml"),
        (lambda s, c: scaleproof.truth_box(s, numpy.full((4, 4), numpy.nan), c), "rigid motion"),
        (lambda s, c: scaleproof.truth_box(s, numpy.diag([1, 1, -1, 1]), c), "rigid motion"),
        (lambda s, c: scaleproof.ap([[(0, 0, 1, float("nan"))]], [[]]), "no box"),
        (lambda s, c: scaleproof.ap([[]], [[]], definition="mine"), "mine"),
        (lambda s, c: scaleproof.score("nowhere"), "nowhere"),
        (lambda s, c: scaleproof.score(SKYLINE, 7), "no detector"),
        (lambda s, c: scaleproof.score(SKYLINE, "yolox_nan", recorded=True), "yolox_nano"),
        (lambda s, c: scaleproof.score(SKYLINE, "yolox_nano", recorded=True, confidence=2), "0.001 to 1"),
        (lambda s, c: scaleproof.plan(2), "drop"),
        (lambda s, c: scaleproof.Pattern(SKYLINE / "normal_000.jpg"), "normal_000.jpg"),
        (lambda s, c: scaleproof.Pattern.save("p.png", numpy.full((2, 2, 3), numpy.nan)), "0 to 1"),
        (lambda s, c: scaleproof.Pattern.save("nowhere/p.png", numpy.zeros((2, 2, 3)), tile_mm=-1), "tile_mm"),
        (lambda s, c: scaleproof.Frames(SKYLINE), "frames.json"),
        (lambda s, c: scaleproof.Frames(FRAMES).view(99, tile_mm=480), "view 99"),
        (lambda s, c: scaleproof.Frames(FRAMES).view(0, cells=0, tile_mm=480), "0 cells"),
        (lambda s, c: scaleproof.Frames(FRAMES).view(0, tile_mm=480, form="cubic"), "cubic"),
        (lambda s, c: scaleproof.print_template("nowhere.png", "a.pdf", size_mm=(100, 100), tile_mm=50), "nowhere.png"),
    ],
)
def test_bad_input_is_one_sentence(what, words, scene, camera):
    with pytest.raises(scaleproof.Error) as raised:
        what(scene, camera)
    assert words in str(raised.value) and "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("boxes", "words"),
    [
        (None, "returned NoneType"),
        ([[]] * 9, "9 lists"),
        ([[("car", float("nan"), (0, 0, 1, 1))]], "finite"),
        ([[("car", 0.5, (0, 0, 1))]], "four finite"),
        ([[("zeppelin", 0.5, (0, 0, 90, 90))]], "zeppelin"),
        ([[(80, 0.5, (0, 0, 90, 90))]], "80"),
        ([[("car", 5.0, (0, 0, 90, 90))]], "confidence 5"),
        ([[("car", 0.5, (90, 0, 10, 90))]], "left, top, right, bottom"),
        ([["car"]], "for each box"),
        ([[("car", "0.5", (0, 0, 1, 1))]], "for each box"),
        ([[("car", 0.5, {0, 1, 90, 91})]], "for each box"),
        ([{}], "returned dict"),
    ],
)
def test_boxes_that_are_none_end_the_run(boxes, words):
    with pytest.raises(scaleproof.Error, match=words):
        scaleproof.score(SKYLINE, scaleproof.Detector(lambda images: boxes, "mine", batch=1), threads=1, progress=False)


def test_what_a_function_raises_is_the_cause():
    def mine(images):
        raise ValueError("no weights")

    with pytest.raises(scaleproof.Error, match="mine raised ValueError at .*jpg: no weights") as raised:
        scaleproof.score(SKYLINE, mine, progress=False)
    assert isinstance(raised.value.__cause__, ValueError)
    # And the process goes on.
    assert scaleproof.score(SKYLINE, "yolox_nano", recorded=True, progress=False).photos_scored == 16


def test_an_interruption_ends_a_run():
    looked = []

    def interrupted(images):
        os.kill(os.getpid(), signal.SIGINT)
        looked.extend(images)
        return [[] for _ in images]

    with pytest.raises(KeyboardInterrupt):
        scaleproof.score(SKYLINE, interrupted, progress=False)
    assert len(looked) < 16


def test_an_interruption_ends_a_command_that_then_writes_nothing(tmp_path):
    threads = lambda: len(os.listdir("/proc/self/task"))
    # A detector that never answers, and says when it is asked.
    hello = json.dumps({"scaleproof_detector": 1, "name": "mute", "version": "1", "labels": "coco80", "input": "path", "deterministic": True})
    script, asked = tmp_path / "mute.sh", tmp_path / "asked"
    script.write_text(f"echo '{hello}'\nread -r line\n: > '{asked}'\nread -r line\n")
    before = threads()

    def interrupt():
        while not asked.exists():
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        _process.run("score", str(SKYLINE), "--detector", f"exec:sh {script}", "-o", str(tmp_path / "out"))
    while threads() > before:
        time.sleep(0.01)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["asked", "mute.sh"]
    # And the process goes on.
    assert scaleproof.plan(0.3).views > 0


def test_threads_of_python_work_side_by_side(scene, camera):
    photos, found = sorted(SKYLINE.glob("*.jpg"))[:2], {}
    work = lambda photo: found.update({photo: scaleproof.locate(photo, scene, camera)})
    threads = [threading.Thread(target=work, args=(photo,)) for photo in photos]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(found[photo].azimuth_deg == scaleproof.locate(photo, scene, camera).azimuth_deg for photo in photos)


def test_the_renderer_in_numpy_is_the_library_s():
    frames = scaleproof.Frames(FRAMES)
    assert len(frames) == 2
    pattern = numpy.random.default_rng(7).random((16, 16, 3))
    pattern[0, :4] = [0, 1, 0.02]
    light = numpy.where(pattern <= 0.04045, pattern / 12.92, ((pattern + 0.055) / 1.055) ** 2.4)
    for form in ("affine", "quadratic", "affine-curve", "quadratic-curve"):
        view = frames.view(1, tile_mm=480, form=form)
        by_library = numpy.frombuffer(frames._native.render(1, (16, 16), 480.0, form, light.reshape(-1, 3).tolist()))
        image = view.render(pattern)
        assert numpy.abs(image.ravel() - by_library).max() < 1e-9
        assert (view.mask > 0.5).any() and view.background.shape == image.shape == (64, 96, 3)
        # What the model does not cover, the pattern does not change.
        outside = view.mask == 0
        assert numpy.abs(image - view.background)[outside].max() < 0.05


def test_sheets_and_a_camera(tmp_path):
    pattern = scaleproof.Pattern.random(tmp_path / "p.png", cells=4, seed=1)
    made = scaleproof.print_template(pattern, tmp_path / "a.pdf", size_mm=(200, 100), tile_mm=100)
    assert made["sheets"] == 1 and (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")
    wrap = scaleproof.print_wrap(tmp_path / "w.pdf", pattern=pattern, scene=SKYLINE / "scene.toml", panels=True, tile_mm=100)
    assert (tmp_path / "w.pdf").is_file() and wrap["files"]
    camera, about = scaleproof.calibrate(HOME / "captures/board", board=HOME / "calibration/charuco_9x7_22mm.toml", output=tmp_path / "c.yaml")
    assert camera.matrix.shape == (3, 3) and about


def test_a_pattern_is_saved_with_its_card(tmp_path):
    colours = numpy.random.default_rng(1).random((4, 6, 3))
    saved = scaleproof.Pattern.save(tmp_path / "p.png", colours, tile_mm=90, made_by="a test")
    assert (saved.colours == (255 * colours).round()).all() and saved.colours.shape == (4, 6, 3)
    card = json.loads((tmp_path / "p.json").read_text())
    assert (card["pattern_sha256"], card["tile_mm"], card["made_by"]) == (saved.sha256, 90, "a test")
    # The program reads the card.
    assert scaleproof.print_template(saved, tmp_path / "p.pdf", size_mm=(90, 60))["cell_mm"] == 15


def test_the_reference_is_that_of_the_docstrings():
    written = subprocess.run([sys.executable, Path(__file__).with_name("reference.py")], capture_output=True, text=True, check=True).stdout
    assert written == (HOME / "docs/guide/reference/python.md").read_text()


def test_paths_that_look_like_options_are_paths(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "victim.txt").write_text("mine")
    board = HOME / "calibration/charuco_9x7_22mm.toml"
    for name in ["--report=victim.txt", "--help", "-q", "--output=victim.txt"]:
        with pytest.raises(scaleproof.Error):
            scaleproof.calibrate(name, board=board, output="camera.yaml")
        with pytest.raises(scaleproof.Error):
            scaleproof.calibrate([name], board=board, output="camera.yaml")
        with pytest.raises(scaleproof.Error):
            scaleproof.Session(name)
        with pytest.raises(scaleproof.Error):
            scaleproof.score(name, "yolox_nano")
        with pytest.raises(scaleproof.Error):
            scaleproof.plan(0.2, name)
        made = scaleproof.Session.of_folders({name: tmp_path}, scene=SKYLINE / "scene.toml", camera=SKYLINE / "camera.yaml")
        with pytest.raises(scaleproof.Error):
            scaleproof.score(made, "yolox_nano")
    assert (tmp_path / "victim.txt").read_text() == "mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["victim.txt"]


def test_a_pattern_takes_no_photo_s_place(tmp_path: Path) -> None:
    photo = tmp_path / "photo.jpg"
    photo.write_bytes((SKYLINE / "normal_000.jpg").read_bytes())
    with pytest.raises(scaleproof.Error, match="photo.jpg' would hold PNG"):
        scaleproof.Pattern.save(photo, numpy.zeros((4, 4, 3), numpy.uint8))
    assert photo.read_bytes() == (SKYLINE / "normal_000.jpg").read_bytes()
