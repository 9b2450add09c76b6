"""The choices of dtn_choices.sh as a table: mean squared error times 10,000 as the mean of the seeds, and its difference from DTN's own choice (blocks.py).

    python dtn_table.py RENDERERS_JSON NETWORK…

NETWORK…: CHOICE_SEED.dtn, as they were named to `attack chart`, whose rows have them last and in that order.
"""

import json
import sys
from pathlib import Path

from blocks import Blocks

renderers, *networks = map(Path, sys.argv[1:])
rows = json.loads(renderers.read_text())["rows"][-len(networks) :]
figures = {"mse_paint": {}, "mse_picture": {}}
for path, row in zip(networks, rows, strict=True):
    choice, _ = path.stem.rsplit("_", 1)
    for key, values in figures.items():
        values.setdefault(choice, []).append(1e4 * row[key])
# Three references scatter ten times as widely as one, and would widen every interval.
apart = [values.pop("references") for values in figures.values()]
paint, whole = (Blocks(values, "resnet4") for values in figures.values())
print(f"| choice ({paint.seeds} seeds) | 10⁴ MSE over the paint | 10⁴ MSE over whole images |")
print("|---|---|---|")
for name in paint.order():
    print(f"| {name} | {paint.cell(name, 1)} | {whole.cell(name, 2)} |")
print(f"| references | {' | '.join(', '.join(f'{value:.1f}' for value in values) for values in apart)} |")
