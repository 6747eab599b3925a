"""A flight of a scenario: record and truth as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._inputs import Columns
from ._record import Record

if TYPE_CHECKING:
    import pandas  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import xarray  # type: ignore[import-not-found, unused-ignore]
    from matplotlib.figure import Figure  # type: ignore[import-not-found, unused-ignore]

__all__ = ["Flight"]


class Flight(Record):
    """One flight. `record` has the run file's columns, `truth` what really happened; n samples each."""

    name: str
    kind: str
    use: str
    end: str
    end_t_s: float
    record: Columns
    truth: Columns

    def to_frame(self) -> pandas.DataFrame:
        """The record as a table of pandas, which :func:`windfall.campaign` takes as a run."""
        import pandas

        return pandas.DataFrame(self.record)

    def to_xarray(self) -> xarray.Dataset:
        """Record and truth over time; the truth's names begin with `true_`."""
        import xarray

        axes = {2: ["t_s"], 3: ["t_s", "axis"], 4: ["t_s", "component"]}
        series: dict[str, Any] = {name: (["t_s"], x) for name, x in self.record.items() if name != "t_s"}
        for name, x in self.truth.items():
            if name != "t_s":
                series[f"true_{name}"] = (axes[2 if x.ndim == 1 else x.shape[1]], x)
        return xarray.Dataset(series, coords={"t_s": self.record["t_s"]}, attrs={"name": self.name, "end": self.end})

    def plot(self) -> Figure:
        """Position and attitude over time; needs matplotlib."""
        from . import _plot

        return _plot.figure(self)

    def _repr_html_(self) -> str:
        return f"<p><b>{self.name}</b> ({self.kind}, {self.use}): {len(self.record['t_s'])} samples, {self.end} at {self.end_t_s:g} s</p>"
