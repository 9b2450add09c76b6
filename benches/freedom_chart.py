"""How much freedom a pattern needs, from attack_freedom.sh: a table of what each pattern leaves, and a chart of it (FOLDER/chart.svg).

    python freedom_chart.py FOLDER

A freedom is LAYING_CELLS_TILE_COLOURS; its AP@0.5 is that of the weaker of its seeds, and so is the pattern that it is compared by. It is shown worse than the
best freedom where the paired 95 % interval of `attack evaluate` excludes 0.
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.hashsalt": "scaleproof", "svg.fonttype": "none"})
import matplotlib.pyplot as plt
from differences import read

LABELS = {
    ("world", "118"): "repeated every 118 mm",
    ("world", "240"): "repeated every 240 mm",
    ("world", "480"): "once (480 mm)",
    ("sides", "118"): "each side its own, every 118 mm",
    ("sides", "480"): "each side its own, once (480 mm)",
}


def seeds(ap):
    """The seeds of each freedom: (AP, name of the pattern), the weaker last."""
    found = {}
    for name, value in ap.items():
        freedom, _, seed = name.rpartition("_")
        if seed.isdigit():
            found.setdefault(freedom, []).append((value, name))
    return {freedom: sorted(values) for freedom, values in found.items()}


def interval(pairs, a, b):
    """By how much pattern a leaves more than pattern b: difference, low, high."""
    row, sign = (pairs[a, b], 1) if (a, b) in pairs else (pairs[b, a], -1)
    ends = sorted(sign * float(row[end]) for end in ("low_95", "high_95")) if row["low_95"] else (float("nan"), float("nan"))
    return sign * float(row["difference"]), *ends


def table(freedoms, pairs):
    best = min(freedoms, key=lambda freedom: freedoms[freedom][-1])
    print("| laying | cells | tile (mm) | colours | AP@0.5 of the seeds | the weaker above the best's weaker |")
    print("|---|---|---|---|---|---|")
    for freedom, found in freedoms.items():
        laying, cells, tile, colours = freedom.split("_")
        if freedom == best:
            above = "the best"
        else:
            difference, low, high = interval(pairs, found[-1][1], freedoms[best][-1][1])
            above = f"{difference:+.2f} [{low:+.2f}, {high:+.2f}]{'*' if low > 0 else ''}"
        print(f"| {laying} | {cells}×{cells} | {tile} | {colours} | {', '.join(f'{value:.2f}' for value, _ in found)} | {above} |")


def line(axes, freedoms, where, label):
    """The seeds as dots, a line through the weaker ones; where: (x, name of the freedom)."""
    where = [(x, freedoms[name]) for x, name in sorted(where)]
    (drawn,) = axes.plot([x for x, _ in where], [found[-1][0] for _, found in where], marker="o", label=label)
    for x, found in where:
        axes.plot([x] * len(found), [value for value, _ in found], marker="o", markersize=4, color=drawn.get_color(), linewidth=0.8)


def chart(freedoms, ap, path):
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), sharey=True, width_ratios=(2, 1), layout="constrained")
    split = {name: name.split("_") for name in freedoms}
    for (laying, tile), label in LABELS.items():
        own = [(int(parts[1]), name) for name, parts in split.items() if (parts[0], parts[2], parts[3]) == (laying, tile, "free")]
        line(left, freedoms, own, label)
    colours = [(int(parts[3]), name) for name, parts in split.items() if parts[3] != "free"]
    line(right, freedoms, [*colours, (16, "world_16_118_free")], "16×16 cells every 118 mm")
    for axes in (left, right):
        axes.axhline(ap["normal"], color="black", linewidth=0.8, linestyle=":", label="grey")
        axes.axhline(ap["random"], color="black", linewidth=0.8, linestyle="--", label="random, 16×16 cells every 118 mm")
        axes.set_ylim(0, 1.02)
        axes.grid(alpha=0.3)
    left.set_xscale("log", base=2)
    left.set_xticks([4, 8, 16, 24, 32, 64], labels=["4", "8", "16", "24", "32", "64"])
    left.minorticks_off()
    left.set_xlabel("cells across a repeat")
    left.set_ylabel("AP@0.5 of yolox_nano, rendered photos")
    left.legend(fontsize="small")
    right.set_xticks([2, 4, 8, 12, 16], labels=["2", "4", "8", "12", "free"])
    right.set_xlabel("colours")
    right.legend(fontsize="small")
    figure.savefig(path, metadata={"Date": None})


folder = Path(sys.argv[1])
_, ap, pairs = read(folder / "evaluation" / "differences.csv")
freedoms = seeds(ap)
table(freedoms, pairs)
chart(freedoms, ap, folder / "chart.svg")
