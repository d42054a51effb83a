"""Identifiers use the words of the glossary, none of those that it replaces."""

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("hydrohil", "services", "shared", "bench", "examples", "tests")
REPLACED = frozenset(
    (
        "told",
        "tell",
        "tells",
        "wanted",
        "heed",
        "made",
        "seen",
        "herald",
        "heralds",
        "rehearse",
        "rehearsed",
        "overslept",
        "rival",
        "rivals",
        "melted",
        "melting",
        "withheld",
        "unhurried",
        "surroundings",
        "detour",
        "fate",
        "toll",
        "lanes",
    )
)


def identifiers(source: str) -> Iterator[str]:
    """Names of variables, arguments, attributes, functions, classes and keywords."""
    for node in ast.walk(ast.parse(source)):
        for field in ("id", "name", "arg", "attr"):
            name = getattr(node, field, None)
            if isinstance(name, str):
                yield name


def replaced(source: str) -> set[str]:
    return {name for name in identifiers(source) if REPLACED.intersection(name.lower().split("_"))}


def test_no_identifier_uses_a_word_that_the_glossary_replaces():
    files = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py")]
    assert len(files) > 500
    found = {path.relative_to(ROOT).as_posix(): names for path in files if (names := replaced(path.read_text()))}
    assert not found, found


def test_a_replaced_word_is_found_in_every_kind_of_identifier():
    source = "class Told: pass\ndef f(wanted, *, x_seen=0): y.made = g(heed=1)\n"
    assert replaced(source) == {"Told", "wanted", "x_seen", "made", "heed"}
