"""Photos scored by the workers of a Ray cluster: the report is that of one run, byte for byte.

    pip install scaleproof ray
    python score_with_ray.py SHARDS REPORT SESSION [OPTIONS of scaleproof score]

`ray.init` starts workers on this machine, or joins the cluster that RAY_ADDRESS names; sessions and weights are found there by the same paths.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import ray


@ray.remote
def shard(number: int, of: int, words: list[str]) -> bytes:
    """What a worker found in its share of the photos: the bytes of a shard's file."""
    with tempfile.TemporaryDirectory() as folder:
        # A task has one core of its worker.
        program = [sys.executable, "-m", "scaleproof", "--quiet", "score", *words]
        subprocess.run([*program, "--threads", "1", "--shard", f"{number}/{of}", "-o", folder], check=True)
        return Path(folder, f"shard_{number}_of_{of}.scaleproof").read_bytes()


count, report, *words = sys.argv[1:]
ray.init(include_dashboard=False)
asked = [shard.remote(number, int(count), words) for number in range(1, int(count) + 1)]
with tempfile.TemporaryDirectory() as folder:
    files = [Path(folder, f"{number}.scaleproof") for number in range(1, int(count) + 1)]
    for file, content in zip(files, ray.get(asked)):
        file.write_bytes(content)
    subprocess.run([sys.executable, "-m", "scaleproof", "merge", *map(str, files), "-o", report], check=True)
