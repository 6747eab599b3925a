"""Commands of the documentation are run as they stand; the book has every page."""

import re
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"


def test_law_commands_of_the_page_for_others_run(tmp_path):
    text = (DOCS / "coming-from.md").read_text()
    commands = [line for block in re.findall(r"```sh\n(.*?)```", text, re.S) for line in block.splitlines()]
    assert len(commands) >= 11 and all(line.startswith("windfall ") for line in commands)
    for line in commands:
        ran = subprocess.run(
            [Path(sys.executable).parent / "windfall", *line.split()[1:], "--quiet"], cwd=tmp_path, capture_output=True
        )
        assert ran.returncode == 0, (line, ran.stderr)


def test_law_the_book_has_every_page_and_no_link_is_broken():
    summary = (DOCS / "SUMMARY.md").read_text()
    listed = re.findall(r"\]\(([^)]+\.md)\)", summary)
    pages = {p.relative_to(DOCS).as_posix() for p in DOCS.rglob("*.md")} - {"SUMMARY.md"}
    assert set(listed) == pages and len(listed) == len(pages)
    for page in pages:
        for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", (DOCS / page).read_text()):
            to = ((DOCS / page).parent / link).resolve()
            assert to.exists() and to.is_relative_to(DOCS.resolve()), f"{page}: {link} is no page or file of the book"
