"""Photos scored by the workers of a Dask cluster: the report is that of one run, byte for byte.

    pip install scaleproof distributed
    python score_with_dask.py SHARDS REPORT SESSION [OPTIONS of scaleproof score]

Starts two workers on this machine, or takes those of the scheduler that DASK_SCHEDULER names; sessions and weights are found there by the same paths.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from dask.distributed import Client


def shard(number: int, of: int, words: list[str]) -> bytes:
    """What a worker found in its share of the photos: the bytes of a shard's file."""
    with tempfile.TemporaryDirectory() as folder:
        # A task has one core of its worker.
        program = [sys.executable, "-m", "scaleproof", "--quiet", "score", *words]
        subprocess.run([*program, "--threads", "1", "--shard", f"{number}/{of}", "-o", folder], check=True)
        return Path(folder, f"shard_{number}_of_{of}.scaleproof").read_bytes()


if __name__ == "__main__":  # workers import this file
    count, report, *words = sys.argv[1:]
    scheduler = os.environ.get("DASK_SCHEDULER")
    client = Client(scheduler) if scheduler else Client(n_workers=2, threads_per_worker=1, dashboard_address=None)
    asked = client.map(shard, range(1, int(count) + 1), of=int(count), words=words)
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder, f"{number}.scaleproof") for number in range(1, int(count) + 1)]
        for file, content in zip(files, client.gather(asked)):
            file.write_bytes(content)
        subprocess.run([sys.executable, "-m", "scaleproof", "merge", *map(str, files), "-o", report], check=True)
