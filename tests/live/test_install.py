"""One installed name, whatever the user's own folder holds: from a wheel, an editable install, and a clone alone."""

import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

from tests.support.live_cell import own_place

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ("hydrohil", "services", "shared")
DEPENDENCIES = sysconfig.get_paths()["purelib"]
OWN_FOLDERS = ("shared", "services", "tests", "experiments")
OWN_FILES = ("shared.py", "queue.py", "rerun.py")
TRAP = "raise SystemExit('the working folder was imported')\n"
pytestmark = pytest.mark.live


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built from a copy: what setuptools leaves in a tree would go into the next wheel."""
    copy, out = tmp_path_factory.mktemp("sources"), tmp_path_factory.mktemp("wheel")
    for folder in SOURCES:
        shutil.copytree(ROOT / folder, copy / folder, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    line = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", str(out), str(copy)]
    subprocess.run(line, check=True)
    return next(out.glob("*.whl"))


def environment_of_its_own(folder: Path) -> Path:
    """A virtual environment that sees the dependencies, and none of what is installed beside them in editable form."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    packages = next(folder.glob("lib/python*/site-packages"))
    (packages / "dependencies.pth").write_text(DEPENDENCIES + "\n")  # a path in a .pth file brings none of that path's own
    return folder / "bin" / "python"


@pytest.fixture(scope="module", params=["wheel", "editable", "clone"])
def command(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """`hydrohil` as each kind of installation gives it."""
    if request.param == "editable":
        return [str(Path(sys.executable).parent / "hydrohil")]
    python = environment_of_its_own(tmp_path_factory.mktemp(request.param))
    if request.param == "clone":
        return ["env", f"PYTHONPATH={ROOT}", str(python), "-P", "-m", "hydrohil"]
    found = request.getfixturevalue("wheel")
    line = [
        sys.executable,
        "-m",
        "pip",
        "--python",
        str(python),
        "install",
        "-q",
        "--no-deps",
        "--no-index",
        "--ignore-installed",
    ]
    subprocess.run([*line, str(found)], check=True)
    return [str(python.parent / "hydrohil")]


@pytest.fixture
def own_folder(tmp_path: Path) -> Path:
    """A user's working folder that holds what a careless import would find first."""
    for name in OWN_FOLDERS:
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text(TRAP)
    for name in OWN_FILES:
        (tmp_path / name).write_text(TRAP)
    return tmp_path


def run(command: list[str], *words: str, folder: Path, seconds: float = 120.0, statuses: tuple[int, ...] = (0,)) -> str:
    """Standard output of a command that must end with one of `statuses`."""
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    run = subprocess.run([*command, *words], cwd=folder, env=clean, capture_output=True, text=True, check=False, timeout=seconds)
    assert run.returncode in statuses and "working folder" not in run.stdout + run.stderr, run.stdout + run.stderr
    return run.stdout


def test_the_wheel_holds_one_name(wheel: Path) -> None:
    names = {Path(name).parts[0] for name in zipfile.ZipFile(wheel).namelist()}
    assert {name for name in names if not name.endswith(".dist-info")} == {"hydrohil"}
    held = set(zipfile.ZipFile(wheel).namelist())
    kept = {path.relative_to(ROOT).as_posix() for folder in SOURCES for path in (ROOT / folder).rglob("*.py")}
    assert {name if name.startswith("hydrohil/") else f"hydrohil/{name}" for name in kept} <= held
    assert {"hydrohil/py.typed", "hydrohil/services/recorder/arm.urdf"} <= held


def test_a_command_and_the_processes_of_a_cell_import_nothing_from_the_working_folder(
    command: list[str], own_folder: Path
) -> None:
    assert "fig-4-25" in run(command, "list", folder=own_folder)
    place = own_place()
    words = ["run", "fig-4-25", "--clock", "lockstep", "--permit-ttl-ms", "200", *place.words]
    run(command, *words, "--rrd", "run.rrd", "--json", "run.json", folder=own_folder)
    assert (own_folder / "run.rrd").stat().st_size > 100_000


CAMPAIGN = """
name = "own"
title = "Two gains"
experiment = "fig-4-25"
claims = true

[sweep.gain]
list = [3.0, 3.5]
sets = { "controller.gains.down_up.kp_a_per_rad" = "value" }
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ("run", "fig-4-25", "--clock", "local"),
        ("qualify", "--quick", "--rate-hz", "100"),
        ("faults", "--only", "1", "--trials", "1"),
        ("reproduce", "fig-4-25"),
        ("campaign", "own.toml"),
    ],
    ids=lambda words: str(words[0]),
)
def test_what_commands_start_imports_nothing_from_the_working_folder(
    command: list[str], own_folder: Path, words: tuple[str, ...]
) -> None:
    (own_folder / "own.toml").write_text(CAMPAIGN)
    run(command, *words, folder=own_folder, seconds=300.0, statuses=(0, 1))  # 1: without a clone no test proves a row
