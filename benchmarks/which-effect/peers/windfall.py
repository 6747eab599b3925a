"""Windfall: `windfall close`, its close.json read back, its model flown through the same held-out error as the peers'."""
import json
import pathlib
import resource
import shutil
import subprocess

from campaigns import Answer
from lander import PARAMETERS
from problem import Problem

RANDOM = ("turbulence", "wake-shedding")
# Exit code of a record that is refused; not being done in time flags nothing.
REFUSED = 2


def close(exe, path, folder, limit_s, threads=1):
    """close.json of a campaign and the processor time; kept in a folder, so that a table can be made again."""
    folder = pathlib.Path(folder)
    meta = folder / "meta.json"
    if not meta.exists():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [exe, "close", str(path), "--out", str(folder), "--force", "--quiet", "--threads", str(threads)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=limit_s, check=False)
            code, words = done.returncode, done.stderr[-400:]
        except subprocess.TimeoutExpired:
            code, words = -1, f"not done in {limit_s} s"
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        meta.write_text(json.dumps({"code": code, "seconds": seconds, "words": words}))
    file = folder / "close.json"
    return json.loads(file.read_text()) if file.exists() else None, json.loads(meta.read_text())


def parameters(lines):
    """Thirteen parameters of the reader from a list of estimates; the yaw equation's own static pair where there is one."""
    by = {(p["coefficient"], p["name"]): p["estimate"] for p in lines}
    any_ = {p["name"]: p["estimate"] for p in lines if p["coefficient"] != "Cn"}
    any_ |= {p["name"]: p["estimate"] for p in lines if p["name"] not in any_}
    own = {"Cn_sin": by.get(("Cn", "Cm_sin"), any_["Cm_sin"]), "Cn_sin3": by.get(("Cn", "Cm_sin3"), any_["Cm_sin3"])}
    return [own.get(n, any_.get(n, 0.0)) for n in PARAMETERS]


def effects(result):
    """Knobs of the reader from the effects that were added and the constants that were found."""
    out = {f"{e['family']}.{p['name']}": p["estimate"] for e in result["effects"] for p in e["parameters"]}
    out = {k: v for k, v in out.items() if k.split(".")[0] not in RANDOM}
    for c in result["constants"]:
        name = constant(c["key"])
        if name:
            out[name] = out.get(name, 0.0) + c["estimate"] - c["declared"]
    return out


def constant(key):
    """Knob of a declared constant; none where the reader has none."""
    table, name, *axis = key.split(".")
    axis = axis[0].lower() if axis else ""
    return {
        "mass_kg": "mass.mass_kg", "inertia_kg_m2": f"inertia.{axis}_kg_m2", "center_of_mass_m": f"center-of-mass.{axis}_m",
        "attachment_m": f"hook.{axis}_m", "ring_m": f"ring.{axis}_m", "drag_area_m2": "tether-geometry.drag_m2",
        "effective_weight_n": "tether-geometry.weight_n", "pose_misalignment_deg": f"pose-misalignment.{axis}_rad",
        "wind_scale": "wind-scale.scale", "length_scale": "length-scale.scale", "time_base": "time-base.rate",
        "pose_delay_s": "pose-delay.delay_s", "wind_delay_s": "wind-delay.delay_s",
    }.get(name)


class Windfall:
    needs_library = False

    def __init__(self, exe, folder, limit_s=600):
        self.exe, self.folder, self.limit_s = exe, pathlib.Path(folder), limit_s

    def __call__(self, case, problem: Problem):
        result, meta = close(self.exe, case.path, self.folder / case.name, self.limit_s)
        if result is None:
            return Answer([], {}, meta["code"] == REFUSED, meta["seconds"], note=f"exit {meta['code']}: {meta['words'].strip().replace(str(case.path), case.name)}")
        form = any((e.get("form") or {}).get("ok") is False for e in result["effects"])
        flagged = result["verdict"] == "unexplained" or bool(result.get("unexplained")) or form
        named = [e["family"] for e in result["effects"]]
        rivals = {e["family"]: e.get("rivals", []) for e in result["effects"]}
        held = problem.held_out(parameters(result["after"]["parameters"]), effects(result))
        return Answer(named, rivals, flagged, meta["seconds"], {"after": held, "own": own_ratio(result)}, result["verdict"])


def own_ratio(result):
    """Force and moment left on held-out runs, after over before, and the same of the flown position, by close.json itself."""
    b, a = (result[k]["hold_out"] for k in ("before", "after"))
    size = lambda v: sum(x * x for x in v) ** 0.5
    return [size(a[k]) / size(b[k]) for k in ("specific_force_rms", "specific_moment_rms")] + [
        a["trajectory"]["position_rms_m"] / b["trajectory"]["position_rms_m"]
    ]
