"""Windfall: a tethered lander in a vertical wind tunnel, flown, identified, and compared with its measurement.

>>> import windfall
>>> campaign = windfall.campaign("sage-perturbed")  # or a campaign file, or what such a file says as a dictionary
>>> found = windfall.identify(campaign, method="output-error", combined=True)
>>> again = windfall.resimulate(campaign, found)
>>> again.trajectory.attitude_rms_deg < 0.5
True
>>> windfall.close(campaign).verdict
'consistent'

Results are dictionaries in the words of the program's JSON files, whose keys are typed attributes too (:mod:`windfall.results`); series are
NumPy arrays whose names carry their unit. Every error is a :class:`WindfallError`, every warning a :class:`WindfallWarning`.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar, Unpack

from . import _inputs, _progress, _requests, _windfall, results
from ._campaign import Campaign
from ._flight import Flight
from ._inputs import WindfallWarning
from ._record import Result as _Result
from ._windfall import (
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
    "WindfallWarning",
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
    "keys",
    "many",
    "plan",
    "read_runs",
    "report",
    "resimulate",
    "results",
    "simulate",
    "structure",
    "study",
    "verify",
]

Path = str | os.PathLike[str]
#: A file by its path, or what it says: a mapping, or a dataclass.
Document = Path | Mapping[str, Any] | _inputs.Dataclass


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
    for name, value in given.items():
        words = _requests.CHOICES.get(name)
        if words and value is not None and value not in words:
            raise ValueError(f"{name} = {value!r}: allowed: {', '.join(words)}")
    return {name: _value(name, value) for name, value in given.items() if value is not None}


def _value(name: str, value: Any) -> Any:
    if name in _requests.ENTRIES and isinstance(value, Mapping):
        rest = ((first, *(x if isinstance(x, (tuple, list)) else (x,))) for first, x in value.items())
        return [dict(zip(_requests.ENTRIES[name], entry, strict=True)) for entry in rest]
    return f"{value[0]}/{value[1]}" if name == "shard" else value


_Of = TypeVar("_Of", bound=_Result)


def _found(kind: type[_Of], told: tuple[str, str], notes: int = 0) -> _Of:
    """A result with what the terminal prints of it; its warnings, after the reader's notes that lead them, are warned of."""
    found = kind.told(*told)
    _inputs.warn(found.get("warnings", [])[notes:])
    return found


def _request(request: type, given: Mapping[str, Any]) -> str:
    return json.dumps(_fields(request, given))


def _threads(number: int) -> int:
    """A number of threads, 0 for one per processor."""
    if isinstance(number, bool) or not isinstance(number, int):
        raise TypeError(f"threads = {number!r}: must be a whole number")
    if not 0 <= number <= _windfall.MOST_THREADS:
        raise ValueError(f"threads = {number}: allowed: 1 to {_windfall.MOST_THREADS}, or 0 for one per processor")
    return number


@_takes(_requests.Fly)
def simulate(scenario: Document, *, threads: int = 0, **request: Unpack[_requests.Fly]) -> list[Flight]:
    """Fly a scenario (file, bundled name, or document); record and truth of each flight apart."""
    with _inputs.document(scenario, "scenario") as (path, _):
        return [Flight(f) for f in _windfall.simulate(path, _request(_requests.Fly, request), _threads(threads))]


@_takes(_requests.Fly)
def campaign(source: Document, **request: Unpack[_requests.Fly]) -> Campaign:
    """Read a campaign file, or a mapping or dataclass with what such a file says; or fly a scenario, whose effects its campaign does not
    declare.

    Where a campaign names a file, in place of the name may stand what the file would hold: a run's table of pandas, polars, Arrow, xarray
    or plain lists, as in `{"name": "drop-1", "file": frame, "kind": "perturbed", "use": "identify"}`, or a structure's mapping. Tables pass
    the same checks as run files.
    """
    return Campaign(source, _request(_requests.Fly, request))


def _campaign(source: Campaign | Document) -> Campaign:
    return source if isinstance(source, Campaign) else campaign(source)


@_takes(_requests.Identify)
def identify(campaign: Campaign | Document, *, threads: int = 0, **request: Unpack[_requests.Identify]) -> results.Identification:
    """Parameters with intervals: the content of identification.json, as `windfall identify` writes it.

    Without a `method`, the one that is right for these data, with the reason.
    `combined=True`: only all runs together. `hold={"Cl_0": 0.0125}` keeps a parameter at a value, `tie={"Cn_1": "Cm_1"}` makes one equal
    to another, `prior={"Cl_p": (-5.7, 0.3)}` is a mean and a standard deviation from elsewhere. `bootstrap=40` checks the stated errors
    by so many copies.
    """
    asked, of = _request(_requests.Identify, request), _campaign(campaign)
    return _found(results.Identification, of._native.identify(asked, _threads(threads)), len(of.warnings))


@_takes(_requests.Resimulate)
def resimulate(
    campaign: Campaign | Document,
    identification: Mapping[str, Any],
    *,
    threads: int = 0,
    **request: Unpack[_requests.Resimulate],
) -> results.Resimulation:
    """Fly an identified model against each run: the content of resimulation.json.

    With `draws=100` also so many models with parameters drawn from their covariance: bands, and intervals of the statistics.
    """
    model, asked = json.dumps(identification), _request(_requests.Resimulate, request)
    return _found(results.Resimulation, _campaign(campaign)._native.resimulate(model, asked, _threads(threads)))


@_takes(_requests.Descend)
def descend(
    scenario: Document,
    identification: Mapping[str, Any] | None = None,
    *,
    out: Path | None = None,
    force: bool = False,
    threads: int = 0,
    **request: Unpack[_requests.Descend],
) -> results.Descent:
    """Fly an identified model down to the ground of a planet many times: the content of descent.json.

    `scenario` is a planet scenario of a rigid body; each of `draws` descents has parameters drawn from the identification's posterior,
    without one the scenario's own. With `out` also descent.json, descents.parquet (see :func:`read_runs`) and report.html in that folder.
    """
    model = None if identification is None else json.dumps(identification)
    folder = None if out is None else os.fspath(out)
    asked = _request(_requests.Descend, request)
    with _inputs.document(scenario, "scenario") as (path, _):
        return _found(results.Descent, _windfall.descend(path, model, asked, folder, force, _threads(threads)))


@_takes(_requests.Close)
def close(campaign: Campaign | Document, *, threads: int = 0, **request: Unpack[_requests.Close]) -> results.Closing:
    """What the declared model lacks: the content of close.json."""
    asked = _request(_requests.Close, request)
    return _found(results.Closing, _campaign(campaign)._native.close(asked, _threads(threads)))


@_takes(_requests.Close)
def close_statistics(
    statistics: Document, *, threads: int = 0, **request: Unpack[_requests.Close]
) -> results.StatisticsClosing:
    """What the declared model lacks beside published statistics (a file, or `table-5.6`): the content of close.json."""
    asked = _request(_requests.Close, request)
    with _inputs.document(statistics, "statistics") as (path, _):
        return _found(results.StatisticsClosing, _windfall.close_statistics(path, asked, _threads(threads)))


def check(path: Document) -> tuple[str, list[str]]:
    """Kind of a file (or bundled scenario, or document) and its reader's warnings; faults, and a record that is not what it says, raise."""
    with _inputs.document(path, "document") as (file, folder):
        kind, said = _windfall.check(file)
        return kind, [w.replace(folder, "") if folder else w for w in said]


def keys() -> str:
    """Every key of the files, with unit and range, as Markdown."""
    return _windfall.keys()


def verify(*, threads: int = 0) -> results.Verification:
    """Every check of the program's own truth, figure beside bound: the content of verify.json."""
    return _found(results.Verification, _windfall.verify(_threads(threads)))


def report(folder: Path, *, figures: Path | None = None, width: float | None = None, force: bool = False) -> str:
    """The page of a folder of results, as HTML in one piece.

    With `figures` also every figure of it in that folder as SVG, PDF and CSV, `width` mm wide (60 to 400, 86 when not said).
    """
    return _windfall.page(os.fspath(folder), None if figures is None else os.fspath(figures), width, force)


@_takes(_requests.Structure)
def structure(campaign: Campaign | Document, *, threads: int = 0, **request: Unpack[_requests.Structure]) -> results.Structure:
    """Which aerodynamic terms the runs carry, whatever is declared: the content of structure.json."""
    asked = _request(_requests.Structure, request)
    return _found(results.Structure, _campaign(campaign)._native.structure(asked, _threads(threads)))


@_takes(_requests.Plan)
def plan(
    campaign: Campaign | Document,
    *,
    percent: Mapping[str, float] | None = None,
    absolute: Mapping[str, float] | None = None,
    threads: int = 0,
    **request: Unpack[_requests.Plan],
) -> results.Plan | results.Separation:
    """Tunnel time that brings wanted standard errors, or runs that part rivals: the content of plan.json.

    `percent={"Cm_2": 5}` of the estimate, `absolute={"Cm_2": 10}` in the parameter's unit; `separate=True` instead: the runs that part the
    effects that these runs cannot tell apart, and sharpen wide bounds; `between` runs lie so many seconds.
    """
    wanted = [("percent", percent or {}), ("absolute", absolute or {})]
    target = [{"parameter": name, "error": {kind: error}} for kind, errors in wanted for name, error in errors.items()]
    asked = json.dumps({"target": target, **_fields(_requests.Plan, request)})
    told = _campaign(campaign)._native.plan(asked, _threads(threads))
    return _found(results.Separation, told) if request.get("separate") else _found(results.Plan, told)


@_takes(_requests.Study)
def study(
    study: Document, out: Path, *, threads: int = 0, progress: bool = False, **request: Unpack[_requests.Study]
) -> results.Study | None:
    """Draw a study into a folder: `runs.parquet` and `summary.json`, whose content is returned.

    With `shard=(i, n)`, i from 1 to n, only that share is drawn and nothing returned; `resume=True` without it joins all. `progress=True`
    shows a bar by tqdm: how much of all is in the folder.
    """
    with _inputs.document(study, "study") as (path, _):
        order = _windfall.Study(path)
        _inputs.warn(order.warnings)
        order.open(os.fspath(out), _request(_requests.Study, request))
        with _progress.shown(progress, "part", _progress.files(out, "parts", ".parquet"), order.parts):
            order.draw(_threads(threads))
        return None if request.get("shard") is not None else _found(results.Study, order.finish())


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
    verb: str,
    campaigns: Path | Sequence[Path],
    out: Path,
    *,
    threads: int = 0,
    progress: bool = False,
    **request: Unpack[_ManyOf],
) -> results.Many | None:
    """Do `close` or `identify` for every campaign of a folder, or of a list of folders and campaign files, into the folder `out`.

    Writes what `windfall many` writes: a result of each campaign, `campaigns.parquet`, `many.json`, whose content is returned, and
    `report.html`. A campaign that fails is a row with its reason. The verb takes what it takes alone, as in `many("identify", ...,
    method="equation-error")`. With `shard=(i, n)`, i from 1 to n, only that share is done and nothing returned; `resume=True` without it
    does what is missing and joins all. `progress=True` shows a bar by tqdm: how much of all is in the folder.
    """
    own = {name: value for name, value in request.items() if name in _requests.Many.__annotations__}
    order = _windfall.Many(_paths(campaigns), _each(verb, {n: v for n, v in request.items() if n not in own}))
    _inputs.warn(order.warnings)
    order.open(os.fspath(out), _request(_requests.Many, own))
    with _progress.shown(progress, "campaign", _progress.files(out, "results", "outcome.json"), len(order.campaigns)):
        order.work(_threads(threads))
    return None if own.get("shard") is not None else _found(results.Many, order.finish())


def init(*runs: Path, **request: Unpack[_requests.Init]) -> str:
    """A commented campaign file for run files, as TOML; the last of several is held out.

    Guesses are marked, what no record tells is `nan` and to be filled in, and columns that nothing reads are named. `kind` stands in place of
    the guess what kind of campaign it is. A campaign in free flight names a structure file, `body.toml`, which the program's `windfall init`
    writes beside it.
    """
    return _windfall.init([os.fspath(run) for run in runs], _request(_requests.Init, request))


def explain(*words: str) -> str:
    """What a family of effects, a key of a file, a word that is printed, or a warning means, and where that is from."""
    return _windfall.explain(list(words))


def read_runs(path: Path) -> dict[str, Any]:
    """Columns of a study's runs.parquet: float64 (NaN for nothing, flags 0 and 1), words as lists.

    `polars.read_parquet` and `pandas.read_parquet` read the file too.
    """
    return _windfall.read_runs(os.fspath(path))
