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
import re
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import Document, _each, _inputs, _paths, _progress, _windfall
from .results import Many, Study

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["many", "partition", "run"]

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
    progress: bool = False,
) -> Study:
    """Draw a study on the workers of `client` into the folder `out`; the content of summary.json.

    `ahead` parts per thread are handed out at a time, so that neither scheduler nor client holds more than that; workers may come and go.
    The study's files are sent to each worker once, also to those that come later; a file that one of them names by an absolute path must be there on the worker and say the same.
    A worker on which a part fails, as one with another build of this package does, is retired and named in a warning, and others draw its
    parts. A part that fails on three workers or on all is an error. `progress=True` shows a bar by tqdm.
    What is drawn comes straight from the workers; `direct=False` where the client cannot reach them, and it goes through the scheduler.
    """
    with _inputs.document(study, "study") as (path, _):
        order = _windfall.Study(path)
        order.open(os.fspath(out), json.dumps({"resume": resume, "force": force}))
        files = _files_for_workers(_inputs.Packed(Path(os.path.abspath(path))))
        client.register_plugin(files, name=files.name)
        try:
            work = _Work(order.missing(), lambda part: (_draw, files.name, part), order.put)
            with _progress.shown(progress, "part", lambda: work.done, work.all):
                _hand_out(client, work, ahead, direct)
        finally:
            client.unregister_worker_plugin(files.name)
        return Study.told(*order.finish())


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
    shared: str | os.PathLike[str] | None = None,
    progress: bool = False,
    **request: Any,
) -> Many:
    """Do `close` or `identify` for many campaigns on the workers of `client`, as `windfall.many` does here; the content of many.json.

    `ahead` campaigns per thread are handed out at a time, with their files; with `shared`, the path under which the workers see the folder
    of the campaigns, they are read there and nothing is sent. Workers on which something fails are treated as by `run`.
    """
    each = _each(verb, request)
    order = _windfall.Many(_paths(campaigns), each)
    order.open(os.fspath(out), json.dumps({"resume": resume, "force": force}))
    root, names = order.root, order.campaigns

    def task(number: int) -> tuple[Any, ...]:
        if shared is not None:
            return _there, each, names[number], os.fspath(shared)
        return _one, each, names[number], _inputs.Packed(root / names[number], root)

    def put(number: int, done: tuple[str, str, tuple[str, str] | None]) -> None:
        order.put(number, *done)

    work = _Work(order.missing(), task, put)
    with _progress.shown(progress, "campaign", lambda: work.done, work.all):
        _hand_out(client, work, ahead, direct)
    return Many.told(*order.finish())


def partition(
    out: str | os.PathLike[str], address: str | os.PathLike[str], *, rows: int = 65_536, force: bool = False
) -> list[str]:
    """Write a finished study's `runs.parquet` of the folder `out` as files of about so many rows each; their names.

    `address` is a folder or what fsspec takes (`s3://bucket/study`): polars, DuckDB, Spark and Dask read it as one table. Files are
    `part-000000.parquet` and so on, in the order of draws, with whole row groups of `runs.parquet` (4096 rows, or a part of the study).
    What is there already is an error; with `force` parts are written over. Needs pyarrow and fsspec.
    """
    import fsspec  # type: ignore[import-untyped, unused-ignore]
    import pyarrow.parquet as parquet  # type: ignore[import-untyped, unused-ignore]

    if rows < 1:
        raise ValueError(f"rows = {rows}: must be at least 1")
    store, root = fsspec.core.url_to_fs(os.fspath(address))
    there = store.ls(root, detail=False) if store.exists(root) else []
    if there and not force:
        raise _windfall.WriteError(f"{address}: is not empty; try: another address, or force=True")
    store.makedirs(root, exist_ok=True)
    with parquet.ParquetFile(Path(out, "runs.parquet")) as runs:
        files: list[list[int]] = []
        space = 0
        for group in range(runs.num_row_groups):
            size = runs.metadata.row_group(group).num_rows
            if space < size:
                files.append([])
                space = max(rows, size)
            files[-1].append(group)
            space -= size
        names = [f"{root}/part-{number:06}.parquet" for number in range(len(files))]
        for name, groups in zip(names, files):
            with store.open(name, "wb") as file:
                parquet.write_table(runs.read_row_groups(groups), file)
    for name in there:
        if re.fullmatch(r"part-\d{6,}\.parquet", name.rpartition("/")[2]) and name not in names:
            store.rm(name)
    return names


class _Work:
    """Pieces of work by number: what a worker does for each, and what is done with what comes back, which says when it is enough."""

    def __init__(
        self, missing: Sequence[int], task: Callable[[int], tuple[Any, ...]], put: Callable[[int, Any], bool | None]
    ) -> None:
        self.missing, self.task, self._put, self.all, self.done = iter(missing), task, put, len(missing), 0

    def put(self, number: int, data: Any) -> bool:
        self.done += 1
        return bool(self._put(number, data))


def _hand_out(client: Client, work: _Work, ahead: int, direct: bool) -> None:
    """Hands out pieces of work and puts what comes back, until it is enough."""
    from distributed import as_completed

    word, count, build = os.urandom(8).hex(), itertools.count(), _build()
    numbers: dict[str, int] = {}
    troubles = _Troubles(client)

    def submit(number: int) -> Any:
        key = f"windfall-{word}-{number}-{next(count)}"
        numbers[key] = number
        return client.submit(_with_build, build, *work.task(number), pure=False, retries=0, key=key)

    lanes = _Lanes(client, ahead)
    under_way = {submit(number) for _, number in zip(range(lanes.count()), work.missing)}
    done = as_completed(list(under_way))
    for batch in done.batches():
        arrived = list(batch)
        under_way.difference_update(arrived)
        failed = [future for future in arrived if future.status == "error"]
        fine = [future for future in arrived if future.status != "error"]
        pieces = dict(zip([numbers.pop(future.key) for future in fine], client.gather(fine, direct=direct)))
        enough = [number for number, data in pieces.items() if work.put(number, data)]
        again = [] if enough else [troubles.elsewhere(numbers.pop(future.key), future) for future in failed]
        # What a worker keeps for a future goes with the future.
        del arrived, batch, failed, fine, pieces
        if enough:
            client.cancel(list(under_way))
            break
        more = itertools.islice(work.missing, max(0, lanes.count() - len(under_way) - len(again)))
        for following in itertools.chain(again, more):
            under_way.add(submitted := submit(following))
            done.add(submitted)


class _Troubles:
    """Workers on which pieces failed: each is retired and named, and the piece goes elsewhere."""

    #: A piece that fails on so many workers is at fault itself.
    MOST = 3

    def __init__(self, client: Client) -> None:
        self.client = client
        self.retired: set[str] = set()
        self.failed_on: dict[int, set[str]] = {}

    def elsewhere(self, number: int, future: Any) -> int:
        """The number of a piece that is to be tried again; its error where that makes no sense."""
        key = future.key
        # A function in a function goes by value: the scheduler need not have this package.
        where = self.client.run_on_scheduler(lambda dask_scheduler: list(dask_scheduler.tasks[key].erred_on or ()))
        failed_on = self.failed_on.setdefault(number, set())
        failed_on.update(where)
        left = set(self.client.nthreads()) - self.retired - failed_on
        # Without a name it was no error of one worker: each that tried it died.
        if not where or not left or len(failed_on) >= self.MOST:
            raise future.exception()
        for worker in failed_on - self.retired:
            self.retired.add(worker)
            error = future.exception()
            _inputs.warn([f"worker {worker} is retired, others do its work: {type(error).__name__}: {error}"])
            self.client.retire_workers([worker])
        return number


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


def _with_build(build: str, work: Callable[..., Any], *given: Any) -> Any:
    """On a worker: a piece of work, if it would be done as the client does it."""
    if build != _build():
        raise _windfall.StudyError("has another build of windfall than the client; install the same on all workers")
    return work(*given)


def _one(each: str, name: str, pack: _inputs.Packed) -> tuple[str, str, tuple[str, str] | None]:
    """On a worker: one campaign, in a folder of its own."""
    with tempfile.TemporaryDirectory(prefix="windfall-") as folder:
        pack.write(folder)
        below = Path(folder, pack.root)
        below.mkdir(parents=True, exist_ok=True)
        return _there(each, name, str(below))


def _there(each: str, name: str, root: str) -> tuple[str, str, tuple[str, str] | None]:
    """On a worker: one campaign where it lies."""
    return _windfall.Many.at(root, [name], each).one(0)


def _draw(name: str, part: int) -> bytes:
    """On a worker: one part, with the study read once per process."""
    if name not in _ready:
        folder = tempfile.TemporaryDirectory(prefix="windfall-")
        _ready[name] = (_windfall.Study(_packs[name].write(folder.name)), folder)
    return _ready[name][0].part(part)
