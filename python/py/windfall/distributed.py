"""Studies, and many campaigns, on a Dask cluster: pieces of work to workers, the same bytes as on one machine.

A part of a study is a function of (study, part) alone, so a part whose worker died is simply drawn again elsewhere. The study's
files travel with the work; workers need this package and nothing of the client's file system. Parts land in the client's folder
as they come: a client that dies goes on with `resume=True`. Campaigns are handed out in the same way, one at a time.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import tomllib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _each, _paths, _windfall

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["many", "run"]

Pack = tuple[str, tuple[tuple[str, bytes], ...]]
CampaignPack = tuple[str, str, tuple[tuple[str, bytes], ...]]

_ready: dict[str, tuple[_windfall.Study, tempfile.TemporaryDirectory[str]]] = {}


def run(
    study: str | os.PathLike[str],
    client: Client,
    out: str | os.PathLike[str],
    *,
    resume: bool = False,
    force: bool = False,
    ahead: int = 4,
) -> dict[str, Any]:
    """Draw a study on the workers of `client` into the folder `out`; the content of summary.json.

    `ahead` parts per thread are handed out at a time, so that neither scheduler nor client holds more than that.
    """
    order = _windfall.Study(os.fspath(study))
    order.open(os.fspath(out), json.dumps({"resume": resume, "force": force}))
    # Plain values in the task: a worker that is lost takes no data with it.
    pack = _pack(Path(study))
    _hand_out(client, iter(order.missing()), ahead, lambda part: (_draw, pack, part), order.put)
    summary: dict[str, Any] = json.loads(order.finish())
    return summary


def many(
    verb: str,
    campaigns: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    client: Client,
    out: str | os.PathLike[str],
    *,
    resume: bool = False,
    force: bool = False,
    ahead: int = 2,
    **request: Any,
) -> dict[str, Any]:
    """Do `close` or `identify` for many campaigns on the workers of `client`, as `windfall.many` does here; the content of many.json.

    `ahead` campaigns per thread are handed out at a time, with their files.
    """
    each = _each(verb, request)
    order = _windfall.Many(_paths(campaigns), each)
    order.open(os.fspath(out), json.dumps({"resume": resume, "force": force}))
    root, names = order.root, order.campaigns

    def task(number: int) -> tuple[Any, ...]:
        return _one, each, _campaign_pack(root, names[number]), number

    def put(number: int, done: tuple[str, str, tuple[str, str] | None]) -> None:
        order.put(number, *done)

    _hand_out(client, iter(order.missing()), ahead, task, put)
    summary: dict[str, Any] = json.loads(order.finish())
    return summary


def _hand_out(
    client: Client,
    missing: Iterator[int],
    ahead: int,
    task: Callable[[int], tuple[Any, ...]],
    put: Callable[[int, Any], bool | None],
) -> None:
    """Hands out pieces of work by number and puts what comes back; ends early when `put` says that it is enough."""
    from distributed import as_completed

    word = os.urandom(8).hex()

    def submit(number: int) -> Any:
        return client.submit(*task(number), pure=False, retries=3, key=f"windfall-{word}-{number}")

    lanes = ahead * max(1, sum(client.nthreads().values()))
    first = [submit(number) for _, number in zip(range(lanes), missing)]
    under_way = set(first)
    done = as_completed(first, with_results=True)
    for future, (number, data) in done:
        under_way.discard(future)
        if put(number, data):
            client.cancel(list(under_way))
            break
        if (number := next(missing, None)) is not None:
            following = submit(number)
            under_way.add(following)
            done.add(following)


def _one(each: str, pack: CampaignPack, number: int) -> tuple[int, tuple[str, str, tuple[str, str] | None]]:
    """On a worker: one campaign, in a folder of its own."""
    root, name, files = pack
    with tempfile.TemporaryDirectory(prefix="windfall-") as folder:
        for path, data in files:
            Path(folder, path).parent.mkdir(parents=True, exist_ok=True)
            Path(folder, path).write_bytes(data)
        below = Path(folder, root)
        below.mkdir(parents=True, exist_ok=True)
        return number, _windfall.Many.at(str(below), [name], each).one(0)


def _campaign_pack(root: Path, name: str) -> CampaignPack:
    """A campaign file and every file that it names, with paths below their common folder; the root within that."""
    paths = _named(root / name)
    # Not resolved: `..` in the file must lead to the same place on the worker.
    common = Path(os.path.commonpath([root, *(p.parent for p in paths)]))
    files = tuple((p.relative_to(common).as_posix(), p.read_bytes()) for p in paths)
    return root.relative_to(common).as_posix(), name, files


def _named(file: Path) -> list[Path]:
    """A file, and those that strings in it name if it is TOML, and so on."""
    found = [file]
    for path in found:
        if path.suffix == ".toml":
            try:
                strings = _strings(tomllib.loads(path.read_text(encoding="utf-8")))
            except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
                continue  # the reader says what is wrong with it
            below = (Path(os.path.normpath(path.parent / s)) for s in strings if "\0" not in s)
            found += [p for p in dict.fromkeys(below) if p not in found and _is_file(p)]
    return found


def _is_file(path: Path) -> bool:
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


def _draw(pack: Pack, part: int) -> tuple[int, bytes]:
    """On a worker: one part, with the study read once per process."""
    key, files = pack
    if key not in _ready:
        folder = tempfile.TemporaryDirectory(prefix="windfall-")
        for name, data in files:
            path = Path(folder.name, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        _ready[key] = (_windfall.Study(str(Path(folder.name, files[0][0]))), folder)
    return part, _ready[key][0].part(part)


def _pack(study: Path) -> Pack:
    """The study file first, then every file that it names, with paths below their common folder."""
    paths = _files(study.resolve())
    root = Path(os.path.commonpath([p.parent for p in paths]))
    files = tuple((p.relative_to(root).as_posix(), p.read_bytes()) for p in paths)
    return hashlib.sha256(repr(files).encode()).hexdigest(), files


def _files(study: Path) -> list[Path]:
    text = tomllib.loads(study.read_text(encoding="utf-8"))
    head, here, paths = text.get("study", {}), study.parent, [study]
    scenario = head.get("scenario")
    base = [scenario] if scenario and any(c in scenario for c in "/\\.") else []
    for name in base + [head[k] for k in ("campaign", "model") if k in head]:
        path = (here / name).resolve()
        paths.append(path)
        if path.suffix == ".toml":
            inner = tomllib.loads(path.read_text(encoding="utf-8"))
            named = [run["file"] for run in inner.get("run", [])]
            named += [aero["structure"] for aero in inner.get("aero", {}).values() if "structure" in aero]
            paths += [(path.parent / n).resolve() for n in named]
    paths += [(here / name).resolve() for name in text.get("histories", {}).get("files", [])]
    return list(dict.fromkeys(paths))
