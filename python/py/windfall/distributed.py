"""Studies, and many campaigns, on a Dask cluster: pieces of work to workers, the same bytes as on one machine.

A part of a study is a function of (study, part) alone, so a part whose worker died is simply drawn again elsewhere. The study's
files travel to each worker once; workers need this package and nothing of the client's file system. Parts land in the client's folder
as they come: a client that dies goes on with `resume=True`. Campaigns are handed out in the same way, one at a time.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import os
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import Document, _each, _inputs, _paths, _windfall
from .results import Many, Study

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["many", "run"]

#: On a worker: files of studies by name, and studies that were read.
_packs: dict[str, _inputs.Packed] = {}
_ready: dict[str, tuple[_windfall.Study, tempfile.TemporaryDirectory[str]]] = {}


def run(
    study: Document,
    client: Client,
    out: str | os.PathLike[str],
    *,
    resume: bool = False,
    force: bool = False,
    ahead: int = 4,
    direct: bool = True,
) -> Study:
    """Draw a study on the workers of `client` into the folder `out`; the content of summary.json.

    `ahead` parts per thread are handed out at a time, so that neither scheduler nor client holds more than that; workers may come and go.
    The study's files are sent to each worker once, also to those that come later. A worker with another build of this package is an error.
    What is drawn comes straight from the workers; `direct=False` where the client cannot reach them, and it goes through the scheduler.
    """
    with _inputs.document(study, "study") as (path, _):
        order = _windfall.Study(path)
        order.open(os.fspath(out), json.dumps({"resume": resume, "force": force}))
        files = _files_for_workers(_inputs.Packed(Path(os.path.abspath(path))))
        client.register_plugin(files, name=files.name)
        try:
            task = (_draw, files.name, _build())
            _hand_out(client, iter(order.missing()), ahead, direct, lambda part: (*task, part), order.put)
        finally:
            client.unregister_worker_plugin(files.name)
        return Study(json.loads(order.finish()))


def many(
    verb: str,
    campaigns: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    client: Client,
    out: str | os.PathLike[str],
    *,
    resume: bool = False,
    force: bool = False,
    ahead: int = 2,
    direct: bool = True,
    **request: Any,
) -> Many:
    """Do `close` or `identify` for many campaigns on the workers of `client`, as `windfall.many` does here; the content of many.json.

    `ahead` campaigns per thread are handed out at a time, with their files.
    """
    each = _each(verb, request)
    order = _windfall.Many(_paths(campaigns), each)
    order.open(os.fspath(out), json.dumps({"resume": resume, "force": force}))
    root, names = order.root, order.campaigns

    def task(number: int) -> tuple[Any, ...]:
        return _one, each, names[number], _inputs.Packed(root / names[number], root), number

    def put(number: int, done: tuple[str, str, tuple[str, str] | None]) -> None:
        order.put(number, *done)

    _hand_out(client, iter(order.missing()), ahead, direct, task, put)
    return Many(json.loads(order.finish()))


def _hand_out(
    client: Client,
    missing: Iterator[int],
    ahead: int,
    direct: bool,
    task: Callable[[int], tuple[Any, ...]],
    put: Callable[[int, Any], bool | None],
) -> None:
    """Hands out pieces of work by number and puts what comes back; ends early when `put` says that it is enough."""
    from distributed import as_completed

    word = os.urandom(8).hex()

    def submit(number: int) -> Any:
        return client.submit(*task(number), pure=False, retries=3, key=f"windfall-{word}-{number}")

    lanes = _Lanes(client, ahead)
    under_way = {submit(number) for _, number in zip(range(lanes.count()), missing)}
    done = as_completed(list(under_way))
    for batch in done.batches():
        arrived = list(batch)
        under_way.difference_update(arrived)
        pieces = client.gather(arrived, direct=direct)
        enough = [number for number, data in pieces if put(number, data)]
        # What a worker keeps for a future goes with the future.
        del arrived, batch, pieces
        if enough:
            client.cancel(list(under_way))
            break
        for following in itertools.islice(missing, max(0, lanes.count() - len(under_way))):
            under_way.add(submitted := submit(following))
            done.add(submitted)


class _Lanes:
    """How much is handed out at a time: so much per thread of the cluster, which is looked at again every second."""

    def __init__(self, client: Client, ahead: int) -> None:
        self.client, self.ahead, self.seen, self.threads = client, ahead, -math.inf, 0

    def count(self) -> int:
        if time.monotonic() - self.seen > 1.0:
            self.seen, self.threads = time.monotonic(), sum(self.client.nthreads().values())
        return self.ahead * max(1, self.threads)


def _files_for_workers(pack: _inputs.Packed) -> Any:
    from distributed import WorkerPlugin

    class Files(WorkerPlugin):
        """Puts a study's files where the worker's tasks find them."""

        name = f"windfall-{os.urandom(8).hex()}"

        # The class goes to workers by value: the module is looked up there.
        def setup(self, worker: Any) -> None:
            import windfall.distributed as there

            there._packs[self.name] = pack

        def teardown(self, worker: Any) -> None:
            import windfall.distributed as there

            there._packs.pop(self.name, None)
            there._ready.pop(self.name, None)

    return Files()


@lru_cache(maxsize=1)
def _build() -> str:
    """What tells two builds apart, also those of one version."""
    return hashlib.sha256(Path(_windfall.__file__).read_bytes()).hexdigest()


def _one(each: str, name: str, pack: _inputs.Packed, number: int) -> tuple[int, tuple[str, str, tuple[str, str] | None]]:
    """On a worker: one campaign, in a folder of its own."""
    with tempfile.TemporaryDirectory(prefix="windfall-") as folder:
        pack.write(folder)
        below = Path(folder, pack.root)
        below.mkdir(parents=True, exist_ok=True)
        return number, _windfall.Many.at(str(below), [name], each).one(0)


def _draw(name: str, build: str, part: int) -> tuple[int, bytes]:
    """On a worker: one part, with the study read once per process."""
    if build != _build():
        from distributed import get_worker

        raise _windfall.StudyError(f"worker {get_worker().address} has another build of windfall than the client; install the same on all")
    if name not in _ready:
        folder = tempfile.TemporaryDirectory(prefix="windfall-")
        _ready[name] = (_windfall.Study(_packs[name].write(folder.name)), folder)
    return part, _ready[name][0].part(part)
