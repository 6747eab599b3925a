"""What results have in common: dictionaries in the words of the JSON files whose keys are attributes too, with types."""

from __future__ import annotations

import json
import sys
import types
from collections.abc import Iterable, Mapping
from functools import lru_cache
from html import escape
from typing import TYPE_CHECKING, Any, Union, get_args, get_origin, get_type_hints

if TYPE_CHECKING:
    from typing import Self

    import pandas  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import xarray  # type: ignore[import-not-found, unused-ignore]
    from matplotlib.figure import Figure  # type: ignore[import-not-found, unused-ignore]

__all__ = ["Record", "Result"]


@lru_cache(maxsize=None)
def _hints(owner: type[Record]) -> dict[str, Any]:
    return get_type_hints(owner, vars(sys.modules[owner.__module__]))


def _typed(hint: Any, value: Any) -> Any:
    """A value of JSON with the classes that a field is of."""
    if isinstance(value, list) and get_origin(hint) is list:
        (inner,) = get_args(hint)
        return [_typed(inner, x) for x in value] if inner not in (float, int, str) else value
    if isinstance(value, Mapping):
        of = get_args(hint) if get_origin(hint) in (Union, types.UnionType) else (hint,)
        record = next((t for t in of if isinstance(t, type) and issubclass(t, Record)), None)
        return value if record is None else record(value)
    return value


class Record(dict[str, Any]):
    """A dictionary whose keys are attributes too."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        hints = _hints(type(self))
        super().__init__({name: _typed(hints.get(name), value) for name, value in data.items()})
        # A field that is called like a method of dictionaries (`values`) is the field.
        vars(self).update({name: self[name] for name in self if hasattr(dict, name)})

    if not TYPE_CHECKING:  # the annotations say which attributes there are

        def __getattr__(self, name: str) -> Any:
            if name in self:
                return self[name]
            hint = None if name.startswith("__") else _hints(type(self)).get(name)
            if hint is None:
                raise AttributeError(f"{type(self).__name__} has no {name!r}; it has {', '.join(self)}")
            # What a file leaves out is None, a list that it leaves out empty.
            return [] if get_origin(hint) is list else None

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({super().__repr__()})"


class Result(Record):
    """What a verb found."""

    @classmethod
    def told(cls, text: str, words: str) -> Self:
        """A result of its JSON, with what the terminal prints of it."""
        result = cls(json.loads(text))
        vars(result)["_words"] = words
        return result

    def __str__(self) -> str:
        """What the terminal prints; of a result that was made by hand, its dictionary."""
        words: str | None = vars(self).get("_words")
        return repr(self) if words is None else words.rstrip("\n")

    def to_json(self) -> str:
        """The program's JSON file, to the byte."""
        return "".join(_json(self, 0)) + "\n"

    def rows(self) -> list[dict[str, Any]]:
        """The table that says most of it, row by row."""
        table: list[dict[str, Any]] = _tables().TABLES[type(self).__name__](self)
        return table

    def to_frame(self) -> pandas.DataFrame:
        """:meth:`rows` as a table of pandas."""
        import pandas

        return pandas.DataFrame(self.rows())

    def to_xarray(self) -> xarray.Dataset:
        """:meth:`rows` as a data set of xarray: over what names a row, or over `row` with such names as its coordinates."""
        import xarray

        frame, keys = self.to_frame(), _tables().KEYS[type(self).__name__]
        over = keys[0] if len(keys) == 1 and frame[keys[0]].is_unique else "row"
        columns = {name: (over, frame[name].to_numpy()) for name in frame.columns if name not in keys}
        return xarray.Dataset(columns, coords={key: (over, frame[key].to_numpy()) for key in keys if key in frame.columns})

    def plot(self) -> Figure:
        """A figure of it; needs matplotlib (`pip install windfall[plot]`)."""
        from . import _plot

        return _plot.figure(self)

    def _repr_html_(self) -> str:
        rows = self.rows()
        heads = list(dict.fromkeys(name for row in rows for name in row))
        table = "".join(f"<tr>{''.join(f'<td>{_cell(row.get(h))}</td>' for h in heads)}</tr>" for row in rows)
        head = "".join(f"<th>{escape(h)}</th>" for h in heads)
        warned = "".join(f"<p>warning: {escape(w)}</p>" for w in self.get("warnings", ()))
        return f"<p><b>{escape(_tables().title(self))}</b></p>{warned}<table><tr>{head}</tr>{table}</table>"


def _tables() -> types.ModuleType:
    from . import _tables as tables

    return tables


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return ", ".join(_cell(x) for x in value)
    return "" if value is None else escape(str(value))


def _json(value: Any, depth: int) -> Iterable[str]:
    """JSON as the program indents it and writes its numbers."""
    inner, end = "\n" + "  " * (depth + 1), "\n" + "  " * depth
    if isinstance(value, (dict, list)) and value:
        pairs = (
            ((json.dumps(k, ensure_ascii=False) + ": ", v) for k, v in value.items())
            if isinstance(value, dict)
            else (("", v) for v in value)
        )
        yield "{" if isinstance(value, dict) else "["
        for i, (key, item) in enumerate(pairs):
            yield ("," if i else "") + inner + key
            yield from _json(item, depth + 1)
        yield end + ("}" if isinstance(value, dict) else "]")
    elif isinstance(value, float):
        yield _number(value)
    else:
        yield json.dumps(value, ensure_ascii=False)


def _number(value: float) -> str:
    """The shortest digits that give a number back, with an exponent below 1e-5 and from 1e16 on."""
    text = repr(value)
    digits, mark, exponent = text.partition("e")
    if not mark:
        return text
    if int(exponent) == -5:
        sign, plain = ("-", digits[1:]) if digits.startswith("-") else ("", digits)
        return f"{sign}0.0000{plain.replace('.', '')}"
    return f"{digits}e{int(exponent)}"
