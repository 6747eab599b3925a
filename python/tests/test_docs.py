"""Python of the front page runs as it stands (commands: cli/tests/pages); the book has every page."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"


def test_law_python_of_the_front_page_runs():
    pytest.importorskip("pandas")
    pytest.importorskip("matplotlib").use("agg")
    (block,) = re.findall(r"```python\n(.*?)```", (DOCS.parent / "README.md").read_text(), re.S)
    exec(block, {})


def test_law_the_book_has_every_page_and_no_link_is_broken():
    summary = (DOCS / "SUMMARY.md").read_text()
    listed = re.findall(r"\]\(([^)]+\.md)\)", summary)
    pages = {p.relative_to(DOCS).as_posix() for p in DOCS.rglob("*.md")} - {"SUMMARY.md"}
    assert set(listed) == pages and len(listed) == len(pages)
    for page in pages:
        for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", (DOCS / page).read_text()):
            to = ((DOCS / page).parent / link).resolve()
            assert to.exists() and to.is_relative_to(DOCS.resolve()), f"{page}: {link} is no page or file of the book"
