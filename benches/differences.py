"""AP@0.5 in what `attack evaluate` wrote: each pattern's, and each pair's difference with its paired 95 % interval."""

import csv


def read(path):
    """Of a differences.csv: the number of photos that are paired, AP@0.5 of each pattern, and the row of each pair (base, pattern)."""
    with path.open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["figure"] == "ap50"]
    ap = {row["base"]: float(row["of_base"]) for row in rows} | {row["pattern"]: float(row["of_pattern"]) for row in rows}
    return int(rows[0]["pairs"]), ap, {(row["base"], row["pattern"]): row for row in rows}
