"""The pages of the documentation as data: blocks, tables, links, anchors, command lines."""

import re
import shlex
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from docs import generate

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
TOP = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md")
PAGES = (*TOP, *sorted(DOCS.rglob("*.md")))
_FENCED = re.compile(r"^(`{3,})(\w*)[^\n]*\n(.*?)^\1$", re.DOTALL | re.MULTILINE)


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


@cache
def generated() -> dict[str, str]:
    """The pages that are generated from the code, by their path on the site."""
    return generate.generated()


@cache
def site() -> dict[str, str]:
    """Every page of the site by its path there: those that are written, and those that are generated from the code."""
    written = {page.relative_to(DOCS).as_posix(): generate.on_site(page.read_text()) for page in DOCS.rglob("*.md")}
    return written | generated()


def without_code(text: str) -> str:
    return _FENCED.sub("", text)


def blocks(text: str, language: str) -> list[str]:
    """Fenced code blocks of one language."""
    return [found[3] for found in _FENCED.finditer(text) if found[2] == language]


def rows(text: str, first_column: str) -> list[list[str]]:
    """Cells of the table whose heading begins with `first_column`."""
    table = text[text.index(f"\n| {first_column} |") + 1 :].split("\n\n", 1)[0].splitlines()
    return [[cell.strip().strip("`") for cell in line.strip("| ").split("|")] for line in table[2:]]


def anchors(text: str) -> set[str]:
    """What a link may name in a page: its headings, as the site builder writes them."""
    headings = re.findall(r"^#+ (.+)$", without_code(text), re.MULTILINE)
    return {re.sub(r"[\s-]+", "-", re.sub(r"[^\w\s-]", "", heading.lower()).strip()) for heading in headings}


def links(text: str) -> list[str]:
    return re.findall(r"\]\(([^)\s]+)\)", without_code(text))


def commands_in(line: str) -> Iterator[list[str]]:
    """Words of each `hydrohil ...` in a line of shell, up to a redirection or the next command."""
    for part in re.split(r"&&|;|\||>", line):
        words = shlex.split(part, comments=True)
        if words[:1] == ["hydrohil"]:
            yield words[1:]


def command_lines() -> list[list[str]]:
    """Every `hydrohil ...` of every page, in words; the changelog names commands of its time, and without their values."""
    found = []
    for page in (page for page in PAGES if page.name != "CHANGELOG.md"):
        text = page.read_text()
        lines = [line for block in blocks(text, "sh") for line in block.splitlines()]
        lines += re.findall(r"`(hydrohil [^`]+)`", without_code(text))
        found += [words for line in lines for words in commands_in(line)]
    return found
