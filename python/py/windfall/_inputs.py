"""What stands for files: runs from tables of any kind, campaigns, scenarios and studies from dictionaries and dataclasses.

All of it is written into a folder of its own for as long as it is read, so that files' reader checks it.
"""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import json
import os
import re
import socket
import sys
import tempfile
import tomllib
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path as FilePath
from typing import Any, ClassVar, Protocol

import numpy as np
import numpy.typing as npt

from . import _windfall
from ._windfall import ReadError

__all__ = ["Columns", "Dataclass", "Packed", "WindfallWarning", "columns_of", "document", "files_of", "run_of", "warn"]

_HERE = (os.path.dirname(__file__), contextlib.__file__)

#: What to do about a file that is only here.
_REMEDY = "try: its path relative to the file that names it, or a folder that all machines see"

Columns = dict[str, npt.NDArray[np.float64]]

#: Keys under which a file is named: in its place what the file would hold may stand.
_FILES = ("file", "files", "structure", "scenario", "campaign", "model")


class Dataclass(Protocol):
    """Any dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Any]]


class WindfallWarning(UserWarning):
    """What reading files or tables had to say: repairs of a record, numbers that look odd."""


def warn(said: Sequence[str]) -> None:
    """Says it where the user called from."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_HERE):
        level, frame = level + 1, frame.f_back
    for text in said:
        warnings.warn(text, WindfallWarning, stacklevel=level)


def columns_of(table: Any) -> tuple[Columns, list[str]]:
    """Columns of a table as float64, NaN where nothing stands, and the names of those that hold no numbers.

    A table is a mapping of names to sequences, a list of rows, a structured array, or a table of pandas, polars, Arrow or xarray.
    """
    found: Columns = {}
    left_out: list[str] = []
    for name, values in _named(table):
        numbers = _numbers(values)
        if numbers is None:
            left_out.append(name)
        else:
            found[name] = numbers
    return found, left_out


def is_table(value: Any) -> bool:
    """Whether a value is a table and no document: documents have words and tables, tables only columns."""
    if isinstance(value, Mapping) and not hasattr(value, "data_vars"):
        return bool(value) and all(_is_column(v) for v in value.values())
    if isinstance(value, (list, tuple)):
        rows = all(isinstance(row, Mapping) and row for row in value)
        return bool(value) and rows and not any(hasattr(x, "__len__") for row in value for x in row.values())
    words = ("data_vars", "column_names", "collect_schema", "columns", "__arrow_c_stream__")
    return any(hasattr(value, word) for word in words) or (isinstance(value, np.ndarray) and value.dtype.names is not None)


def _is_column(value: Any) -> bool:
    listed = hasattr(value, "__len__") and not isinstance(value, (str, bytes, Mapping))
    return listed and not (isinstance(value, (list, tuple)) and any(isinstance(x, (Mapping, list, tuple)) for x in value[:1]))


def _named(table: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(table, Mapping) and not hasattr(table, "data_vars"):
        yield from ((str(name), values) for name, values in table.items())
    elif isinstance(table, np.ndarray) and table.dtype.names is not None:
        yield from ((name, table[name]) for name in table.dtype.names)
    elif isinstance(table, (list, tuple)) and all(isinstance(row, Mapping) for row in table):
        names = list(dict.fromkeys(name for row in table for name in row))
        yield from ((str(name), [row.get(name) for row in table]) for name in names)
    elif hasattr(table, "data_vars"):  # xarray: what has one dimension, coordinates included
        yield from ((str(name), v.values) for name, v in table.variables.items() if v.ndim == 1)
    elif hasattr(table, "column_names"):  # Arrow: tables and record batches
        yield from ((name, table.column(name).to_numpy(zero_copy_only=False)) for name in table.column_names)
    elif hasattr(table, "collect_schema") and hasattr(table, "collect"):  # a lazy frame
        yield from _named(table.collect())
    elif hasattr(table, "columns"):  # pandas and polars; the index of pandas where it has a name
        index = getattr(table, "index", None)
        if index is not None and index.name is not None and index.name not in list(table.columns):
            yield str(index.name), index.to_numpy()
        yield from ((str(name), table[name].to_numpy()) for name in table.columns)
    elif hasattr(table, "__arrow_c_stream__"):
        import pyarrow  # type: ignore[import-not-found, import-untyped, unused-ignore]

        yield from _named(pyarrow.table(table))
    else:
        kinds = "a mapping of names to columns, a list of rows, a structured array, or a table of pandas, polars, Arrow or xarray"
        raise TypeError(f"{type(table).__name__} is no table; allowed: {kinds}")


def _numbers(values: Any) -> npt.NDArray[np.float64] | None:
    """A column as numbers; none where it holds words, dates or lists."""
    array = np.asarray(values)
    if array.ndim != 1:
        return None
    if array.dtype.kind == "O":
        kinds = (int, float, np.number, type(None))
        if not all(isinstance(x, kinds) or str(x) in ("<NA>", "NaT") for x in array):
            return None
        return np.array([float(x) if isinstance(x, kinds) and x is not None else np.nan for x in array], dtype=np.float64)
    return np.ascontiguousarray(array, dtype=np.float64) if array.dtype.kind in "fiub" else None


def run_of(run: Any) -> tuple[str, str, str, Columns, list[str]]:
    """A run as (name, kind, use, columns, columns without numbers), from such a tuple without its end or from a mapping."""
    if isinstance(run, Mapping):
        given = {"kind": "", "use": "identify", **run}
        if lacking := [key for key in ("name", "data") if key not in given]:
            raise TypeError(f"a run needs {' and '.join(lacking)}; it may have kind and use")
        if more := [key for key in given if key not in ("name", "kind", "use", "data")]:
            raise TypeError(f"a run has no {', '.join(more)}; allowed: name, kind, use, data")
        name, kind, use, table = (given[key] for key in ("name", "kind", "use", "data"))
    else:
        name, kind, use, table = run
    return (name, kind, use, *columns_of(table))


@contextmanager
def document(given: Any, kind: str) -> Iterator[tuple[str, str | None]]:
    """The path of a document of this kind, and of the folder that it was written into where it was no file.

    Faults then name keys and runs, and neither the folder nor lines that nobody wrote.
    """
    if isinstance(given, (str, os.PathLike)):
        yield os.fspath(given), None
        return
    with tempfile.TemporaryDirectory(prefix="windfall-") as name:
        folder = FilePath(name)
        files = _Folder(folder)
        files.put(given, f"{kind}.toml")
        warn(files.said)
        hidden = f"{folder}{os.sep}"
        try:
            yield str(folder / f"{kind}.toml"), hidden
        except ReadError as error:
            raise _without(error, hidden) from None


def _without(error: ReadError, folder: str) -> ReadError:
    text = re.sub(r"(\.toml):\d+: ", r"\1: ", str(error).replace(folder, ""))
    again = ReadError(text)
    again.faults = [
        {**f, "file": f["file"].replace(folder, ""), "line": None if f["file"].startswith(folder) else f["line"]}
        for f in getattr(error, "faults", [])
    ]
    return again


class _Folder:
    """Documents and tables as files of one folder."""

    def __init__(self, folder: FilePath) -> None:
        self.folder = folder
        self.taken: set[str] = set()
        self.said: list[str] = []

    def put(self, given: Any, name: str) -> None:
        fields = _plain(given)
        if not isinstance(fields, Mapping):
            raise TypeError(f"{type(given).__name__} is no document; allowed: a path, a mapping or a dataclass")
        # `campaign`, `scenario` and the like are tables here, and name files further down.
        text = _toml({str(key): self._value("", value) for key, value in fields.items() if value is not None})
        (self.folder / name).write_text(text, encoding="utf-8")

    def _value(self, key: str, value: Any) -> Any:
        if key == "files" and isinstance(value, (list, tuple)):
            return [self._file(key, v, None) for v in value]
        if key in _FILES:
            return self._file(key, value, None)
        value = _plain(value)
        if isinstance(value, Mapping):
            fields = dict(value)
            name = fields.pop("name", None) if is_table(fields.get("file")) else None
            return {
                str(k): self._file(k, v, name) if k == "file" else self._value(k, v) for k, v in fields.items() if v is not None
            }
        return [self._value("", v) for v in value] if isinstance(value, (list, tuple)) else value

    def _file(self, key: str, value: Any, name: str | None) -> Any:
        """The name of a file: of one that is there, or of what is written now."""
        if isinstance(value, (str, os.PathLike)):
            word = os.fspath(value)
            return os.path.abspath(word) if os.path.isfile(word) else word
        if is_table(value):
            return self._run(value, name or "run")
        if key == "model":
            return self._written("model.json", json.dumps(value))
        path = self._free(f"{key}.toml")
        self.put(value, path)
        return path

    def _run(self, table: Any, name: str) -> str:
        columns, left_out = columns_of(table)
        rows = {len(c) for c in columns.values()}
        if len(rows) > 1:
            raise ValueError(
                f"run {name}: columns differ in length: {', '.join(f'{n} has {len(c)}' for n, c in columns.items())}"
            )
        path = self._free(f"{re.sub(r'[^-_ .a-zA-Z0-9]', '_', name)}.csv")
        if left_out:
            self.said.append(f"{path}: columns that hold no plain numbers: {', '.join(left_out)}")
        _windfall.write_columns(str(self.folder / path), columns)
        return path

    def _written(self, name: str, text: str) -> str:
        path = self._free(name)
        (self.folder / path).write_text(text, encoding="utf-8")
        return path

    def _free(self, name: str) -> str:
        stem, dot, ending = name.rpartition(".")
        numbered = (name, *(f"{stem}-{i}{dot}{ending}" for i in range(2, 10_002)))
        free = next(n for n in numbered if n.lower() not in self.taken)
        self.taken.add(free.lower())
        return free


def _plain(value: Any) -> Any:
    """Dataclasses as mappings, arrays as lists, numbers of NumPy as numbers."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: getattr(value, f.name) for f in dataclasses.fields(value) if getattr(value, f.name) is not None}
    if isinstance(value, np.ndarray) and value.dtype.names is None or isinstance(value, np.generic):
        return value.tolist()
    return value


def _toml(fields: Mapping[str, Any]) -> str:
    """A document: plain keys first, then each table with its keys one a line, then each list of tables."""
    plain = {k: v for k, v in fields.items() if not isinstance(v, Mapping) and not _is_tables(v)}
    lines = [f"{_key(k)} = {_inline(v)}" for k, v in plain.items()]
    for key, value in fields.items():
        if isinstance(value, Mapping):
            lines += _table(f"[{_key(key)}]", value)
        elif _is_tables(value):
            lines += [line for item in value for line in _table(f"[[{_key(key)}]]", item)]
    return "\n".join(lines) + "\n"


def _table(head: str, fields: Mapping[str, Any]) -> list[str]:
    return ["", head, *(f"{_key(k)} = {_inline(v)}" for k, v in fields.items())]


def _is_tables(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[-_A-Za-z0-9]+", key) else json.dumps(key)


def _inline(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_inline(v)}" for k, v in value.items()) + " }"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return "[" + ", ".join(_inline(v) for v in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, str)):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, float):
        return repr(value)  # nan and inf are TOML's words too
    raise TypeError(
        f"{type(value).__name__} has no place in a document; allowed: words, numbers, lists, mappings, dataclasses, tables"
    )


def files_of(file: FilePath) -> tuple[list[FilePath], list[FilePath]]:
    """A file and those that strings in it name if it is TOML, and so on; apart from them what is reached by an absolute path."""
    found, fixed = [file], list[FilePath]()
    for path, into in _growing(found, fixed):
        if path.suffix == ".toml":
            try:
                strings = _strings(tomllib.loads(path.read_text(encoding="utf-8")))
            except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
                continue  # the reader says what is wrong with it
            for word in dict.fromkeys(s for s in strings if "\0" not in s):
                named, among = FilePath(os.path.normpath(path.parent / word)), fixed if os.path.isabs(word) else into
                if named not in among and _is_file(named):
                    among.append(named)
    return found, fixed


def _growing(*lists: list[FilePath]) -> Iterator[tuple[FilePath, list[FilePath]]]:
    """Each file with its list, also those that are added on the way to this list or a later one."""
    for each in lists:
        for path in each:
            yield path, each


class Packed:
    """A file and all that it names, with their paths below a common folder: to be written elsewhere, where the first names the others still.

    What is named by an absolute path stays where it is, and must be there and say the same where this is written. With `root` the common
    folder holds `root` too.
    """

    def __init__(self, file: FilePath, root: FilePath | None = None) -> None:
        # Not resolved: `..` in a file must lead to the same place elsewhere.
        paths, fixed = files_of(file)
        common = FilePath(os.path.commonpath([*([] if root is None else [root]), *(p.parent for p in paths)]))
        self.name = file.relative_to(common).as_posix()
        self.root = "." if root is None else root.relative_to(common).as_posix()
        self.files = {p.relative_to(common).as_posix(): p.read_bytes() for p in paths}
        self.fixed = {str(p): hashlib.sha256(p.read_bytes()).hexdigest() for p in fixed}

    def write(self, folder: str) -> str:
        """Writes them there; the path of the first."""
        for path, digest in self.fixed.items():
            if not _is_file(FilePath(path)):
                raise ReadError(f"{self.name}: {path} is not on {socket.gethostname()}; {_REMEDY}")
            if hashlib.sha256(FilePath(path).read_bytes()).hexdigest() != digest:
                raise ReadError(f"{self.name}: {path} says something else on {socket.gethostname()}; {_REMEDY}")
        for name, data in self.files.items():
            FilePath(folder, name).parent.mkdir(parents=True, exist_ok=True)
            FilePath(folder, name).write_bytes(data)
        return str(FilePath(folder, self.name))


def _is_file(path: FilePath) -> bool:
    try:
        return path.is_file()
    except OSError:  # a text too long for a name
        return False


def _strings(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, (dict, list)):
        for item in value.values() if isinstance(value, dict) else value:
            yield from _strings(item)
