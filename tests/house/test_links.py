"""Every link from page to page leads somewhere, every page is on the shelf, and the map of the house names rooms that exist."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").rglob("*.md")])
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    links = [link for link in LINK.findall(page.read_text(encoding="utf-8")) if "://" not in link]
    assert [link for link in links if not (page.parent / link).exists()] == []


def test_every_page_is_on_the_shelf():
    shelf = set(LINK.findall((ROOT / "docs" / "README.md").read_text(encoding="utf-8")))
    assert {page.name for page in (ROOT / "docs").glob("*.md")} - {"README.md"} <= shelf


def test_the_map_names_rooms_that_exist_and_forgets_none():
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    rooms = set(re.findall(r"^\| `([^`]+/)` \|", text, flags=re.MULTILINE))
    assert [room for room in rooms if not (ROOT / room).is_dir()] == []
    packages = {f"mitl/{found.parent.name}/" for found in (ROOT / "mitl").glob("*/__init__.py")}
    assert packages <= rooms


def test_the_map_starts_at_files_that_exist():
    rows = re.findall(
        r"^\| (?:`([^`]+/)`)? ?\|.*\| ([^|]*) \|$", (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8"), flags=re.MULTILINE
    )
    room = ""
    for folder, starts in rows:
        room = folder or room
        assert [name for name in re.findall(r"`([^`]+\.py)`", starts) if not (ROOT / room / name).is_file()] == []
