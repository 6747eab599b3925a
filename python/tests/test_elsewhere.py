"""What others draw and read: the lines of docs/studies/cluster.md, as they stand there."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import windfall
from test_windfall import files, study_file

PAGE = Path(__file__).parents[2] / "docs/studies/cluster.md"


def lines(word: str, folder: Path) -> str:
    """The page's Python that imports so, on files of this test."""
    (block,) = [b for b in re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.S) if f"import {word}\n" in b]
    return block.replace("/shared/", f"{folder}/")


def test_law_duckdb_and_polars_read_the_table(tmp_path):
    pytest.importorskip("duckdb")
    summary = windfall.study(study_file(tmp_path), tmp_path / "results")
    said = {}
    exec(lines("duckdb", tmp_path), said)
    (draws, mean), line = said["in_sql"], next(p for p in summary["parameters"] if p["name"] == "CA_T0")
    assert draws == 40 and mean == pytest.approx(line["bias"], rel=1e-9, abs=1e-15)
    assert said["in_polars"] == pytest.approx(said["in_sql"], rel=1e-12)


def test_law_shares_drawn_by_ray_are_the_study(tmp_path):
    pytest.importorskip("ray")
    windfall.study(study_file(tmp_path), tmp_path / "one")
    script = tmp_path / "shares.py"
    script.write_text(lines("ray", tmp_path))
    subprocess.run([sys.executable, script], check=True, capture_output=True, timeout=300)
    assert files(tmp_path / "results") == files(tmp_path / "one")
