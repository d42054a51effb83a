"""The entry point: version, chapters, and what it says of a fault of its own or of a package that is not installed."""

import re
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from hydrohil.cli import main as module
from hydrohil.cli.main import EXTRAS, app, main

ROOT = Path(__file__).resolve().parents[3]


def test_the_version_names_release_and_sources():
    run = CliRunner().invoke(app, ["--version"])
    assert run.exit_code == 0
    assert re.fullmatch(r"hydrohil \S+, sources [0-9a-f]{16}\n", run.stdout)


def test_every_command_stands_in_a_chapter():
    assert not [command.name or command.callback for command in app.registered_commands if not command.rich_help_panel]


def test_shells_complete_the_commands():
    assert app._add_completion


def failing(error: Exception, monkeypatch: pytest.MonkeyPatch) -> int:
    def raises() -> None:
        raise error

    monkeypatch.setattr(module, "app", raises)
    with pytest.raises(SystemExit) as ended:
        main()
    assert isinstance(ended.value.code, int)
    return ended.value.code


def test_what_nobody_expected_is_70_one_line_and_a_file(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("HYDROHIL_CACHE", str(tmp_path))
    assert failing(RuntimeError("half\x1b[2J\nopen"), monkeypatch) == 70
    (line,) = capsys.readouterr().err.splitlines()
    (file,) = (tmp_path / "errors").iterdir()
    assert str(file) in line and "\x1b" not in line
    assert "RuntimeError" in file.read_text() and sys.argv[0] in file.read_text()


def test_where_no_file_can_be_written_the_traceback_follows_the_line(tmp_path, monkeypatch, capsys):
    (tmp_path / "errors").write_text("in the way")
    monkeypatch.setenv("HYDROHIL_CACHE", str(tmp_path))
    assert failing(RuntimeError("half open"), monkeypatch) == 70
    assert "Traceback" in capsys.readouterr().err


def test_a_package_of_an_extra_that_is_missing_names_the_extra(monkeypatch, capsys):
    assert failing(ModuleNotFoundError("No module named 'scipy'", name="scipy.stats"), monkeypatch) == 2
    assert capsys.readouterr().err == "scipy is not installed: pip install 'hydrohil[analysis]'\n"


def test_a_module_of_ours_that_is_missing_is_a_fault_of_ours(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("HYDROHIL_CACHE", str(tmp_path))
    assert failing(ModuleNotFoundError("No module named 'hydrohil.gone'", name="hydrohil.gone"), monkeypatch) == 70


def test_every_package_of_an_extra_is_named():
    import tomllib

    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    named = {
        package: {name for name, needs in extras.items() if any(need.startswith(package) for need in needs)} for package in EXTRAS
    }
    named["dask"] = named["distributed"]  # comes with it
    assert all(extra == "all" or extra in named[package] for package, extra in EXTRAS.items())
    listed = {re.split(r"[>=\[]", need)[0] for name in ("analysis", "campaign", "report") for need in extras[name]}
    assert listed <= EXTRAS.keys()
