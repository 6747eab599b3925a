"""Cluster figures: scheduler traffic and client memory over the number of draws, and many campaigns with workers killed and added.

In: nothing. Out: one line a figure. By hand: `pip install distributed psutil`, this package, then `python cluster.py draws` or
`python cluster.py campaigns`. Draws are 2 s flights identified by equation error; campaigns are closed (2 s flights of the bundled scenario
with other seeds and masses). Traffic is what the scheduler's open connections sent and received, by the system's count.
"""

import json
import os
import random
import resource
import shutil
import sys
import tempfile
import threading
import time
from pathlib import Path

import psutil
import windfall
from distributed import Client, LocalCluster
from windfall.distributed import many, run

SCENARIO = (Path(__file__).parents[2] / "scenarios/bundled/sage-perturbed.toml").read_text()
SHORT = SCENARIO.replace("duration_s = 18.3", "duration_s = 2.0").replace("rate_hz = 150.0", "rate_hz = 100.0")


def study(folder: Path, draws: int) -> Path:
    (folder / "short.toml").write_text(SHORT)
    path = folder / f"study-{draws}.toml"
    head = f'[study]\nname = "cheap"\nscenario = "short.toml"\ndraws = {draws}\nseed = 1\npart_draws = 100\n'
    path.write_text(head + '[do]\nidentify = ["equation-error"]\n')
    return path


def scheduler_bytes(client: Client) -> int:
    """Bytes that the scheduler's open connections sent and received, as the system counts them."""

    def count():
        import socket
        import struct

        total = 0
        for fd in os.listdir("/proc/self/fd"):
            try:
                copy = os.dup(int(fd))
                with socket.socket(fileno=copy) as s:
                    if s.family in (socket.AF_INET, socket.AF_INET6):
                        # tcp_info (11): bytes acknowledged and received at 120 and 128.
                        total += sum(struct.unpack_from("QQ", s.getsockopt(socket.IPPROTO_TCP, 11, 256), 120))
            except OSError:  # closed meanwhile, or no socket
                continue
        return total

    return client.run_on_scheduler(count)


def draws(sizes=(1_000, 10_000, 100_000)):
    """One client process for each size: its peak is its own."""
    if len(sys.argv) > 2:
        return one(int(sys.argv[2]))
    for size in sizes:
        os.spawnv(os.P_WAIT, sys.executable, [sys.executable, __file__, "draws", str(size)])


def one(size: int):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        # The scheduler in a process of its own, so that its traffic and the client's memory are told apart.
        import subprocess

        schedule = folder / "scheduler.json"
        words = ["--scheduler-file", str(schedule)]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        cli = str(Path(sys.executable).parent / "dask")
        scheduler = subprocess.Popen([cli, "scheduler", "--port", "0", "--no-dashboard", *words], **quiet)
        worker = [cli, "worker", "--nthreads", "1", "--no-dashboard", *words]
        workers = [subprocess.Popen(worker, **quiet, cwd=folder) for _ in range(2)]
        try:
            with Client(scheduler_file=str(schedule)) as client:
                client.wait_for_workers(2)
                path = study(folder, size)
                before, memory = scheduler_bytes(client), psutil.Process().memory_info().rss
                begin = time.perf_counter()
                run(path, client, folder / "out")
                took = time.perf_counter() - begin
                traffic = scheduler_bytes(client) - before
                peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
                parts = -(-size // 100)
                print(
                    f"{size} draws: {took:.1f} s, scheduler {traffic / 1e6:.2f} MB ({traffic / parts / 1e3:.1f} kB a part), client peak "
                    f"{peak / 1e6:.0f} MB ({(peak - memory) / 1e6:.0f} MB above its start)",
                    flush=True,
                )
        finally:
            for process in (*workers, scheduler):
                process.kill()


def campaigns(count=100, seed=5):
    chance = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for k in range(count):
            own = folder / "all" / f"c{k:03}"
            (own / "scenario.toml").parent.mkdir(parents=True)
            (own / "scenario.toml").write_text(SHORT)
            os.spawnv(
                os.P_WAIT,
                str(Path(sys.executable).parent / "windfall"),
                [
                    "windfall",
                    "simulate",
                    str(own / "scenario.toml"),
                    "--seed",
                    str(k + 1),
                    "--out",
                    str(own),
                    "--force",
                    "--quiet",
                ],
            )
        begin = time.perf_counter()
        alone = windfall.many("close", folder / "all", folder / "one", threads=2)
        print(
            f"alone, 2 threads: {time.perf_counter() - begin:.0f} s; verdicts {alone['verdicts']}, {alone['failed']} failed",
            flush=True,
        )
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            over, events = threading.Event(), []

            def trouble():
                """Every few seconds a worker is killed; twice the cluster is made larger by one, and smaller again."""
                for n in range(6):
                    while len(list((folder / "many/results").glob("*/outcome.json"))) < (n + 1) * count // 8:
                        if over.wait(0.05):
                            return
                    if n in (1, 3):
                        cluster.scale(3)
                        events.append("added")
                    else:
                        pid = chance.choice(list(client.run(os.getpid).values()))
                        os.kill(pid, 9)
                        events.append("killed")
                    if n in (2, 4):
                        cluster.scale(2)

            thread = threading.Thread(target=trouble, daemon=True)
            thread.start()
            begin = time.perf_counter()
            together = many("close", folder / "all", client, folder / "many")
            over.set()
            thread.join()
            print(f"cluster: {time.perf_counter() - begin:.0f} s; workers {', '.join(events)}", flush=True)
        tree = lambda f: {str(p.relative_to(f)): p.read_bytes() for p in f.rglob("*") if p.is_file()}  # noqa: E731
        same = tree(folder / "one") == tree(folder / "many")
        print(f"{together['campaigns']} campaigns, {len(tree(folder / 'one'))} files, same bytes: {same}", flush=True)
        if not same:
            shutil.copytree(folder, Path.cwd() / "different")
        print(json.dumps(alone["families"]))


if __name__ == "__main__":
    {"draws": draws, "campaigns": campaigns}[sys.argv[1]]()
