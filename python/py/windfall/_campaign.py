"""Campaigns: a declared model and its runs, from files, documents or tables."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path as FilePath
from typing import Any

from . import _inputs, _windfall

__all__ = ["Campaign"]


class Campaign:
    """One vehicle, its declared model, its runs; made by :func:`windfall.campaign`.

    It can be pickled, files and all, and is the same elsewhere.
    """

    __slots__ = ("_made_of", "_native")

    def __init__(self, source: Any, request: str = "{}") -> None:
        with _inputs.document(source, "campaign") as (path, folder):
            self._native = _windfall.Campaign(path, request, folder)
        self._made_of: tuple[Any, ...] = (source, request)
        _inputs.warn(self.warnings)

    @property
    def name(self) -> str:
        """The campaign's name."""
        return self._native.name

    @property
    def runs(self) -> list[str]:
        """Names of its runs; one that long gaps split has several."""
        return self._native.runs

    @property
    def warnings(self) -> list[str]:
        """What reading had to say."""
        return self._native.warnings

    def with_runs(self, runs: Iterable[Any] | Mapping[str, Any]) -> Campaign:
        """The same declared model with these runs, which pass the checks of run files: units, gaps, spikes, time.

        A run is a mapping with `name`, `data` (a table with the columns of run files), `kind` and `use` (`identify`, `select`, `hold-out`), or
        such a tuple (name, kind, use, data); `{"name": table, ...}` are runs to identify on.
        """
        if isinstance(runs, Mapping):
            runs = [{"name": name, "data": table} for name, table in runs.items()]
        given = [_inputs.run_of(run) for run in runs]
        other = Campaign.__new__(Campaign)
        other._native = self._native.with_runs(given)
        other._made_of = (*self._made_of[:2], given)
        _inputs.warn(other.warnings)
        return other

    def __repr__(self) -> str:
        return repr(self._native)

    def __reduce__(self) -> tuple[Any, ...]:
        source, request, *runs = self._made_of
        if isinstance(source, (str, os.PathLike)) and os.path.isfile(source):
            source = _inputs.Packed(FilePath(os.path.abspath(source)))
        return _again, (source, request, *runs)


def _again(source: Any, request: str, runs: Any = None) -> Campaign:
    """A pickled campaign."""
    made = Campaign.__new__(Campaign)
    if isinstance(source, _inputs.Packed):
        with tempfile.TemporaryDirectory(prefix="windfall-") as folder:
            native = _windfall.Campaign(source.write(folder), request, f"{folder}{os.sep}")
    else:
        with _inputs.document(source, "campaign") as (path, hidden):
            native = _windfall.Campaign(path, request, hidden)
    made._native = native if runs is None else native.with_runs(runs)
    made._made_of = (source, request) if runs is None else (source, request, runs)
    return made
