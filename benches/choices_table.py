"""The choices of attack_choices.sh as a table: AP@0.5 as the mean of the seeds, and its difference from the usual choice (blocks.py). Below 0, the choice leaves less.

    python choices_table.py FOLDER

FOLDER has model_SEED.csv and other_SEED.csv.
"""

import csv
import statistics
import sys
from pathlib import Path

from blocks import Blocks

TARGET = "yolox_nano"


def read(path):
    """AP@0.5 of each pattern: by the target, and the mean of the other detectors, where there are any."""
    found = {}
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            found.setdefault(row["pattern"], {})[row["detector"]] = float(row["ap50"])
    return {name: (ap.pop(TARGET), statistics.fmean(ap.values()) if ap else None) for name, ap in found.items() if name != "normal"}


def figure(seeds, which):
    return Blocks({name: [seed[name][which] for seed in seeds] for name in seeds[0]}, "usual")


folder = Path(sys.argv[1])
model, other = ([read(path) for path in sorted(folder.glob(f"{place}_[0-9]*.csv"))] for place in ("model", "other"))
columns = [figure(model, 0), figure(other, 0), figure(model, 1)]
print(f"| choice ({len(model)} seeds) | {TARGET} | the other car, {TARGET} | the other detectors, mean |")
print("|---|---|---|---|")
for name in columns[0].order():
    print(f"| {name} | {' | '.join(column.cell(name, 2) for column in columns)} |")
