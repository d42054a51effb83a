"""What `hydrohil tune` prints and writes: the evidence of every step, the gains beside Table 2, what they are worth."""

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

from rich.console import Console
from rich.table import Table

from hydrohil.experiment.experiment import Experiment, to_toml
from hydrohil.experiment.sections import LinkGains
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.shared.contract.faults import LINKS
from hydrohil.shared.contract.link_units import written_name
from hydrohil.shared.exit_status import EXIT_CLAIM, EXIT_OK
from hydrohil.tuning.bench import Criteria, Step, rad_per_unit, unit
from hydrohil.tuning.compare import Compared, compare, reference
from hydrohil.tuning.procedure import LinkTuning

WHOLE_FROM = 1000.0  # numbers from here on are shown without decimals


class TuneReport(NamedTuple):
    """All links that were tuned."""

    experiment: Experiment
    criteria: Criteria
    seeds: int
    links: tuple[LinkTuning, ...]
    trials: int
    wall_s: float

    @property
    def exit_status(self) -> int:
        """1 if a step of a link found no acceptable value."""
        return EXIT_OK if all(link.gains is not None for link in self.links) else EXIT_CLAIM


def tuned_experiment(report: TuneReport) -> Experiment:
    """The experiment with the gains of every link that was tuned."""
    experiment = report.experiment
    tuned = {LINKS[link.link]: link.gains for link in report.links if link.gains is not None}
    return experiment._replace(
        name=f"{experiment.name}-tuned",
        alias=f"{experiment.alias}-tuned",
        title=f"{experiment.title}, tuned gains",
        controller=experiment.controller._replace(gains=experiment.controller.gains._replace(**tuned)),
    )


def cell(value: float | int | str) -> str:
    """A number as people read it; what a trial that tripped does not determine is named so."""
    if not isinstance(value, float):
        return str(value)
    if not math.isfinite(value):
        return "tripped" if value > 0.0 else "-"
    return f"{value:.0f}" if abs(value) >= WHOLE_FROM else f"{value:.4g}"


def show_step(console: Console, link: int, step: Step) -> None:
    """Question, evidence and decision of one step."""
    table = Table(*step.columns)
    for row in step.rows:
        table.add_row(*(cell(value) for value in row))
    colour = "red" if step.gains is None else "green"
    console.print(f"[bold]{LINKS[link]}, step {step.number}: {step.title}[/]\n{step.rule}", highlight=False)
    console.print(table)
    console.print(f"[{colour}]{step.decision}[/]\n", highlight=False)


def compared(report: TuneReport, link: LinkTuning) -> tuple[str, tuple[Compared, ...]]:
    """What the gains are set against, and the rows."""
    name, gains = reference(report.experiment.plant, report.experiment.controller.gains)
    return name, compare(link, name, gains[link.link], report.criteria)


def show(console: Console, report: TuneReport) -> None:
    """Gains beside their reference and the five patterns, link by link."""
    for link in report.links:
        if link.gains is None:
            failed = link.steps[-1]
            console.print(
                f"[red bold]{LINKS[link.link]}: step {failed.number} found no acceptable value[/]: {failed.decision}",
                highlight=False,
            )
            continue
        name, rows = compared(report, link)
        console.print(f"[bold]{LINKS[link.link]}[/]", highlight=False)
        table = Table("gain", "unit", "tuned", name, "ratio", "why different")
        for row in rows:
            table.add_row(row.gain, row.unit, cell(row.tuned), cell(row.reference), f"{row.ratio:.2f}", row.why)
        console.print(table)
        console.print(worth_table(link))
    console.print(f"{report.trials} trials in {report.wall_s:.1f} s", highlight=False)


def worth_table(link: LinkTuning) -> Table:
    """The five patterns before and after."""
    scale, name = rad_per_unit(link.link), unit(link.link)
    table = Table("final law, rms error", f"before, {name}", f"tuned, {name}", "ratio")
    for one in link.worth:
        ratio = one.tuned_q / one.before_q
        table.add_row(one.pattern, cell(one.before_q / scale), cell(one.tuned_q / scale), f"{ratio:.2f}")
    return table


def plain(report: TuneReport) -> dict[str, Any]:
    """The report as data; a number that a trial did not determine is null."""
    return {
        "experiment": report.experiment.name,
        "seeds": report.seeds,
        "criteria": report.criteria._asdict(),
        "trials": report.trials,
        "wall_s": report.wall_s,
        "exit_status": report.exit_status,
        "source_version": source_version(),
        "links": [_link(report, link) for link in report.links],
    }


def _link(report: TuneReport, link: LinkTuning) -> dict[str, Any]:
    name, rows = compared(report, link)
    return {
        "link": LINKS[link.link],
        "steps": [_step(step) for step in link.steps],
        "gains": None if link.gains is None else _si(link.gains, LINKS[link.link]),
        "compared_with": name,
        "compared": [row._asdict() | {"ratio": _number(row.ratio)} for row in rows],
        "worth": [
            {written_name(name, LINKS[link.link]): _number(value) for name, value in one._asdict().items()} for one in link.worth
        ],
    }


def _step(step: Step) -> dict[str, Any]:
    rows = [dict(zip(step.columns, map(_number, row), strict=True)) for row in step.rows]
    return {"number": step.number, "title": step.title, "rule": step.rule, "evidence": rows, "decision": step.decision}


def _si(gains: LinkGains, link: str) -> dict[str, float]:
    return {written_name(name, link): float(value) for name, value in gains._asdict().items()}


def _number(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_json(path: Path, report: TuneReport) -> None:
    """Write the report."""
    path.write_text(json.dumps(plain(report), indent=2, allow_nan=False) + "\n", encoding="utf-8")


def write_toml(path: Path, report: TuneReport) -> None:
    """Write an experiment with the tuned gains that runs."""
    path.write_text(to_toml(tuned_experiment(report)), encoding="utf-8")
