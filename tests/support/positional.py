"""Calls of our own functions and classes that pass many values by position.

`python tests/support/positional.py [FOLDER ...]` lists them. A call is ours unless its name leads to another library or to a
builtin; a method is ours if something of ours has its name. What takes any number of values (`*words`) is left out.
"""

import ast
import builtins
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("hydrohil", "services", "shared", "tests", "bench", "examples")
MOST = 6
FUNCTIONS = ast.FunctionDef | ast.AsyncFunctionDef


def files():
    """Every source of ours once; `hydrohil/services` and `hydrohil/shared` are links to the folders at the top."""
    links = {ROOT / "hydrohil" / name for name in ("services", "shared")}
    found = (path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))
    return sorted(path for path in found if not links & set(path.parents))


def definitions(trees):
    """Names of all functions, methods and classes of ours, and of those that take any number of values."""
    nodes = [node for tree in trees for node in ast.walk(tree)]
    functions = [node for node in nodes if isinstance(node, FUNCTIONS)]
    classes = {node.name for node in nodes if isinstance(node, ast.ClassDef)}
    return classes | {node.name for node in functions}, {node.name for node in functions if node.args.vararg}


def foreign(tree):
    """Names that a file has from other libraries, and the builtins."""
    found = set(dir(builtins))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {(name.asname or name.name).split(".")[0] for name in node.names if name.name.split(".")[0] != "hydrohil"}
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] not in ("hydrohil", "tests", "bench"):
            found |= {name.asname or name.name for name in node.names}
    return found


def leftmost(node):
    """The name at the left end of `a.b[c].d`; "" where there is none."""
    while isinstance(node, ast.Attribute | ast.Subscript | ast.Call):
        node = node.func if isinstance(node, ast.Call) else node.value
    return node.id if isinstance(node, ast.Name) else ""


def by_position(tree, names, variadic):
    """(line, function, number) of each call of ours in `tree` that passes more than `MOST` values by position."""
    others, found = foreign(tree), []
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or len(node.args) <= MOST or leftmost(node.func) in others:
            continue
        last = node.func.attr if isinstance(node.func, ast.Attribute) else leftmost(node.func)
        if last not in variadic and (last in names or not isinstance(node.func, ast.Attribute)):
            found.append((node.lineno, ast.unparse(node.func), len(node.args)))
    return found


def offenders():
    """(path, line, function, number) of each such call in all sources of ours."""
    trees = {path: ast.parse(path.read_text()) for path in files()}
    names, variadic = definitions(trees.values())
    return [(path, *call) for path, tree in trees.items() for call in by_position(tree, names, variadic)]


def folder(path):
    """The folder that it is counted under: `services/plant`, `hydrohil/claims`, `tests/hydrohil/claims`."""
    parts = path.relative_to(ROOT).parts[:-1]
    return "/".join(parts[: 3 if parts[0] == "tests" else 2])


def main():
    """Print the offenders below the folders named, or all of them."""
    chosen = tuple(ROOT / name for name in sys.argv[1:]) or (ROOT,)
    found = [row for row in offenders() if any(place in row[0].parents for place in chosen)]
    for path, line, function, number in found:
        print(f"{path.relative_to(ROOT)}:{line}: {function} takes {number} values by position")
    print("\n".join(f"{count:5} {name}" for name, count in sorted(Counter(folder(row[0]) for row in found).items())))


if __name__ == "__main__":
    main()
