"""Who may import whom; read from the sources, so that it stays true."""

import ast
from pathlib import Path

import pytest

from shared.kernel import KERNEL_FOLDERS, SOURCE_FOLDERS

ROOT = Path(__file__).resolve().parent.parent
SOURCES = {path.relative_to(ROOT).as_posix(): path for folder in SOURCE_FOLDERS for path in (ROOT / folder).rglob("*.py")}
IMPURE = {
    "time",
    "os",
    "socket",
    "threading",
    "subprocess",
    "zenoh",
    "rerun",
    "random",
    "secrets",
    "datetime",
    "asyncio",
    "pathlib",
}


def tree(path):
    return ast.parse(path.read_text())


def imports(path):
    found = set()
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found |= {node.module} | {f"{node.module}.{name.name}" for name in node.names}
    return found


def roots(path):
    return {name.split(".")[0] for name in imports(path)}


def has_kernels(path):
    functions = [node for node in ast.walk(tree(path)) if isinstance(node, ast.FunctionDef)]
    return any(isinstance(mark, ast.Name) and mark.id == "kernel" for function in functions for mark in function.decorator_list)


KERNELS = sorted(name for name, path in SOURCES.items() if has_kernels(path))


def test_the_rules_below_look_at_something():
    assert len(SOURCES) > 50
    assert {"services/plant/gate.py", "services/supervisor/step.py", "services/controller/laws.py"} <= set(KERNELS)


def test_kernels_lie_where_the_name_of_the_machine_code_sees_them():
    assert not [name for name in KERNELS if not name.startswith(tuple(f"{folder}/" for folder in KERNEL_FOLDERS))]
    kernel_files = [SOURCES[name] for name in KERNELS]
    assert not [path for path in kernel_files if roots(path) & {"experiments"}]


def test_only_the_bus_imports_the_transport():
    assert [name for name, path in SOURCES.items() if "zenoh" in roots(path)] == ["shared/bus.py"]


def test_only_the_recorder_and_who_opens_its_viewer_import_rerun():
    users = [name for name, path in SOURCES.items() if "rerun" in roots(path)]
    assert users
    assert all(name.startswith("services/recorder/") for name in users)


BELOW = {  # what each folder may import of ours, beside itself; a service: `shared` alone
    "shared": set(),
    "experiments": {"shared", "services"},
    "rollout": {"shared", "services", "experiments"},
    "analysis": {"shared", "services", "experiments", "rollout"},
    "reproduction": {"shared", "services", "experiments", "rollout", "analysis"},
    "tuning": {"shared", "services", "experiments", "rollout"},
    "battery": {"shared", "services", "experiments", "rollout", "reproduction"},
    "campaigns": {"shared", "services", "experiments", "rollout"},
    "qualification": {"shared", "services", "experiments", "rollout"},
}
CELLS = ("services.operator.cell", "services.operator.session")  # what who brings up cells takes of the operator, no commands


@pytest.mark.parametrize("name", sorted(SOURCES))
def test_imports_point_downwards(name):
    folder, _, rest = name.partition("/")
    ours = roots(SOURCES[name]) & {*BELOW, "services", "tests"}
    if folder != "services":
        assert ours - {folder} <= BELOW[folder]
        above = {found for found in imports(SOURCES[name]) if found.startswith("services.operator")} - {"services.operator"}
        assert all(folder in ("battery", "qualification") and found.startswith(CELLS) for found in above)
    elif not rest.startswith("operator/"):
        service = rest.split("/")[0]
        foreign = {found for found in imports(SOURCES[name]) if found.startswith("services.") and found.split(".")[1] != service}
        assert not foreign
        assert ours <= {"shared", "services"}


@pytest.mark.parametrize("name", KERNELS)
def test_what_computes_reads_no_clock_no_socket_and_no_file(name):
    assert not roots(SOURCES[name]) & IMPURE
    called = {
        node.func.id for node in ast.walk(tree(SOURCES[name])) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    assert not called & {"open", "print", "input", "exec", "eval"}


def test_neither_gate_nor_shell_knows_the_emulator():
    users = [name for name, path in SOURCES.items() if "services.plant.emulator" in imports(path)]
    assert users == ["services/plant/main.py"]


def test_only_the_gatekeeper_and_the_end_of_the_process_write_to_the_device():
    writers = []
    for name, path in SOURCES.items():
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.Attribute) and node.attr == "write" and "device" in ast.unparse(node.value):
                writers.append(name)
    assert set(writers) == {"services/plant/gatekeeper.py", "services/plant/service.py"}
    assert writers.count("services/plant/service.py") == 1


LOOP = ("shared/", "services/plant/", "services/controller/", "services/supervisor/")
WALL = {"time", "time_ns", "clock_gettime", "clock_gettime_ns", "localtime", "gmtime", "ctime", "now", "utcnow", "today"}


def test_the_loop_reads_no_wall_clock():
    """A clock that is stepped by an hour can have no effect on who never reads it."""
    looked = [name for name in SOURCES if name.startswith(LOOP)]
    assert "shared/bus.py" in looked and "services/plant/service.py" in looked
    for name in looked:
        assert not {"datetime", "time.time", "time.time_ns"} & imports(SOURCES[name]), name
        for node in ast.walk(tree(SOURCES[name])):
            if isinstance(node, ast.Attribute) and ast.unparse(node.value) in ("time", "datetime", "datetime.datetime"):
                assert node.attr not in WALL, f"{name}: {ast.unparse(node)}"
            assert not (isinstance(node, ast.Name | ast.Attribute) and "CLOCK_REALTIME" in ast.unparse(node)), name
