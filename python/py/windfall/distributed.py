"""Studies on a Dask cluster: index ranges to workers, the same bytes as on one machine.

A part of a study is a function of (study, part) alone, so a part whose worker died is simply drawn again elsewhere. The study's
files travel with the work; workers need this package and nothing of the client's file system. Parts land in the client's folder
as they come: a client that dies goes on with `resume=True`.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _windfall

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["run"]

Pack = tuple[str, tuple[tuple[str, bytes], ...]]

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
    from distributed import as_completed

    order = _windfall.Study(os.fspath(study))
    order.open(os.fspath(out), json.dumps({"resume": resume, "force": force}))
    missing = iter(order.missing())
    # Plain values in the task: a worker that is lost takes no data with it.
    pack = _pack(Path(study))

    def submit(part: int) -> Any:
        return client.submit(_draw, pack, part, pure=False, retries=3, key=f"windfall-{pack[0][-16:]}-{os.urandom(4).hex()}-{part}")

    lanes = ahead * max(1, sum(client.nthreads().values()))
    first = [submit(part) for _, part in zip(range(lanes), missing)]
    under_way = set(first)
    done = as_completed(first, with_results=True)
    for future, (part, data) in done:
        under_way.discard(future)
        if order.put(part, data):
            client.cancel(list(under_way))
            break
        if (part := next(missing, None)) is not None:
            following = submit(part)
            under_way.add(following)
            done.add(following)
    summary: dict[str, Any] = json.loads(order.finish())
    return summary


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
