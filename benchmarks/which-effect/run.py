"""What does the declared model lack, or refuse: every method on every campaign of a folder, and the table.

  python benchmarks/which-effect/run.py --campaigns DIR --windfall EXE --out table
"""
import argparse
import dataclasses
import hashlib
import json
import math
import os
import pathlib
import statistics

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import measured
from campaigns import OUTCOMES, Answer, cases, outcome
from peers.regression import RULES, Regression
from peers.shape_free import GaussianProcess, Polynomial
from peers.windfall import Windfall
from problem import Problem

HERE = pathlib.Path(__file__).parent
MANIFEST = HERE / "manifest.json"


def methods(v):
    peers = {name: Regression(name) for name in RULES} | {p.name: p() for p in (Polynomial, GaussianProcess)}
    every = ({"Windfall": Windfall(v.windfall, v.work / "windfall", v.limit)} if v.windfall else {}) | peers
    return {n: m for n, m in every.items() if not v.methods or any(part in n for part in v.methods)}


def digest(case):
    """Fingerprint of a campaign: its file and its runs."""
    sha = hashlib.sha256()
    for file in sorted(case.path.parent.iterdir()):
        sha.update(file.name.encode() + file.read_bytes())
    return sha.hexdigest()[:16]


def evaluate(case, chosen, folder, fresh):
    """Rows of one campaign: what is already in its file is not done again."""
    file = folder / f"{case.name}.json"
    kept = {} if fresh or not file.exists() else json.loads(file.read_text())
    todo = {n: m for n, m in chosen.items() if n not in kept}
    if not todo:
        return kept
    before = next((r["before"] for r in kept.values()), None)
    problem = Problem(case.path, library=before is None or any(getattr(m, "needs_library", True) for m in todo.values()))
    if before is None:
        fit = problem.refit([])
        before = problem.held_out(fit.theta, fit.effects)
    for name, method in todo.items():
        answer = method(case, problem)
        kept[name] = dataclasses.asdict(answer) | {"outcome": outcome(case, answer), "before": before}
        file.write_text(json.dumps(kept, indent=1))
    return kept


def rescored(case, row):
    fields = {f.name: row[f.name] for f in dataclasses.fields(Answer)}
    return row | {"outcome": outcome(case, Answer(**fields))}


def mean_ratio(rows, k):
    """Geometric mean of held-out error after over before."""
    logs = [math.log(r["held_out"]["after"][k] / r["before"][k]) for r in rows if r["held_out"].get("after") and r["before"]]
    return math.exp(statistics.fmean(logs)) if logs else float("nan")


def table(results, names):
    """Markdown: a row for each method over all campaigns, then one table of right answers by group."""
    lines = ["| method | n | right | wrong | refused | missed | force, after/before | moment, after/before | median s |", "|---|---|---|---|---|---|---|---|---|"]
    for m in names:
        rows = [(c, r[m]) for c, r in results if m in r]
        count = {o: sum(r["outcome"] == o for _, r in rows) for o in OUTCOMES}
        acting = [r for c, r in rows if c.wanted not in (["none"], ["unexplained"])]
        seconds = statistics.median(r["seconds"] for _, r in rows) if rows else float("nan")
        lines.append(f"| {m} | {len(rows)} | " + " | ".join(str(count[o]) for o in OUTCOMES) + f" | {mean_ratio(acting, 0):.2f} | {mean_ratio(acting, 1):.2f} | {seconds:.1f} |")
    groups = sorted({c.group for c, _ in results})
    lines += ["", "Right by group:", "", "| method | " + " | ".join(groups) + " |", "|---" * (len(groups) + 1) + "|"]
    for m in names:
        cell = lambda g: [r[m]["outcome"] == "right" for c, r in results if c.group == g and m in r]
        lines.append(f"| {m} | " + " | ".join(f"{sum(cell(g))} of {len(cell(g))}" for g in groups) + " |")
    return "\n".join(lines)


def told(case, row):
    what = "+".join(row["named"]) or ("something unexplained" if row["flagged"] else "nothing")
    flag = ", flagged" if row["named"] and row["flagged"] else ""
    note = f" ({row['note']})" if row["note"].startswith("exit") else ""
    return f"{case.name} ({case.what}): {row['outcome']}; put in {'+'.join(case.wanted)}, named {what}{flag}{note}"


def details(results, names):
    lines = []
    for m in names:
        bad = [told(c, r[m]) for c, r in results if m in r and r[m]["outcome"] != "right"]
        lines += ["", f"{m}, all that is not right:", "", *(f"- {b}" for b in bad)]
    return "\n".join(lines)


def own_errors(results):
    """Windfall's own held-out figures from close.json: force, moment and flown position, geometric means."""
    rows = [r["Windfall"]["held_out"]["own"] for c, r in results if r.get("Windfall", {}).get("held_out", {}).get("own") and c.wanted not in (["none"], ["unexplained"])]
    if not rows:
        return ""
    means = [math.exp(statistics.fmean(math.log(r[k]) for r in rows)) for k in range(3)]
    return "\nWindfall's close.json, after/before where something acts: force {:.2f}, moment {:.2f}, flown position {:.3f}.".format(*means)


def manifest(found, write):
    """Says which campaigns are the ones of the published table."""
    here = {c.name: {"group": c.group, "what": c.what, "answer": c.wanted, "sha256_16": digest(c)} for c in found}
    if write:
        MANIFEST.write_text(json.dumps(here, indent=1) + "\n")
    known = json.loads(MANIFEST.read_text()) if MANIFEST.exists() else {}
    same = sum(known.get(n, {}).get("sha256_16") == v["sha256_16"] for n, v in here.items())
    return f"{same} of {len(known)} campaigns of the manifest are here, {len(here) - same} others.\n"


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--campaigns", type=pathlib.Path, action="append", default=[], help="folder with answers.json at or below it; may be repeated")
    p.add_argument("--measured", type=pathlib.Path, action="append", default=[], help="folder with measured sets; may be repeated")
    p.add_argument("--windfall", help="the program; without it the peers alone")
    p.add_argument("--out", type=pathlib.Path, required=True)
    p.add_argument("--limit", type=float, default=600, help="seconds that one `windfall close` may take")
    p.add_argument("--only", nargs="*", default=[], help="parts of campaigns' names")
    p.add_argument("--methods", nargs="*", default=[], help="parts of methods' names; default all")
    p.add_argument("--fresh", action="store_true", help="do again what is already in --out")
    p.add_argument("--write-manifest", action="store_true")
    v = p.parse_args()
    v.work = v.out / "work"
    v.work.mkdir(parents=True, exist_ok=True)
    text = ""
    if v.campaigns:
        found = [c for root in v.campaigns for c in cases(root, v.only)]
        chosen, results = methods(v), []
        for case in found:
            rows = {m: rescored(case, r) for m, r in evaluate(case, chosen, v.work, v.fresh).items() if m in chosen}
            results.append((case, rows))
            print(case.name, "+".join(case.wanted), {m: r["outcome"] for m, r in rows.items()}, flush=True)
        text += manifest(found, v.write_manifest) + "\n" + table(results, list(chosen)) + "\n" + own_errors(results) + "\n" + details(results, list(chosen)) + "\n"
    if v.measured and v.windfall:
        text += "\n" + measured.tables(v.measured, v.windfall, v.work / "measured") + "\n"
    (v.out / "table.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
