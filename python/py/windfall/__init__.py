"""Windfall: a tethered lander in a vertical wind tunnel, flown, identified, and compared with its measurement.

>>> import windfall
>>> campaign = windfall.campaign("sage-perturbed")  # or the path of a campaign file
>>> found = windfall.identify(campaign, method="output-error", combined=True)
>>> again = windfall.resimulate(campaign, found)
>>> again["trajectory"]["attitude_rms_deg"] < 0.5
True
>>> windfall.close(campaign)["verdict"]
'consistent'

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
    "check",
    "close",
    "close_statistics",
    "descend",
    "explain",
    "identify",
    "init",
    "many",
    "plan",
    "read_runs",
    "report",
    "resimulate",
    "simulate",
    "structure",
    "study",
    "verify",
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


def _request(**fields: Any) -> str:
    """A request as JSON; what is not given is left to the default."""
    return json.dumps({name: value for name, value in fields.items() if value is not None})


def simulate(scenario: Path, *, seed: int | None = None, threads: int = 0) -> list[Flight]:
    """Fly a scenario (file, or bundled name); record and truth of each flight apart."""
    return _windfall.simulate(os.fspath(scenario), _request(seed=seed), threads)


def campaign(source: Path, *, seed: int | None = None) -> Campaign:
    """Read a campaign file; or fly a scenario, whose effects its campaign does not declare."""
    return Campaign(os.fspath(source), _request(seed=seed))


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
    request = json.dumps(_identify_fields(method, combined, hold, tie, prior, bootstrap))
    found: dict[str, Any] = json.loads(_campaign(campaign).identify(request, threads))
    return found


def _identify_fields(
    method: str | None = None,
    combined: bool = False,
    hold: Mapping[str, float] | None = None,
    tie: Mapping[str, str] | None = None,
    prior: Mapping[str, tuple[float, float]] | None = None,
    bootstrap: int | None = None,
) -> dict[str, Any]:
    """The request of `identify` as a dictionary."""
    fields = {
        "method": method,
        "combined": combined,
        "bootstrap": bootstrap,
        "hold": [{"name": name, "value": value} for name, value in (hold or {}).items()],
        "tie": [{"name": name, "to": to} for name, to in (tie or {}).items()],
        "prior": [{"name": name, "mean": mean, "std": std} for name, (mean, std) in (prior or {}).items()],
    }
    return {name: value for name, value in fields.items() if value is not None}


def resimulate(
    campaign: Campaign | Path, identification: Mapping[str, Any], *, seeds: int = 1, draws: int = 0, threads: int = 0
) -> dict[str, Any]:
    """Fly an identified model against each run: the content of resimulation.json.

    With `draws=100` also so many models with parameters drawn from their covariance: bands, and intervals of the statistics.
    """
    model = json.dumps(identification)
    found: dict[str, Any] = json.loads(_campaign(campaign).resimulate(model, _request(seeds=seeds, draws=draws), threads))
    return found


def descend(
    scenario: Path,
    identification: Mapping[str, Any] | None = None,
    *,
    draws: int | None = None,
    seed: int | None = None,
    flight: str | None = None,
    out: Path | None = None,
    force: bool = False,
    threads: int = 0,
) -> dict[str, Any]:
    """Fly an identified model down to the ground of a planet many times: the content of descent.json.

    `scenario` is a planet scenario of a rigid body; each of `draws` descents has parameters drawn from the identification's posterior,
    without one the scenario's own. With `out` also descent.json, descents.parquet (see :func:`read_runs`) and report.html in that folder.
    """
    model = None if identification is None else json.dumps(identification)
    folder = None if out is None else os.fspath(out)
    request = _request(draws=draws, seed=seed, flight=flight)
    found: dict[str, Any] = json.loads(_windfall.descend(os.fspath(scenario), model, request, folder, force, threads))
    return found


def close(campaign: Campaign | Path, *, threads: int = 0) -> dict[str, Any]:
    """What the declared model lacks: the content of close.json."""
    found: dict[str, Any] = json.loads(_campaign(campaign).close(_request(), threads))
    return found


def close_statistics(statistics: Path, *, threads: int = 0) -> dict[str, Any]:
    """What the declared model lacks beside published statistics (a file, or `table-5.6`): the content of close.json."""
    found: dict[str, Any] = json.loads(_windfall.close_statistics(os.fspath(statistics), _request(), threads))
    return found


def check(path: Path) -> tuple[str, list[str]]:
    """Kind of a file (or of a bundled scenario) and its reader's warnings; faults, and a record that is not what it says, raise."""
    return _windfall.check(os.fspath(path))


def verify(*, threads: int = 0) -> dict[str, Any]:
    """Every check of the program's own truth, figure beside bound: the content of verify.json."""
    found: dict[str, Any] = json.loads(_windfall.verify(threads))
    return found


def report(folder: Path) -> str:
    """The page of a folder of results, as HTML in one piece."""
    return _windfall.page(os.fspath(folder))


def structure(campaign: Campaign | Path, *, criterion: str | None = None, threads: int = 0) -> dict[str, Any]:
    """Which aerodynamic terms the runs carry, whatever is declared: the content of structure.json."""
    found: dict[str, Any] = json.loads(_campaign(campaign).structure(_request(criterion=criterion), threads))
    return found


def plan(
    campaign: Campaign | Path,
    *,
    percent: Mapping[str, float] | None = None,
    absolute: Mapping[str, float] | None = None,
    separate: bool | None = None,
    between: float | None = None,
    threads: int = 0,
) -> dict[str, Any]:
    """Tunnel time that brings wanted standard errors, or runs that part rivals: the content of plan.json.

    `percent={"Cm_2": 5}` of the estimate, `absolute={"Cm_2": 10}` in the parameter's unit; `separate=True` instead: the runs that part the
    effects that these runs cannot tell apart, and sharpen wide bounds; `between` runs lie so many seconds.
    """
    wanted = [("percent", percent or {}), ("absolute", absolute or {})]
    target = [{"parameter": name, "error": {kind: error}} for kind, errors in wanted for name, error in errors.items()]
    found: dict[str, Any] = json.loads(_campaign(campaign).plan(_request(target=target, separate=separate, between=between), threads))
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
    share = None if shard is None else f"{shard[0]}/{shard[1]}"
    order.open(os.fspath(out), _request(resume=resume, force=force, shard=share))
    order.draw(threads)
    return None if shard is not None else json.loads(order.finish())


def _each(verb: str, request: Mapping[str, Any]) -> str:
    """Verb and request of many campaigns as JSON."""
    return json.dumps({verb: _identify_fields(**request) if verb == "identify" else dict(request)})


def _paths(campaigns: Path | Sequence[Path]) -> list[str]:
    return [os.fspath(p) for p in ([campaigns] if isinstance(campaigns, (str, os.PathLike)) else campaigns)]


def many(
    verb: str,
    campaigns: Path | Sequence[Path],
    out: Path,
    *,
    resume: bool = False,
    force: bool = False,
    shard: Sequence[int] | None = None,
    threads: int = 0,
    **request: Any,
) -> dict[str, Any] | None:
    """Do `close` or `identify` for every campaign of a folder, or of a list of folders and campaign files, into the folder `out`.

    Writes what `windfall many` writes: a result of each campaign, `campaigns.parquet`, `many.json`, whose content is returned, and
    `report.html`. A campaign that fails is a row with its reason. `request` is what the verb takes, as in `many("identify", ...,
    method="equation-error")`. With `shard=(i, n)`, i from 1 to n, only that share is done and nothing returned; `resume=True` without it
    does what is missing and joins all.
    """
    order = _windfall.Many(_paths(campaigns), _each(verb, request))
    share = None if shard is None else f"{shard[0]}/{shard[1]}"
    order.open(os.fspath(out), _request(resume=resume, force=force, shard=share))
    order.work(threads)
    if shard is not None:
        return None
    found: dict[str, Any] = json.loads(order.finish())
    return found


def init(run: Path) -> str:
    """A commented campaign file for a run file, as TOML; guesses are marked, what no record tells is `nan` and to be filled in."""
    return _windfall.init(os.fspath(run))


def explain(*words: str) -> str:
    """What a family of effects, a key of a file, or a warning means, and where that is from."""
    return _windfall.explain(list(words))


def read_runs(path: Path) -> dict[str, npt.NDArray[Any] | list[str]]:
    """Columns of a study's runs.parquet: float64 (NaN for nothing, flags 0 and 1), words as lists.

    `polars.read_parquet` and `pandas.read_parquet` read the file too.
    """
    return _windfall.read_runs(os.fspath(path))
