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
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypedDict, TypeVar, Unpack

import numpy as np
import numpy.typing as npt

from . import _requests, _windfall
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


_Function = TypeVar("_Function", bound=Callable[..., Any])


def _takes(*requests: type) -> Callable[[_Function], _Function]:
    """Puts what requests take by keyword into a function's help."""

    def described(function: _Function) -> _Function:
        keywords = [line for r in requests if r.__annotations__ for line in (r.__doc__ or "").strip("\n").split("\n")]
        if keywords:
            function.__doc__ = "\n".join([(function.__doc__ or "").rstrip(), "", "    By keyword:", "", *keywords])
        return function

    return described


def _fields(request: type, given: Mapping[str, Any]) -> dict[str, Any]:
    """A request as the program reads it; what is not given, or None, is left to the default."""
    known = request.__annotations__
    for name in given:
        if name not in known:
            raise TypeError(f"unexpected keyword argument {name!r}; allowed: {', '.join(known) or 'none'}")
    return {name: _value(name, value) for name, value in given.items() if value is not None}


def _value(name: str, value: Any) -> Any:
    if name in _requests.ENTRIES and isinstance(value, Mapping):
        rest = ((first, *(x if isinstance(x, (tuple, list)) else (x,))) for first, x in value.items())
        return [dict(zip(_requests.ENTRIES[name], entry, strict=True)) for entry in rest]
    return f"{value[0]}/{value[1]}" if name == "shard" else value


def _request(request: type, given: Mapping[str, Any]) -> str:
    return json.dumps(_fields(request, given))


@_takes(_requests.Fly)
def simulate(scenario: Path, *, threads: int = 0, **request: Unpack[_requests.Fly]) -> list[Flight]:
    """Fly a scenario (file, or bundled name); record and truth of each flight apart."""
    return _windfall.simulate(os.fspath(scenario), _request(_requests.Fly, request), threads)


@_takes(_requests.Fly)
def campaign(source: Path, **request: Unpack[_requests.Fly]) -> Campaign:
    """Read a campaign file; or fly a scenario, whose effects its campaign does not declare."""
    return Campaign(os.fspath(source), _request(_requests.Fly, request))


def _campaign(source: Campaign | Path) -> Campaign:
    return source if isinstance(source, Campaign) else campaign(source)


@_takes(_requests.Identify)
def identify(campaign: Campaign | Path, *, threads: int = 0, **request: Unpack[_requests.Identify]) -> dict[str, Any]:
    """Parameters with intervals: the content of identification.json, as `windfall identify` writes it.

    Methods: thesis, equation-error, output-error, filter-error; without one, the one that is right for these data, with the reason.
    `combined=True`: only all runs together. `hold={"Cl_0": 0.0125}` keeps a parameter at a value, `tie={"Cn_1": "Cm_1"}` makes one equal
    to another, `prior={"Cl_p": (-5.7, 0.3)}` is a mean and a standard deviation from elsewhere. `bootstrap=40` checks the stated errors
    by so many copies.
    """
    found: dict[str, Any] = json.loads(_campaign(campaign).identify(_request(_requests.Identify, request), threads))
    return found


@_takes(_requests.Resimulate)
def resimulate(
    campaign: Campaign | Path,
    identification: Mapping[str, Any],
    *,
    threads: int = 0,
    **request: Unpack[_requests.Resimulate],
) -> dict[str, Any]:
    """Fly an identified model against each run: the content of resimulation.json.

    With `draws=100` also so many models with parameters drawn from their covariance: bands, and intervals of the statistics.
    """
    model, asked = json.dumps(identification), _request(_requests.Resimulate, request)
    found: dict[str, Any] = json.loads(_campaign(campaign).resimulate(model, asked, threads))
    return found


@_takes(_requests.Descend)
def descend(
    scenario: Path,
    identification: Mapping[str, Any] | None = None,
    *,
    out: Path | None = None,
    force: bool = False,
    threads: int = 0,
    **request: Unpack[_requests.Descend],
) -> dict[str, Any]:
    """Fly an identified model down to the ground of a planet many times: the content of descent.json.

    `scenario` is a planet scenario of a rigid body; each of `draws` descents has parameters drawn from the identification's posterior,
    without one the scenario's own. With `out` also descent.json, descents.parquet (see :func:`read_runs`) and report.html in that folder.
    """
    model = None if identification is None else json.dumps(identification)
    folder = None if out is None else os.fspath(out)
    asked = _request(_requests.Descend, request)
    found: dict[str, Any] = json.loads(_windfall.descend(os.fspath(scenario), model, asked, folder, force, threads))
    return found


@_takes(_requests.Close)
def close(campaign: Campaign | Path, *, threads: int = 0, **request: Unpack[_requests.Close]) -> dict[str, Any]:
    """What the declared model lacks: the content of close.json."""
    found: dict[str, Any] = json.loads(_campaign(campaign).close(_request(_requests.Close, request), threads))
    return found


@_takes(_requests.Close)
def close_statistics(statistics: Path, *, threads: int = 0, **request: Unpack[_requests.Close]) -> dict[str, Any]:
    """What the declared model lacks beside published statistics (a file, or `table-5.6`): the content of close.json."""
    asked = _request(_requests.Close, request)
    found: dict[str, Any] = json.loads(_windfall.close_statistics(os.fspath(statistics), asked, threads))
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


@_takes(_requests.Structure)
def structure(campaign: Campaign | Path, *, threads: int = 0, **request: Unpack[_requests.Structure]) -> dict[str, Any]:
    """Which aerodynamic terms the runs carry, whatever is declared: the content of structure.json."""
    found: dict[str, Any] = json.loads(_campaign(campaign).structure(_request(_requests.Structure, request), threads))
    return found


@_takes(_requests.Plan)
def plan(
    campaign: Campaign | Path,
    *,
    percent: Mapping[str, float] | None = None,
    absolute: Mapping[str, float] | None = None,
    threads: int = 0,
    **request: Unpack[_requests.Plan],
) -> dict[str, Any]:
    """Tunnel time that brings wanted standard errors, or runs that part rivals: the content of plan.json.

    `percent={"Cm_2": 5}` of the estimate, `absolute={"Cm_2": 10}` in the parameter's unit; `separate=True` instead: the runs that part the
    effects that these runs cannot tell apart, and sharpen wide bounds; `between` runs lie so many seconds.
    """
    wanted = [("percent", percent or {}), ("absolute", absolute or {})]
    target = [{"parameter": name, "error": {kind: error}} for kind, errors in wanted for name, error in errors.items()]
    asked = json.dumps({"target": target, **_fields(_requests.Plan, request)})
    found: dict[str, Any] = json.loads(_campaign(campaign).plan(asked, threads))
    return found


@_takes(_requests.Study)
def study(study: Path, out: Path, *, threads: int = 0, **request: Unpack[_requests.Study]) -> dict[str, Any] | None:
    """Draw a study into a folder: `runs.parquet` and `summary.json`, whose content is returned.

    With `shard=(i, n)`, i from 1 to n, only that share is drawn and nothing returned; `resume=True` without it joins all.
    """
    order = _windfall.Study(os.fspath(study))
    order.open(os.fspath(out), _request(_requests.Study, request))
    order.draw(threads)
    return None if request.get("shard") is not None else json.loads(order.finish())


_EACH = {"close": _requests.Close, "identify": _requests.Identify}


class _ManyOf(_requests.Many, _requests.Close, _requests.Identify, total=False):
    """Of many campaigns, and of the verb that is done to each."""


def _each(verb: str, request: Mapping[str, Any]) -> str:
    """Verb and request of many campaigns as JSON; verbs that are none are refused where it is read."""
    return json.dumps({verb: _fields(_EACH[verb], request) if verb in _EACH else {}})


def _paths(campaigns: Path | Sequence[Path]) -> list[str]:
    return [os.fspath(p) for p in ([campaigns] if isinstance(campaigns, (str, os.PathLike)) else campaigns)]


@_takes(_requests.Many)
def many(
    verb: str, campaigns: Path | Sequence[Path], out: Path, *, threads: int = 0, **request: Unpack[_ManyOf]
) -> dict[str, Any] | None:
    """Do `close` or `identify` for every campaign of a folder, or of a list of folders and campaign files, into the folder `out`.

    Writes what `windfall many` writes: a result of each campaign, `campaigns.parquet`, `many.json`, whose content is returned, and
    `report.html`. A campaign that fails is a row with its reason. The verb takes what it takes alone, as in `many("identify", ...,
    method="equation-error")`. With `shard=(i, n)`, i from 1 to n, only that share is done and nothing returned; `resume=True` without it
    does what is missing and joins all.
    """
    own = {name: value for name, value in request.items() if name in _requests.Many.__annotations__}
    order = _windfall.Many(_paths(campaigns), _each(verb, {n: v for n, v in request.items() if n not in own}))
    order.open(os.fspath(out), _request(_requests.Many, own))
    order.work(threads)
    if own.get("shard") is not None:
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
