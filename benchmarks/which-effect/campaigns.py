"""Campaigns with answers below a folder, and the scoring rule."""
import dataclasses
import json
import pathlib

# Counted as outside the catalogue by the campaigns' author, yet families of it: named by themselves they are right.
ALSO_FAMILIES = ("time-base", "length-scale", "swivel-friction", "mass")
OUTCOMES = ("right", "wrong", "refused", "missed")


@dataclasses.dataclass
class Case:
    """A campaign file and what was put into it: families, nothing ("none") or something outside the catalogue ("unexplained")."""

    name: str
    path: pathlib.Path
    group: str
    what: str
    wanted: list
    rivals: list
    form: str = ""


@dataclasses.dataclass
class Answer:
    """What a method says of a campaign. `flagged`: something is left that it does not name, or it will not read the record."""

    named: list
    rivals: dict
    flagged: bool
    seconds: float
    held_out: dict = dataclasses.field(default_factory=dict)
    note: str = ""


def cases(root, only=()):
    """All campaigns that an answers.json at or below the folder lists."""
    out = []
    for file in sorted(pathlib.Path(root).rglob("answers.json")):
        for a in json.loads(file.read_text()):
            path = file.parent / a["name"] / "campaign.toml"
            if path.exists() and (not only or any(n in a["name"] for n in only)):
                wanted = [a["family"]] if isinstance(a["family"], str) else list(a["family"])
                out.append(Case(a["name"], path, a.get("group", "open"), a.get("what", wanted[0]), wanted, a.get("rivals", []), (a.get("tags") or {}).get("form", "")))
    return out


def outcome(case, answer):
    """One of OUTCOMES, the worst first: a false name is wrong whatever else is said."""
    named = answer.named
    if case.wanted == ["none"]:
        return "wrong" if named else "refused" if answer.flagged else "right"
    if case.wanted == ["unexplained"]:
        itself = case.form in ALSO_FAMILIES and len(named) == 1 and case.form in {*named, *answer.rivals.get(named[0], [])}
        return "right" if answer.flagged or itself else "wrong" if named else "missed"
    allowed = {f: {f, *answer.rivals.get(f, [])} for f in named}
    wanted = set(case.wanted)
    false = [f for f in named if not allowed[f] & (wanted | set(case.rivals))]
    if false or len(named) > len(wanted):
        return "wrong"
    found = all(any(w in a or a & set(case.rivals) for a in allowed.values()) for w in wanted)
    if found and case.group == "G":
        return "right"
    return "right" if found else "refused" if answer.flagged else "right" if case.group == "G" else "missed"
