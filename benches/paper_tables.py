"""The tables of paper_tables.sh, in the layout of the paper, with its figures beside ours.

    paper_tables.py FOLDER                 the tables
    paper_tables.py FOLDER PICTURE.svg     AP@0.5 of the rows on the targets, as bars

FOLDER: that of paper_tables.sh. What has not been judged yet is left out.
"""

import csv
import json
import math
import sys
from pathlib import Path

TITLES = {
    "yolov4_tiny": "YOLOv4-tiny",
    "ssdlite_mobilenet_v2_coco": "SSDLite",
    "yolo_fastest_xl": "YOLO-Fastest",
    "picodet_s_320": "PicoDet",
    "yolox_nano": "YOLOX-nano",
    "nanodet_m": "NanoDet-m",
    "fastestdet": "FastestDet",
    "deimv2_femto": "DEIMv2 femto",
    "deimv2_atto": "DEIMv2 atto",
}
TARGETS = {"yolov4_tiny": "YOLOv4", "ssdlite_mobilenet_v2_coco": "EfficientDet-D0"}
ROWS = {
    "normal": "normal",
    "random": "random",
    "upc": "UPC",
    "das": "DAS",
    "camou": "CAMOU",
    "er": "ER",
    "dta": "DTA, its algorithm",
    "published": "DTA, its published pattern",
    "ours_1": "**ours**, seed 1",
    "ours_2": "**ours**, seed 2",
}
# Suryanto et al., CVPR 2022: AP@0.5 / mean confidence on the targets, AP@0.5 of SSD / Faster R-CNN / Mask R-CNN for the transfer.
PAPER_TARGET = {
    "YOLOv4": {"normal": ".99 / .96", "random": ".89 / .76", "camou": ".81 / .64", "er": ".77 / .60", "dta": ".76 / .57"},
    "EfficientDet-D0": {"normal": ".98 / .75", "random": ".62 / .39", "camou": ".53 / .34", "er": ".46 / .31", "dta": ".34 / .27"},
}
PAPER_TRANSFER = {
    "normal": ".85 / .94 / .94",
    "random": ".52 / .69 / .74",
    "upc": ".66 / .82 / .90",
    "das": ".79 / .89 / .97",
    "camou": ".27 / .55 / .65",
    "er": ".27 / .56 / .64",
    "dta": ".18 / .41 / .56",
}
PAPER_DTN = (0.05929, 0.000673, 0.00620)
NOT_COMPARABLE = """Not comparable with the paper's figures, which stand beside ours for the order of the rows: other networks (YOLOv4-tiny beside YOLOv4,
SSDLite beside EfficientDet-D0, eight others beside SSD, Faster and Mask R-CNN), another renderer, car, background and size of image, and far fewer lights.
“DTA, its algorithm” sees the images of DTN alone (the formula that `attack run` fits to them), with the paper's projection, random pose and loss; the slight
changes of brightness, contrast, size, place and noise that `attack run` makes are kept. Intervals pair photos by viewpoint and light, and hold for this car and
these lights; bold: above 0."""
# What is compared with ours in the tables of the transfer.
AGAINST = ("random", "dta", "published")


class Judged:
    """What `attack evaluate` wrote of one car."""

    def __init__(self, folder):
        with (folder / "evaluation.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.photos = int(rows[0]["photos"])
        self.definition = rows[0]["ap_definition"]
        self.rows = {(row["pattern"], row["detector"]): row for row in rows}
        with (folder / "differences.csv").open(newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["figure"] == "ap50"]
        self.differences = {}
        for row in rows:
            value, low, high = (float(row[key] or "nan") for key in ("difference", "low_95", "high_95"))
            self.differences[row["base"], row["pattern"], row["detector"]] = (value, low, high)
            self.differences[row["pattern"], row["base"], row["detector"]] = (-value, -high, -low)

    def ap(self, pattern, detector):
        return float(self.rows[pattern, detector]["ap50"])

    def has(self, pattern):
        return (pattern, next(iter(TITLES))) in self.rows

    def both(self, pattern, detector):
        return f"{self.ap(pattern, detector):.2f} / {float(self.rows[pattern, detector]['mean_confidence']):.2f}"

    def difference(self, base, pattern, detector):
        """AP of the base minus that of the pattern, with its paired 95 % interval, bold where that is above 0; none where all photos are alike."""
        value, low, high = self.differences[base, pattern, detector]
        if math.isnan(low):
            return f"{value:.2f}"
        text = f"{value:.2f} [{low:.2f}, {high:.2f}]"
        return f"**{text}**" if low > 0 else text

    def weaker(self, target, detector):
        """The seed of ours for a target that leaves more of a detector's AP."""
        return max((f"ours_{target}_{seed}" for seed in (1, 2)), key=lambda name: self.ap(name, detector))


def name_of(row, target):
    """The pattern of a row of a target's table."""
    if row in ("camou", "er", "dta"):
        return f"{row}_{target}"
    return f"ours_{target}_{row[-1]}" if row.startswith("ours") else row


def table(head, rows):
    print(f"| {' | '.join(head)} |")
    print(f"|{'---|' * len(head)}")
    for row in rows:
        print(f"| {' | '.join(row)} |")
    print()


def of_targets(judged, is_paper):
    head, shown = [f"{judged.photos} photos a pattern"], []
    for target, theirs in TARGETS.items():
        head += [TITLES[target], "row − ours, weaker seed"] + ([f"paper, {theirs}"] if is_paper else [])
    for row, title in ROWS.items():
        cells = [title]
        for target, theirs in TARGETS.items():
            name, weaker = name_of(row, target), judged.weaker(target, target)
            is_judged = judged.has(name)
            cells.append(judged.both(name, target) if is_judged else "–")
            cells.append(judged.difference(name, weaker, target) if is_judged and not row.startswith("ours") else "")
            cells += [PAPER_TARGET[theirs].get(row, "")] if is_paper else []
        if any(judged.has(name_of(row, target)) for target in TARGETS):
            shown.append(cells)
    table(head, shown)


def of_transfer(judged, target, is_paper):
    others = [detector for detector in TITLES if detector != target]
    head = [f"made against {TITLES[target]}", *(TITLES[other] for other in others)] + (["paper: SSD / Faster / Mask R-CNN"] if is_paper else [])
    shown = []
    for row, title in ROWS.items():
        name = name_of(row, target)
        paper = [PAPER_TRANSFER.get(row, "")] if is_paper else []
        if judged.has(name):
            shown.append([title, *(f"{judged.ap(name, other):.2f}" for other in others), *paper])
        elif is_paper and row in PAPER_TRANSFER:
            shown.append([title, *("–" for _ in others), *paper])
    for row in AGAINST:
        cells = [judged.difference(name_of(row, target), judged.weaker(target, other), other) for other in others]
        shown.append([f"{ROWS[row]} − ours, weaker seed", *cells, *([""] if is_paper else [])])
    table(head, shown)


def of_both(judged):
    """The patterns made against both targets at once, beside DTA's."""
    bases = [*(f"dta_{target}" for target in TARGETS), "published"]
    shown = ["normal", *bases, "both_1", "both_2"]
    rows = [[name, *(judged.both(name, detector) for detector in TITLES)] for name in shown]
    for base in bases:
        rows += [[f"{base} − {name}", *(judged.difference(base, name, detector) for detector in TITLES)] for name in ("both_1", "both_2")]
    table(["AP@0.5 / mean confidence", *TITLES.values()], rows)


def of_nine(judged):
    names = ["normal", "random", "published", *(f"ours_{target}_1" for target in TARGETS), "stored_yolox_nano", "stored_three_convolutional", "nine"]
    rows = []
    for name in names:
        shares = {detector: judged.ap(name, detector) / judged.ap("normal", detector) for detector in TITLES}
        worst = max(shares, key=shares.get)
        rows.append([name, *(f"{judged.ap(name, detector):.2f}" for detector in TITLES), f"{shares[worst]:.2f} ({TITLES[worst]})"])
    for base in ("random", "stored_three_convolutional"):
        rows.append([f"{base} − nine", *(judged.difference(base, "nine", detector) for detector in TITLES), ""])
    table(["AP@0.5", *TITLES.values(), "share left on the worst"], rows)


def of_dtn(folder):
    found = json.loads((folder / "dtn_error.json").read_text())
    print(f"Whole images, {found['images']:.0f} of them in unseen lights and colours; ours after {found['steps']:.0f} steps ({found['seconds']:.0f} s).\n")
    rows = [["paper, ResNet k = 4", *(f"{value:.6f}" for value in PAPER_DTN)], ["here, ResNet k = 4", *(f"{found[key]:.6f}" for key in ("bce", "mse", "mae"))]]
    table(["DTN", "BCE", "MSE", "MAE"], rows)
    form = json.loads((folder / "closed_form/renderers.json").read_text())["rows"]
    stands = [row["mse_paint"] for row in form if row["model"] == "quadratic-curve" and row["references"] == 5]
    print(f"Mean squared error over the paint: of DTN {found['mse_paint']:.5f}; of the formula that `attack run` takes for DTN {stands[0]:.6f}.\n")


def of_car(folder, title, is_paper):
    if not (folder / "evaluation.csv").exists():
        return
    judged = Judged(folder)
    print(f"## {title}\n\nTargets: AP@0.5 ({judged.definition}) / mean confidence\n")
    of_targets(judged, is_paper)
    print("Transfer: AP@0.5\n")
    for target in TARGETS:
        of_transfer(judged, target, is_paper)
    if judged.has("both_1"):
        print("Against both targets at once, on three cars\n")
        of_both(judged)
    if judged.has("nine"):
        print("Against all nine at once (`--against worst`), beside stored patterns\n")
        of_nine(judged)


def picture(folder):
    """Bars of the targets' AP@0.5 on the model that patterns were made on, as SVG: a column a target, a bar a row."""
    judged = Judged(folder / "target")
    wide, high, left, full = 760, 22, 178, 150
    rows = [(row, title.replace("*", "")) for row, title in ROWS.items() if judged.has(name_of(row, next(iter(TARGETS))))]
    parts = []
    for i, target in enumerate(TARGETS):
        x = left + i * (full + 130)
        parts.append(f'<text x="{x}" y="20" font-weight="bold">{TITLES[target]}</text>')
        for k, (row, title) in enumerate(rows):
            y = 30 + high * k
            ap = judged.ap(name_of(row, target), target)
            colour = "#0b6e99" if row.startswith("ours") else "#a8b3bb"
            parts.append(f'<rect x="{x}" y="{y}" width="{full * ap:.1f}" height="{high - 6}" fill="{colour}"/>')
            parts.append(f'<text x="{x + full * ap + 5:.1f}" y="{y + 13}">{ap:.2f}</text>')
            if i == 0:
                parts.append(f'<text x="{left - 8}" y="{y + 13}" text-anchor="end">{title}</text>')
    below = 30 + high * len(rows) + 16
    parts.append(f'<text x="8" y="{below}">AP@0.5 ({judged.definition}) on {judged.photos} renders a pattern; each column’s CAMOU, ER, DTA and ours were made against it</text>')
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {below + 10}" font-family="DejaVu Sans, sans-serif" font-size="12">'
    return "\n".join([head, '<rect width="100%" height="100%" fill="white"/>', *parts, "</svg>\n"])


def main(folder):
    print(f"{NOT_COMPARABLE}\n\nScale: {(folder / 'scale.txt').read_text().strip()}.\n\n## DTN\n")
    of_dtn(folder)
    of_car(folder / "target", "The model that patterns were made on", True)
    of_car(folder / "second", "Another car (p406), which no pattern was made on", False)
    print("## Time\n")
    with (folder / "times.tsv").open(newline="") as file:
        table(["stage", "s"], list(csv.reader(file, delimiter="\t")))


if __name__ == "__main__":
    if len(sys.argv) == 2:
        main(Path(sys.argv[1]))
    elif len(sys.argv) == 3:
        Path(sys.argv[2]).write_text(picture(Path(sys.argv[1])))
    else:
        sys.exit(__doc__)
