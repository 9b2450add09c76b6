"""The sweeps of attack_sweeps.sh as a table: AP@0.5 of the plain model, of random and of two patterns, and what each pattern takes from random, with its 95 % interval.

    python sweep_table.py FOLDER
"""

import sys
from pathlib import Path

from differences import read


def drop(rows, pattern):
    row = rows["random", pattern]
    if not row["low_95"]:
        return f"{float(row['difference']):.2f}"
    return f"{float(row['difference']):.2f} [{float(row['low_95']):.2f}, {float(row['high_95']):.2f}]"


print("| sweep | photos | plain | random | seed 1 | seed 2 | drop from random, seed 1 | seed 2 |")
print("|---|---|---|---|---|---|---|---|")
for path in sorted(Path(sys.argv[1]).glob("**/differences.csv")):
    photos, ap, rows = read(path)
    aps = " | ".join(f"{ap[name]:.2f}" for name in ("normal", "random", "attack_1", "attack_2"))
    sweep = path.parent.relative_to(sys.argv[1])
    print(f"| {sweep} | {photos} | {aps} | {drop(rows, 'attack_1')} | {drop(rows, 'attack_2')} |")
