"""Types: the stubs say what the native module has, and a user's file is checked against them."""

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mypy")

USE = '''
import numpy as np
import numpy.typing as npt
import windfall
from windfall.distributed import run

flights = windfall.simulate("appendix-c", seed=3)
x: npt.NDArray[np.float64] = flights[0]["record"]["X_m"]
c = windfall.campaign("sage-perturbed")
found = windfall.identify(c, method="equation-error", hold={"Cl_0": 0.0125}, prior={"Cl_p": (-5.7, 0.3)})
name: str = c.name
again = windfall.resimulate(c, found, seeds=2)
error: float = again.trajectory.attitude_rms_deg + found.data_sets[0].parameters[0].estimate
flown = windfall.campaign({"campaign": {"name": "mine"}, "run": [{"file": flights[0].to_frame()}]})
try:
    summary = windfall.study("study.toml", "out", shard=(1, 4))
except windfall.ReadError as e:
    print(e.faults[0]["line"])
'''
WRONG = '''found.data_sets[0].parameter
windfall.simulate("appendix-c", sed=3)
windfall.identify(3)
n: int = c.name
summary["draws"]
run("study.toml", 3, "out")
'''


def mypy(folder: Path, *arguments: str) -> str:
    ran = subprocess.run([sys.executable, "-m", *arguments], cwd=folder, capture_output=True, text=True)
    return ran.stdout + ran.stderr


def test_law_stubs_are_what_is_there(tmp_path):
    assert mypy(tmp_path, "mypy.stubtest", "windfall._windfall").startswith("Success")


def test_law_right_use_passes_and_each_wrong_one_is_found(tmp_path):
    (tmp_path / "use.py").write_text(USE + WRONG)
    first = USE.count("\n") + 1
    found = mypy(tmp_path, "mypy", "--strict", "use.py").splitlines()
    lines = [int(line.split(":")[1]) for line in found if ": error:" in line]
    assert lines == list(range(first, first + WRONG.count("\n"))), found
