"""The site's sources in `build/docs`: the pages that are written, and those that are generated from the code.

`make docs` calls `python -m docs.generate` and then the site builder. The tests read `generated()` without building anything.
"""

import inspect
import re
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from docs.experiment_fields import code, comments_of, fields, written_types

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
OUT = ROOT / "build" / "docs"
REPOSITORY_PAGES = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
COPIED = (".md", ".png", ".css")


def table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """A Markdown table; cells are text, in which a bar is escaped."""
    head = list(head)
    lines = [" | ".join(head), " | ".join("---" for _ in head)]
    lines += [" | ".join(" ".join(str(cell).split()).replace("|", "\\|") for cell in row) for row in rows]
    return "".join(f"| {line} |\n" for line in lines)


def plain(text: str) -> str:
    """Text in which brackets are no link, and angles no tag, outside of code."""
    parts = text.split("`")
    parts[::2] = [part.replace("[", "\\[").replace("<", "&lt;") for part in parts[::2]]
    return "`".join(parts)


def on_site(text: str) -> str:
    """A page of the repository as a page of the site: there docs/ is the top, and beside it lie the pages of REPOSITORY_PAGES."""
    text = re.sub(r"\]\(docs/", "](", text)
    for there, here in REPOSITORY_PAGES.items():
        text = text.replace(f"]({there}", f"]({here}").replace(f"../{there}", here)
    return text


def command_line() -> str:
    """Every command with its arguments and options, in the chapters of `hydrohil --help`."""
    import typer.main

    from hydrohil.cli.main import app

    commands: dict[str, Any] = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    chapters: dict[str, list[str]] = {}
    for name, command in commands.items():
        if command.hidden:
            continue
        panel = getattr(command, "rich_help_panel", None)
        chapters.setdefault(panel if isinstance(panel, str) else "Commands", []).append(_command(name, command))
    parts = ["# Command line\n\nMade from the commands. [Exit statuses](exit-status.md) are the same for all of them.\n"]
    for chapter, sections in chapters.items():
        parts += [f"## {chapter}\n", *sections]
    return "\n".join(parts)


def _command(name: str, command: Any) -> str:
    arguments = [param for param in command.params if param.param_type_name == "argument"]
    options = [param for param in command.params if param.param_type_name == "option" and not param.hidden]
    usage = " ".join(["hydrohil", name, *(_argument(param) for param in arguments), "[OPTIONS]"])
    text = plain(inspect.cleandoc(command.help or "").split("\f")[0])
    parts = [f"### hydrohil {name}\n", f"```text\n{usage}\n```\n", f"{text}\n"]
    rows = [
        (code("/".join((*o.opts, *o.secondary_opts))), _kind(o), _default(o), plain(o.help or "")) for o in (*arguments, *options)
    ]
    if rows:
        parts.append(table(("option", "value", "default", "meaning"), rows))
    return "\n".join(parts)


def _argument(param: Any) -> str:
    word = param.metavar or param.name.upper()
    return word if param.required or word.startswith("[") else f"[{word}]"


def _kind(param: Any) -> str:
    if getattr(param, "is_flag", False):
        return ""
    kind = getattr(param, "type", param)  # where the bounds are, by the version of typer
    low, high = getattr(kind, "min", None), getattr(kind, "max", None)
    bounds = "" if low is None and high is None else f" ({'' if low is None else low}..{'' if high is None else high})"
    return f"{param.metavar or param.name.upper()}{bounds}"


def _default(param: Any) -> str:
    return "" if param.default in (None, "", False, (), []) or callable(param.default) else code(param.default)


LIBRARY = """# Library

`import hydrohil as hh`. Made from the docstrings. No function prints; every error is a `HydrohilError`.
"""
INJECTED = """## What can be injected

With `hydrohil inject`, `hydrohil run --inject`, or the section `[[faults]]` of an experiment.
"""
TRIED = """## What the fault test tries

`hydrohil faults`. T: sample period; lease: longest age of a command or permit. W: real processes on the wall clock; L: exact to
the tick, local or lockstep; P: by tests; -: not tried.
"""
FIELDS = """## Fields

The path is that of `--set` and of the TOML file. Lists of tables (`reference`, `faults`, `changes`, `claims`) have one row a
field; `<link>` is `rotate`, `down_up` or `out_in`, whose defaults differ.
"""
RULES = """# Rules

Made from the rule table. A row states what must hold; the first that does not hold decides. The page on
[safety](../explanation/safety.md#rules-of-the-supervisor) has the reason for each limit. `hydrohil explain CAUSE` prints a row.
"""


def library() -> str:
    """The public names of `import hydrohil as hh`, each from its docstring; of data, the fields with the comments beside them."""
    import hydrohil

    chapters: dict[str, list[str]] = {"Functions": [], "Classes": [], "Errors": []}
    for name in hydrohil.__all__:
        thing = getattr(hydrohil, name)
        is_error = isinstance(thing, type) and issubclass(thing, Exception)
        chapter = "Errors" if is_error else "Classes" if isinstance(thing, type) else "Functions"
        chapters[chapter].append(_documented(name, thing))
    return "\n".join([LIBRARY, *(f"## {chapter}\n\n" + "\n".join(parts) for chapter, parts in chapters.items())])


def _documented(name: str, thing: Any) -> str:
    directive = f"::: {thing.__module__}.{thing.__qualname__}\n    options:\n      heading: {name}\n"
    if not hasattr(thing, "_fields"):
        return directive
    meanings, types = comments_of(thing), written_types(thing)
    rows = ((code(field), code(types.get(field, "")), plain(meanings.get(field, ""))) for field in thing._fields)
    return f"{directive}\n{table(('field', 'type', 'meaning'), rows)}"


def rules() -> str:
    """What trips, most severe first, and what shuts the gate."""
    from hydrohil.explanation.causes import default_limit
    from hydrohil.shared.trips.causes import CUTS, TRIPS

    trips = ((int(cause), code(cause.name), row.holds, default_limit(cause), row.remedy) for cause, row in TRIPS.items() if cause)
    cuts = ((int(cause), code(cause.name), row.holds, row.remedy) for cause, row in CUTS.items() if cause)
    return "\n".join(
        (
            RULES,
            "## Supervisor: what trips\n",
            table(("number", "cause", "what must hold", "limit by default", "what to do"), trips),
            "## Gate: what shuts it\n",
            table(("number", "cause", "what must hold", "what to do"), cuts),
        )
    )


def faults() -> str:
    """What can be injected, and what the fault test tries."""
    from hydrohil.faulttest.matrix import MATRIX
    from hydrohil.shared.contract.faults import ROWS

    injected = (
        (
            row.kind,
            ", ".join(map(code, row.targets)),
            row.words,
            f"{row.low:g}..{row.high:g} {row.unit}" if row.unit else "none",
            ", ".join(row.clocks),
        )
        for row in ROWS
    )
    tried = (
        (row.number, row.fault, row.must, row.bound, "<br>".join(f"{way.letter}: {way.words}" for way in row.ways))
        for row in MATRIX
    )
    return "\n".join(
        (
            "# Faults\n\nMade from the fault tables; [how to use them](../howto/break-it-on-purpose.md).\n",
            INJECTED,
            table(("kind", "target", "what it does", "value", "clocks"), injected),
            TRIED,
            table(("#", "fault", "what must happen", "bound", "how it is tried"), tried),
        )
    )


def experiments() -> str:
    """What ships, and every field that an experiment has."""
    from hydrohil.claims.metrics import METRICS
    from hydrohil.experiment.experiment import Experiment
    from hydrohil.thesis.library import catalogue

    shipped = ((code(e.name), code(e.alias), e.title, len(e.claims)) for e in catalogue())
    metrics = ((code(name), metric.dimension, _first_line(metric.of)) for name, metric in METRICS.items())
    return "\n".join(
        (
            "# Experiments\n\nMade from the code. [Your own experiment](../howto/own-experiment.md) says how to write one.\n",
            "## What ships\n",
            table(("name", "alias", "title", "claims"), shipped),
            FIELDS,
            table(("path", "type", "bounds", "default", "meaning"), fields(Experiment)),
            "## Metrics of claims\n",
            table(("metric", "measures", "meaning"), metrics),
        )
    )


def _first_line(thing: object) -> str:
    return (inspect.getdoc(thing) or "").split("\n")[0]


def generated() -> dict[str, str]:
    """Every generated page, by its path on the site."""
    pages = {here: on_site((ROOT / there).read_text()) for there, here in REPOSITORY_PAGES.items()}
    pages |= {
        "reference/command-line.md": command_line(),
        "reference/library.md": library(),
        "reference/rules.md": rules(),
        "reference/faults.md": faults(),
        "reference/experiments.md": experiments(),
    }
    return pages


def main() -> None:
    """Copy the written pages, write the generated ones."""
    shutil.rmtree(OUT, ignore_errors=True)
    for source in sorted(DOCS.rglob("*")):
        if source.suffix in COPIED:
            target = OUT / source.relative_to(DOCS)
            target.parent.mkdir(parents=True, exist_ok=True)
            if source.suffix == ".md":
                target.write_text(on_site(source.read_text()))
            else:
                shutil.copyfile(source, target)
    for name, text in generated().items():
        (OUT / name).parent.mkdir(parents=True, exist_ok=True)
        (OUT / name).write_text(text)
    print(f"{OUT}: {sum(1 for _ in OUT.rglob('*.md'))} pages")


if __name__ == "__main__":
    main()
