"""A bar for long work, in the terminal and in notebooks, by tqdm where it is wanted."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["files", "shown"]


@contextmanager
def shown(wanted: bool, unit: str, done: Callable[[], int], total: int) -> Iterator[None]:
    """A bar while the block is at work, if wanted; `done` says how much of `total` is."""
    if not wanted:
        yield
        return
    from tqdm.auto import tqdm  # type: ignore[import-not-found, import-untyped, unused-ignore]

    over = threading.Event()
    with tqdm(unit=unit, total=total) as bar:

        def watch() -> None:
            # To look takes a tenth of the time at most.
            took = 0.0
            while not over.wait(max(0.2, 9.0 * took)):
                begin = time.monotonic()
                bar.update(done() - bar.n)
                took = time.monotonic() - begin

        watcher = threading.Thread(target=watch, daemon=True)
        watcher.start()
        try:
            yield
        finally:
            over.set()
            watcher.join()
            bar.update(done() - bar.n)
            bar.refresh()


def files(out: str | os.PathLike[str], below: str, ending: str) -> Callable[[], int]:
    """Counts the files of an ending below a folder of results."""
    return lambda: sum(name.endswith(ending) for _, _, names in os.walk(os.path.join(out, below)) for name in names)
