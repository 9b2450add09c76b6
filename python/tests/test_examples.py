"""Notebooks, and photos that are dealt over workers, on what is stored with the project."""

import os
import subprocess
import sys
from pathlib import Path

import notebooks
import pytest

HOME = Path(__file__).parents[2]


@pytest.mark.parametrize("name", sorted(path.stem for path in notebooks.FOLDER.glob("*.py")))
def test_a_notebook_runs_and_its_page_has_what_it_prints(name, tmp_path, monkeypatch):
    for variable in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR", "JUPYTER_CONFIG_DIR"):
        monkeypatch.setenv(variable, str(tmp_path / variable))
    assert notebooks.page(name) == (HOME / f"docs/guide/notebooks/{name}.md").read_text()


@pytest.fixture(scope="module")
def by_one_run(tmp_path_factory):
    report = tmp_path_factory.mktemp("one")
    subprocess.run([sys.executable, "-m", "scaleproof", "score", *WORDS, "-o", report], check=True, cwd=HOME)
    return {path.relative_to(report): path.read_bytes() for path in report.rglob("*") if path.is_file()}


WORDS = ["captures/skyline", "--recorded", "--detector", "yolox_nano"]


@pytest.mark.parametrize("cluster", ["ray", "dask"])
def test_photos_dealt_over_workers_make_the_report_of_one_run(cluster, by_one_run, tmp_path, monkeypatch):
    monkeypatch.chdir(HOME)
    example, report = HOME / f"python/examples/score_with_{cluster}.py", tmp_path / "report"
    env = {**os.environ, "RAY_USAGE_STATS_ENABLED": "0", "XDG_CACHE_HOME": str(tmp_path)}
    ran = subprocess.run([sys.executable, example, "3", report, *WORDS], env=env, capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr
    assert {path.relative_to(report): path.read_bytes() for path in report.rglob("*") if path.is_file()} == by_one_run
    assert Path("report.html") in by_one_run
