"""README and docs against the code: links, anchors, command lines, files, words, and every code block that can run."""

import re
from collections import Counter
from typing import Any

import pytest
import typer.main
from typer.testing import CliRunner

import hydrohil
from hydrohil.cli.main import app
from hydrohil.experiment.overrides import with_overrides
from hydrohil.shared import exit_status
from hydrohil.shared.contract import messages
from hydrohil.shared.contract.faults import LINKS
from hydrohil.shared.contract.link_units import plain_of
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.thesis.library import find
from tests.support.pages import DOCS, PAGES, ROOT, anchors, command_lines, generated, links, name_of, rows, site, without_code

COMMANDS: Any = typer.main.get_command(app)
LINES = command_lines()
README = (ROOT / "README.md").read_text()
DIALECT = (  # words that only this project used; the glossary and the changelog name them beside those of today
    r"\b(burn(s|ed|t)?|heralds?|rehearses?|rehearsal|overslept|rivals?|surroundings|melts?|melted|melting|withheld|unhurried)\b",
    r"\bthe (fault )?battery\b|\brows? of the battery\b",
    r"\bnobody\b|\bnobody waits\b|\bis told\b|\bare told\b|\bheed(s|ed)?\b",
    r"\bbias ticks\b|\barming numbers?\b|\bsigned rate\b|\bsigned for\b",
)
OF_THEIR_TIME = ("docs/reference/glossary.md", "CHANGELOG.md")


def test_the_readme_is_a_front_page() -> None:
    assert len(README.splitlines()) < 150


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_file_linked_exists(page: Any) -> None:
    for link in links(page.read_text()):
        target, _, anchor = link.partition("#")
        if link.startswith("https://"):
            continue
        there = (page.parent / target).resolve() if target else page
        on_site = there.relative_to(DOCS).as_posix() if there.is_relative_to(DOCS) else ""
        assert there.exists() or on_site in generated(), f"{name_of(page)}: {link}"
        text = generated()[on_site] if on_site in generated() else there.read_text() if there.suffix == ".md" else ""
        assert not anchor or anchor in anchors(text), f"{name_of(page)}: {link}"


@pytest.mark.parametrize("name", sorted(site()))
def test_every_link_of_the_site_leads_to_a_page_and_a_heading(name: str) -> None:
    pages = site()
    for link in links(pages[name]):
        target, _, anchor = link.partition("#")
        if link.startswith("https://"):
            continue
        there = (DOCS / name).parent.joinpath(target).resolve().relative_to(DOCS).as_posix() if target else name
        assert there in pages or (DOCS / there).exists(), f"{name}: {link}"
        assert not anchor or anchor in anchors(pages[there]), f"{name}: {link}"


def test_every_page_is_in_the_navigation_once() -> None:
    named = Counter(re.findall(r"[\w/-]+\.md", (ROOT / "mkdocs.yml").read_text().split("\nnav:", 1)[1].split("\n\n", 1)[0]))
    assert named == Counter(list(site()))


def test_every_file_and_folder_of_the_project_named_exists() -> None:
    folders = "shared|services|hydrohil|bench|examples|tests|docs|\\.ci"  # a file has a suffix: keys on the wire have none
    for page in PAGES:
        if name_of(page) == "CHANGELOG.md":  # names files of their time
            continue
        for name in re.findall(rf"`((?:{folders})/(?:[\w./*-]*(?:/|\.\w+))?)`", page.read_text()):
            assert any(ROOT.glob(name.rstrip("/"))), f"{name_of(page)}: {name}"


@pytest.mark.parametrize("page", [page for page in PAGES if name_of(page) not in OF_THEIR_TIME], ids=name_of)
def test_the_words_are_those_of_the_field(page: Any) -> None:
    text = re.sub(r"`[^`\n]*`", "", without_code(page.read_text()))
    for pattern in DIALECT:
        assert not (found := re.search(pattern, text, re.IGNORECASE)), f"{name_of(page)}: {found and found[0]!r}"


def test_command_lines_are_found() -> None:
    assert {"run", "up", "down", "status", "estop", "reset", "recover", "view", *SERVICES} <= {line[0] for line in LINES}


@pytest.mark.parametrize("line", [line for line in LINES if line[0] not in SERVICES], ids=" ".join)
def test_a_command_line_parses(line: list[str]) -> None:
    name, *arguments = line
    if not arguments or name.startswith("-"):
        assert name in COMMANDS.commands or f"{name}" in CliRunner().invoke(app, ["--help"]).output
        return
    arguments = ["fig-4-25" if word in ("NAME", "mine.toml") else word for word in arguments]
    given = COMMANDS.commands[name].make_context(name, arguments).params  # raises on an unknown option
    if "name" in given and not str(given["name"]).endswith(".toml"):
        with_overrides(find(given["name"]), given.get("settings") or [])  # raises on an unknown name or field
    assert given.get("clock", "real") in ("real", "lockstep", "local")


@pytest.mark.parametrize("service", [*SERVICES, "router"])
def test_a_service_knows_the_options_named(service: str) -> None:
    named = {word for line in LINES if line[0] == service for word in line[1:] if word.startswith("--")}
    known = re.findall(r"--[a-z-]+", CliRunner().invoke(app, [service, "--help"]).output)
    assert ({"--listen"} if service == "router" else {"--cell", "--port"}) <= named <= {*known}


def test_every_make_target_named_exists() -> None:
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    named = set()
    for page in PAGES:
        found = re.findall(r"^make ([a-z]+)|`make ([a-z]+)`", page.read_text(), re.MULTILINE)
        named |= {first or second for first, second in found}
    assert {"demo", "test", "check", "slow", "docs"} <= named <= targets


def test_the_exit_statuses_are_those_of_the_code() -> None:
    table = rows((DOCS / "reference/exit-status.md").read_text(), "exit status")
    written = {int(row[0]): row[1] for row in table}
    assert set(written) == {value for name, value in vars(exit_status).items() if name.startswith("EXIT_")}
    words = {"CLAIM": "claim", "USAGE": "usage", "TRIPPED": "tripped", "TRANSPORT": "transport", "INTERRUPTED": "interrupted"}
    for name, word in words.items():
        assert word in written[getattr(exit_status, f"EXIT_{name}")]


def test_the_safety_page_has_a_row_for_every_cause_in_their_order() -> None:
    text = (DOCS / "explanation/safety.md").read_text()
    named = [line.split("|")[1].strip() for line in text.splitlines() if line.startswith("| ")]
    causes = [name for name in named if name in messages.TripCause.__members__]
    assert causes == [cause.name for cause in messages.TripCause if cause]


def test_the_page_of_rules_has_every_cause() -> None:
    page = site()["reference/rules.md"]
    for cause in (*messages.TripCause, *messages.GateCause):
        assert not cause or f"| {int(cause)} | `{cause.name}` |" in page, cause


def test_the_page_of_experiments_has_every_path_that_a_file_may_have() -> None:
    page = site()["reference/experiments.md"]
    plain = plain_of(find("fig-5-5"))
    for section in ("plant", "controller", "supervisor"):
        for path in paths(plain[section], section):
            link = next((link for link in LINKS if f".{link}." in path), "")
            name = path.rsplit(".", 1)[-1]
            assert f"`{path}`" in page or (link and (f".<link>.{name}`" in page or f"`{name}`" in page)), path


def paths(plain: Any, before: str) -> list[str]:
    """Paths of all values of plain data, in the form of `--set`."""
    if not isinstance(plain, dict):
        return [before]
    return [path for name, value in plain.items() for path in paths(value, f"{before}.{name}")]


def test_the_page_of_the_library_has_every_public_name() -> None:
    headings = re.findall(r"^      heading: (\w+)$", site()["reference/library.md"], re.MULTILINE)
    assert sorted(headings) == sorted(hydrohil.__all__)
