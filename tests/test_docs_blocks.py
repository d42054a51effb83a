"""Every code block of README and docs runs: each page in a folder of its own, its blocks in their order.

Python is executed. TOML loads as an experiment or a campaign, and is written where a comment names a file. Of shell, the
`hydrohil` commands run that start no cell and take no minutes; test_docs.py reads the others.
"""

import re
import shlex
import tomllib
from pathlib import Path
from typing import Any

import pytest
from sybil import Example, Sybil
from sybil.parsers.markdown import CodeBlockParser, PythonCodeBlockParser
from typer.testing import CliRunner

from hydrohil.campaign.reading import find_campaign
from hydrohil.cli.main import app
from hydrohil.services.recorder.recorder import Recorder
from hydrohil.shared.exit_status import EXIT_CLAIM, EXIT_OK, EXIT_TRIPPED
from hydrohil.thesis.library import load
from tests.support.pages import PAGES, blocks, name_of
from tests.support.recorder_trial import trial

NAMED = re.compile(r"<!-- file: (\S+) -->\s*$")
NEEDS_ONE_OF: dict[str, tuple[str, ...]] = {  # commands that start no cell and are quick, with the options that make them so
    "list": (),
    "show": (),
    "linear": (),
    "explain": (),
    "run": ("local",),
    "faults": ("--list",),
    "inject": ("--list",),
    "campaign": ("--list", "--dry-run", "--trial"),
}
LANGUAGES = ("python", "sh", "toml")


def is_quick(words: list[str]) -> bool:
    if not words or words[0] not in NEEDS_ONE_OF or words == ["explain"]:  # without a cause it waits for a person
        return False
    needed = NEEDS_ONE_OF[words[0]]
    return not needed or any(word in words for word in needed)


def play_line(line: str) -> None:
    """One line of shell, if it is such a command; `> FILE` takes what it prints."""
    command, _, target = line.partition(" > ")
    words = shlex.split(command, comments=True)
    if words[:1] != ["hydrohil"] or not is_quick(words[1:]):
        return
    result = CliRunner().invoke(app, words[1:])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert result.exit_code in (EXIT_OK, EXIT_CLAIM, EXIT_TRIPPED), f"{line}\n{result.output}"
    if target:
        Path(shlex.split(target, comments=True)[0]).write_text(result.stdout)


def play_shell(example: Example) -> None:
    for line in example.parsed.splitlines():
        play_line(line)


def load_toml(example: Example) -> None:
    named = NAMED.search(example.document.text[: example.start])
    path = Path(named[1] if named else "unnamed.toml")
    path.write_text(example.parsed)
    if "experiment" in tomllib.loads(example.parsed):
        find_campaign(str(path))
    else:
        load(str(path))


def write_recording(path: Path) -> None:
    """The recording that a page reads: what a cell would have left, since no cell runs here."""
    recorder = Recorder("docs")
    recorder.record(path, "Static force control", "# before")
    recorder.take(list(trial(200)))
    recorder.tick(0)
    recorder.finish("# Verdict: PASS")


PARSERS = (
    PythonCodeBlockParser(),
    CodeBlockParser(language="sh", evaluator=play_shell),
    CodeBlockParser(language="toml", evaluator=load_toml),
)


@pytest.mark.parametrize(
    "page", [page for page in PAGES if any(blocks(page.read_text(), language) for language in LANGUAGES)], ids=name_of
)
def test_the_blocks_of_a_page_run_in_their_order(page: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "runs").mkdir()
    if "read_recording(" in "".join(blocks(page.read_text(), "python")):
        write_recording(tmp_path / "runs" / "static.rrd")
    found = list(Sybil(parsers=PARSERS).parse(page).examples())
    assert len(found) == sum(len(blocks(page.read_text(), language)) for language in LANGUAGES)
    for example in found:
        example.evaluate()


def test_what_would_start_a_cell_is_not_run() -> None:
    assert is_quick(shlex.split("run fig-4-25 --clock local")) and not is_quick(["run", "fig-4-25"])
    assert is_quick(["explain", "FORCE_RAW"]) and not is_quick(["explain"])
    assert not is_quick(["up"]) and not is_quick(["faults", "--quick"]) and not is_quick(["estop"])
