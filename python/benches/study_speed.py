"""One table of how fast a study is drawn: by hand in numba, by hand on joblib, Windfall on 1 and 2 threads, Windfall on Dask with 2 workers.

In: nothing. Out: a row each: draws a second by the clock, and a core-second (of all processes), best of some rounds that take turns, so that what
else the machine does falls on all alike. By hand: `pip install numpy scipy numba joblib distributed psutil`, this package, then
`python study_speed.py [DRAWS] [ROUNDS]`. The study is study_by_hand.py's: 15 s at 150 Hz, noise, identification by regression.
"""

import contextlib
import importlib
import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import joblib
import lander_peers as peers
import numpy as np
import psutil
import study_by_hand as hand
import windfall
from distributed import Client, LocalCluster
from windfall.distributed import run

SCENARIO = (Path(__file__).parents[2] / "scenarios/bundled/sage-perturbed.toml").read_text()


def by_hand(draws: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.array([hand.identify(hand.record(hand.fly(peers.start()), rng)) for _ in range(draws)])


def cpu_s(others=()) -> float:
    """Processor time of this process, its threads, and those processes."""
    own = resource.getrusage(resource.RUSAGE_SELF)
    times = [p.cpu_times() for p in others]
    return own.ru_utime + own.ru_stime + sum(t.user + t.system for t in times)


@contextlib.contextmanager
def dask() -> Iterator[Client]:
    """Two workers with the package loaded, there only while they draw: a cluster that waits takes processor time, too."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.run(lambda: importlib.import_module("windfall.distributed").__name__)
        yield client


def main(draws: int, rounds: int) -> None:
    by_hand(2, 0)
    children = lambda: psutil.Process().children(recursive=True)  # noqa: E731
    rows: dict[str, list[tuple[float, float]]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "fifteen.toml").write_text(SCENARIO.replace("duration_s = 18.3", "duration_s = 15.0"))
        order = folder / "study.toml"
        head = f'[study]\nname = "noise"\nscenario = "fifteen.toml"\ndraws = {draws}\npart_draws = {draws // 10}\nseed = 1\n'
        order.write_text(head + '[do]\nidentify = ["equation-error"]\n')
        pool = joblib.Parallel(n_jobs=2)
        pool([joblib.delayed(by_hand)(2, n) for n in range(2)])
        share = draws // 10
        alone = contextlib.nullcontext
        ways = {
            "by hand, numba": (alone, lambda out, _: by_hand(draws, 1)),
            "by hand, numba, joblib on 2 processes": (alone, lambda out, _: pool([joblib.delayed(by_hand)(share, n) for n in range(10)])),
            "windfall, 1 thread": (alone, lambda out, _: windfall.study(order, out, threads=1)),
            "windfall, 2 threads": (alone, lambda out, _: windfall.study(order, out, threads=2)),
            "windfall on Dask, 2 workers": (dask, lambda out, client: run(order, client, out)),
        }
        for r in range(rounds):
            for i, (way, (beside, draw)) in enumerate(ways.items()):
                with beside() as client:
                    others = children()
                    begin, before = time.perf_counter(), cpu_s(others)
                    draw(folder / f"out-{r}-{i}", client)
                    took, used = time.perf_counter() - begin, cpu_s(others) - before
                rows.setdefault(way, []).append((draws / took, draws / used))
                print(f"round {r + 1}: {way}: {took:.1f} s", file=sys.stderr, flush=True)
        assert len({(folder / f"out-0-{i}/runs.parquet").read_bytes() for i in (2, 3, 4)}) == 1
    first = max(c for _, c in rows["by hand, numba"])
    print(f"{draws} draws, best of {rounds} rounds; the last three: the same bytes")
    for way, all_rounds in rows.items():
        clock, core = (max(x[k] for x in all_rounds) for k in (0, 1))
        print(f"{way:40} {clock:7.1f} draws/s by the clock {core:7.1f} a core-second, {core / first:.2f} of by hand", flush=True)


if __name__ == "__main__":
    main(*(int(word) for word in (sys.argv[1:] + ["200", "3"][len(sys.argv) - 1 :])))
