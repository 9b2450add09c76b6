"""The choices of attack_choices.sh as a table: AP@0.5 as the mean of the seeds, and its difference from the usual choice with a 95 % interval over the seeds.

    python choices_table.py FOLDER

The interval is Student's, of the differences seed by seed: with three seeds, 4.30 standard errors. What excludes 0 is marked with *; of twenty choices that
change nothing, one is marked by chance. Below 0, the choice leaves less AP than the usual one.
"""

import csv
import statistics
import sys
from pathlib import Path

TARGET = "yolox_nano"
# The 97.5 % quantile of Student's distribution with one, two … degrees of freedom.
QUANTILE = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262]


def read(folder):
    """AP@0.5 of each pattern: by the target, and the mean of the other detectors, where there are any."""
    found = {}
    with (folder / "evaluation.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            found.setdefault(row["pattern"], {})[row["detector"]] = float(row["ap50"])
    return {name: (ap.pop(TARGET), statistics.fmean(ap.values()) if ap else None) for name, ap in found.items()}


def cell(values, usual):
    mean = statistics.fmean(values)
    differences = [a - b for a, b in zip(values, usual)]
    if values == usual or len(values) < 2:
        return f"{mean:.2f}"
    middle = statistics.fmean(differences)
    half = QUANTILE[len(values) - 2] * statistics.stdev(differences) / len(values) ** 0.5
    mark = "*" if abs(middle) > half else ""
    return f"{mean:.2f} ({middle:+.2f} [{middle - half:+.2f}, {middle + half:+.2f}]{mark})"


def column(name, seeds, which):
    return [seed[name][which] for seed in seeds]


folder = Path(sys.argv[1])
model, other = ([read(path) for path in sorted(folder.glob(f"{place}_[0-9]*"))] for place in ("model", "other"))
print(f"| choice ({len(model)} seeds) | {TARGET} | the other car, {TARGET} | the other detectors, mean |")
print("|---|---|---|---|")
columns = [(model, 0), (other, 0), (model, 1)]
by_target = sorted((name for name in model[0] if name != "normal"), key=lambda name: (name != "usual", statistics.fmean(column(name, model, 0))))
for name in by_target:
    cells = [cell(column(name, seeds, which), column("usual", seeds, which)) for seeds, which in columns]
    print(f"| {name} | {' | '.join(cells)} |")
