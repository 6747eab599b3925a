"""Windfall: a tethered lander in a vertical wind tunnel, flown, identified, and compared with its measurement.

Results are dictionaries in the words of the program's JSON files; series are NumPy arrays whose names carry their unit.
Every error is a :class:`WindfallError`.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any, TypedDict

import numpy as np
import numpy.typing as npt

from . import _windfall
from ._windfall import (
    Campaign,
    IdentifyError,
    LoopError,
    ReadError,
    SimulateError,
    StudyError,
    WindfallError,
    WriteError,
    __version__,
)

__all__ = [
    "Campaign",
    "Flight",
    "IdentifyError",
    "LoopError",
    "ReadError",
    "SimulateError",
    "StudyError",
    "WindfallError",
    "WriteError",
    "__version__",
    "campaign",
    "close",
    "identify",
    "read_runs",
    "resimulate",
    "simulate",
    "study",
]

Columns = dict[str, npt.NDArray[np.float64]]
Path = str | os.PathLike[str]


class Flight(TypedDict):
    """One flight. `record` has the run file's columns, `truth` what really happened; n samples each."""

    name: str
    kind: str
    use: str
    end: str
    end_t_s: float
    record: Columns
    truth: Columns


def simulate(scenario: Path, *, seed: int | None = None, threads: int = 0) -> list[Flight]:
    """Fly a scenario (file, or bundled name); record and truth of each flight apart."""
    return _windfall.simulate(os.fspath(scenario), seed, threads)


def campaign(source: Path, *, seed: int | None = None) -> Campaign:
    """Read a campaign file; or fly a scenario, whose effects its campaign does not declare."""
    return Campaign(os.fspath(source), seed)


def _campaign(source: Campaign | Path) -> Campaign:
    return source if isinstance(source, Campaign) else campaign(source)


def identify(
    campaign: Campaign | Path,
    *,
    method: str | None = None,
    combined: bool = False,
    hold: Mapping[str, float] | None = None,
    tie: Mapping[str, str] | None = None,
    prior: Mapping[str, tuple[float, float]] | None = None,
    bootstrap: int | None = None,
    threads: int = 0,
) -> dict[str, Any]:
    """Parameters with intervals: the content of identification.json, as `windfall identify` writes it.

    Methods: thesis, equation-error, output-error, filter-error; without one, the one that is right for these data, with the reason.
    `combined=True`: only all runs together. `hold={"Cl_0": 0.0125}` keeps a parameter at a value, `tie={"Cn_1": "Cm_1"}` makes one equal
    to another, `prior={"Cl_p": (-5.7, 0.3)}` is a mean and a standard deviation from elsewhere. `bootstrap=40` checks the stated errors
    by so many copies.
    """
    text = _windfall.identify(
        _campaign(campaign),
        method,
        combined,
        list((hold or {}).items()),
        list((tie or {}).items()),
        [(name, mean, std) for name, (mean, std) in (prior or {}).items()],
        bootstrap,
        threads,
    )
    found: dict[str, Any] = json.loads(text)
    return found


def resimulate(
    campaign: Campaign | Path, identification: Mapping[str, Any], *, seeds: int = 1, threads: int = 0
) -> dict[str, Any]:
    """Fly an identified model against each run: the content of resimulation.json."""
    found: dict[str, Any] = json.loads(_windfall.resimulate(_campaign(campaign), json.dumps(identification), seeds, threads))
    return found


def close(campaign: Campaign | Path, *, threads: int = 0) -> dict[str, Any]:
    """What the declared model lacks: the content of close.json."""
    found: dict[str, Any] = json.loads(_windfall.close(_campaign(campaign), threads))
    return found


def study(
    study: Path,
    out: Path,
    *,
    resume: bool = False,
    force: bool = False,
    shard: Sequence[int] | None = None,
    threads: int = 0,
) -> dict[str, Any] | None:
    """Draw a study into a folder: `runs.parquet` and `summary.json`, whose content is returned.

    With `shard=(i, n)`, i from 1 to n, only that share is drawn and nothing returned; `resume=True` without it joins all.
    """
    order = _windfall.Study(os.fspath(study))
    order.open(os.fspath(out), resume, force, None if shard is None else (shard[0], shard[1]))
    order.draw(threads)
    return None if shard is not None else json.loads(order.finish())


def read_runs(path: Path) -> dict[str, npt.NDArray[Any] | list[str]]:
    """Columns of a study's runs.parquet: float64 (NaN for nothing, flags 0 and 1), words as lists.

    `polars.read_parquet` and `pandas.read_parquet` read the file too.
    """
    return _windfall.read_runs(os.fspath(path))
