"""What a file says never reaches the terminal as a command, and never styles what is printed."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from hydrohil.cli.main import app
from hydrohil.cli.options import printable

MARKUP = 'base = "fig-4-25"\ntitle = "[/] [red]x"\nsource = "[/bold]"\n'


def output(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, arguments)
    return result.exit_code, result.output + result.stderr


@pytest.mark.parametrize("command", [("show",), ("run", "--clock", "local")])
def test_brackets_in_a_title_are_printed_as_they_stand(tmp_path: Path, command: tuple[str, ...]):
    file = tmp_path / "mine.toml"
    file.write_text(MARKUP)
    status, text = output(*command, str(file))
    assert status == 0 and "[/] [red]x" in text


@pytest.mark.parametrize("line", ['"\\u001b[31mx" = 1', 'title = "\\u001b[31mx"', 'alias = "\\u009b"', '[foo."\\u202e"]'])
def test_an_error_line_holds_no_control_characters(tmp_path: Path, line: str):
    file = tmp_path / "mine.toml"
    file.write_text(f'base = "fig-5-5"\n{line}\n')
    status, text = output("show", str(file))
    assert status == 2 and text.replace("\n", "").isprintable()


def test_a_character_that_does_not_print_is_shown_as_its_escape():
    assert printable("a\x1b[31m\u202e é\n\tb\x85") == "a\\x1b[31m\\u202e é\n\tb\\x85"
