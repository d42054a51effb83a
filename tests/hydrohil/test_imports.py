"""What the library and the everyday commands load: large packages only where they are used, the terminal's never."""

import subprocess
import sys

import pytest

LARGE = {"scipy", "dask", "distributed", "matplotlib", "control", "pyarrow", "rerun"}
TERMINAL = {"typer", "rich", "click"}
PLAYS = """
import sys
from hydrohil.cli.main import main
sys.argv = ["hydrohil", *{words!r}]
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
print("loaded", *{{name.partition(".")[0] for name in sys.modules}})
"""
LOADS = """
import sys
import {module}
print("loaded", *{{name.partition(".")[0] for name in sys.modules}})
"""


def loaded(source):
    """Top-level names that a process of its own has in memory at its end."""
    ran = subprocess.run([sys.executable, "-c", source], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    first, *names = ran.stdout.splitlines()[-1].split()
    assert first == "loaded"
    return set(names)


@pytest.mark.parametrize("words", [("list",), ("show", "fig-5-5"), ("show", "fig-5-5", "--toml")])
def test_list_and_show_load_no_large_package_and_no_compiler(words):
    assert not loaded(PLAYS.format(words=words)) & (LARGE | {"numba"})


def test_a_run_on_the_local_clock_loads_the_compiler_and_no_other_large_package():
    found = loaded(PLAYS.format(words=("run", "fig-4-25", "--clock", "local")))
    assert "numba" in found
    assert not found & (LARGE - {"scipy"})  # numba asks scipy for its version


@pytest.mark.parametrize(
    "module",
    [
        "hydrohil",
        "hydrohil.simulation.rollout",
        "hydrohil.thesis.library",
        "hydrohil.claims.metrics",
        "hydrohil.tuning.procedure",
        "hydrohil.linear.linear",
        "hydrohil.reproduction.plan",
        "hydrohil.cell.session",
    ],
)
def test_the_library_loads_no_large_package_and_nothing_of_a_terminal(module):
    assert not loaded(LOADS.format(module=module)) & (LARGE | TERMINAL)


def test_the_check_sees_a_package_that_is_loaded():
    assert "matplotlib" in loaded(LOADS.format(module="hydrohil.pages.drawing"))
