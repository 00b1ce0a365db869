"""Every relative link of the pages leads somewhere, and so does every anchor."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
INDEX = ROOT / "docs/README.md"


def prose(page):
    return re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)


def links(page):
    return [to for to in re.findall(r"\]\(([^)\s]+)\)", prose(page)) if "://" not in to]


def anchors(page):
    """As GitHub makes them of headings."""
    headings = re.findall(r"^#+ +(.+?) *$", prose(page), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    for link in links(page):
        name, _, anchor = link.partition("#")
        to = (page.parent / name).resolve() if name else page
        assert to.exists(), f"{link} is not there"
        assert not anchor or anchor in anchors(to), f"{link}: {to.name} has no such heading, only {anchors(to)}"


def test_anchors_are_githubs(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(
        "# Is this number right?\n\n```sh\n# no heading\n```\n\n## 5. `A`-b, Sæbø's\n[x](#y) [z](https://z)\n"
    )
    assert anchors(page) == {"is-this-number-right", "5-a-b-sæbøs"}
    assert links(page) == ["#y"]


def test_the_index_has_every_page():
    listed = {(INDEX.parent / link).resolve() for link in links(INDEX)}
    assert {page for page in INDEX.parent.rglob("*.md") if page != INDEX} <= listed


def test_every_kept_figure_is_shown():
    shown = {(page.parent / link).resolve() for page in PAGES for link in links(page)}
    assert not [str(figure.relative_to(ROOT)) for figure in ROOT.glob("results/**/*.png") if figure not in shown]
