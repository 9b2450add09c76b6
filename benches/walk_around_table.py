"""What benches/walk_around.sh found: FOLDER/table.md, FOLDER/camera.md and FOLDER/chart.svg from the videos' sessions and the renderer's truth.

    walk_around_table.py FOLDER
    walk_around_table.py FOLDER TRUTH.json    the frames that `session from-video` kept in one folder of a session, against the truth, as one row
"""

import json
import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

NUMBERS = ("azimuth_deg", "pitch_deg", "distance_mm")


def frames_of(session):
    """Each kept frame: number, viewpoint, sigma."""
    for sidecar in sorted(Path(session).rglob("*.capture.json")):
        kept = json.loads(sidecar.read_text())
        yield kept["photo"]["frame"]["number"], kept["viewpoint"], kept["sigma"]


def errors(session, truth):
    """Error and sigma of azimuth, pitch and distance, a row a frame, and the truth's blur and shear in px."""
    rows = []
    for number, viewpoint, sigma in frames_of(session):
        true = truth["frames"][number]
        off = [viewpoint[key] - true[key] for key in NUMBERS]
        off[0] = (off[0] + 180) % 360 - 180
        rows.append([*off, *(sigma[key] for key in NUMBERS), true["blur_px"], true["shear_px"]])
    return np.array(rows).reshape(-1, 8)


def is_blurred_beside(number, truth):
    """Whether a frame is smeared over more than 1.5 px although a sharper one is within 5 degrees."""
    here = truth["frames"][number]
    turn = lambda other: abs((other["azimuth_deg"] - here["azimuth_deg"] + 180) % 360 - 180)
    return here["blur_px"] > 1.5 and any(other["blur_px"] < here["blur_px"] and turn(other) <= 5 for other in truth["frames"])


def row(folder, truth):
    """What was kept: frames, azimuth error, what sigma says of it, smear."""
    rows = errors(folder, truth)
    off, sigma = np.abs(rows[:, 0]), rows[:, 3]
    within = ", ".join(str(int(np.sum(off < k * sigma))) for k in (1, 2, 3))
    beside = sum(is_blurred_beside(number, truth) for number, *_ in frames_of(folder))
    return f"| {len(rows)} | {np.sqrt(np.mean(off**2)):.3f}° / {off.max():.3f}° | {within} | {rows[:, 6].max():.1f} px | {beside} |"


def label(name):
    exposure, readout, rate = re.fullmatch(r"blur_(\d+)_shutter_(\d+)_([\d.]+)M", name).groups()
    return f"{exposure} ms, {readout} ms, {rate} Mbit/s"


def table(found, answers):
    lines = ["| exposure, read-out, bit rate | frames located | fit as photos | kept | azimuth error, median / 95 % | sigma of azimuth, median | azimuth within 1, 2, 3 sigma | pitch, distance within 2 sigma |", "|---|---|---|---|---|---|---|---|"]
    for name, rows in found.items():
        answer = answers[name]
        counts = f"| {label(name)} | {answer['located']} of {answer['frames']} | {answer['fit']} | {len(rows)} "
        if not len(rows):
            lines.append(counts + "| – | – | – | – |")
            continue
        off, sigma = np.abs(rows[:, :3]), rows[:, 3:6]
        within = [100 * np.mean(off[:, 0] < k * sigma[:, 0]) for k in (1, 2, 3)]
        others = [100 * np.mean(off[:, i] < 2 * sigma[:, i]) for i in (1, 2)]
        lines.append(
            counts + f"| {np.median(off[:, 0]):.3f}° / {np.quantile(off[:, 0], 0.95):.3f}° | {np.median(sigma[:, 0]):.3f}° "
            f"| {within[0]:.0f}, {within[1]:.0f}, {within[2]:.0f} % | {others[0]:.0f}, {others[1]:.0f} % |"
        )
    return "\n".join(lines) + "\n"


def cameras(folder, names):
    lines = ["| exposure, read-out, bit rate | focal length, px (truth) | principal point, px (truth) | k1 (truth) |", "|---|---|---|---|"]
    for name in names:
        text = (folder / f"{name.rsplit('_', 1)[0]}.camera.yaml").read_text()
        (fx, _, cx, _, _, cy, *_), (k1, *_) = ([float(v) for v in data.split(",")] for data in re.findall(r"data: \[ (.*?) \]", text))
        answer = (folder / f"{name}.camera.json").read_text()
        if not answer:
            lines.append(f"| {label(name)} | {(folder / f'{name}.camera.txt').read_text().strip().splitlines()[-1]} | | |")
            continue
        c = json.loads(answer)
        lines.append(
            f"| {label(name)} | {c['fx_px']:.1f} ± {c['fx_sigma_px']:.1f} ({fx:.1f}) | {c['cx_px']:.1f} ± {c['cx_sigma_px']:.1f}, {c['cy_px']:.1f} ± {c['cy_sigma_px']:.1f} ({cx:.1f}, {cy:.1f}) "
            f"| {c['distortion'][0]:.4f} ± {c['distortion_sigma'][0]:.4f} ({k1}) |"
        )
    return "\n".join(lines) + "\n"


def chart(found, answers, path):
    figure, (error, share) = plt.subplots(1, 2, figsize=(10, 0.55 * len(found) + 1.6), sharey=True)
    places = np.arange(len(found))
    for place, rows in zip(places, found.values()):
        if len(rows):
            off, sigma = np.abs(rows[:, 0]), rows[:, 3]
            error.plot(np.quantile(off, [0.05, 0.95]), [place] * 2, color="#555", lw=2)
            error.plot(np.median(off), place, "o", color="#000")
            error.plot(np.median(sigma), place, "|", color="#c33", ms=14, mew=2)
    error.set(xscale="log", xlabel="error of the azimuth, degrees: median, 5 to 95 %; red: median of sigma")
    share.barh(places, [100 * a["located"] / a["frames"] for a in answers.values()], color="#ccc", label="located")
    share.barh(places, [100 * a["fit"] / a["frames"] for a in answers.values()], color="#555", height=0.4, label="fit as photos")
    share.barh(places, [100 * len(found[name]) / a["frames"] for name, a in answers.items()], color="#000", height=0.15, label="kept")
    share.set(xlabel="frames, %", xlim=(0, 100))
    share.legend(loc="lower right")
    error.set_yticks(places, [label(name) for name in found])
    error.invert_yaxis()
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def main(folder):
    folder = Path(folder)
    by_numbers = lambda path: [float(number) for number in re.findall(r"[\d.]+", path.stem)]
    answers = {path.stem: json.loads(path.read_text() or "{}") for path in sorted(folder.glob("blur_*M.json"), key=by_numbers)}
    empty = {"located": 0, "frames": 1, "fit": 0}
    answers = {name: {**empty, **answer} for name, answer in answers.items()}
    found = {}
    for name in answers:
        truth = json.loads((folder / f"{name.rsplit('_', 1)[0]}.truth.json").read_text())
        found[name] = errors(folder / f"{name}.session", truth)
    (folder / "table.md").write_text(table(found, answers))
    (folder / "camera.md").write_text(cameras(folder, found))
    chart(found, answers, folder / "chart.svg")
    print(table(found, answers), cameras(folder, found), sep="\n")


if __name__ == "__main__":
    if len(sys.argv) > 2:
        print("| kept | azimuth error, rms / worst | within 1, 2, 3 sigma | most smeared | smeared over 1.5 px with a sharper one within 5 degrees |", "|---|---|---|---|---|", sep="\n")
        print(row(sys.argv[1], json.loads(Path(sys.argv[2]).read_text())))
    else:
        main(sys.argv[1])
