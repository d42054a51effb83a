"""What `hydrohil tune` prints: the evidence of every step, the gains beside Table 2, and the errors that they give."""

import math

from rich.console import Console
from rich.table import Table

from hydrohil.shared.machine.description import LINKS
from hydrohil.tuning.bench import Step, rad_per_unit, unit
from hydrohil.tuning.procedure import LinkTuning
from hydrohil.tuning.tune import Tuning

WHOLE_FROM = 1000.0  # numbers from here on are shown without decimals


def cell(value: float | int | str) -> str:
    """A number as people read it; what a trial that tripped does not determine is named so."""
    if not isinstance(value, float):
        return str(value)
    if not math.isfinite(value):
        return "tripped" if value > 0.0 else "-"
    return f"{value:.0f}" if abs(value) >= WHOLE_FROM else f"{value:.4g}"


def show_step(console: Console, link: str, step: Step) -> None:
    """Question, evidence and decision of one step."""
    table = Table(*step.columns)
    for row in step.rows:
        table.add_row(*(cell(value) for value in row))
    colour = "red" if step.gains is None else "green"
    console.print(f"[bold]{link}, step {step.number}: {step.title}[/]\n{step.rule}", highlight=False)
    console.print(table)
    console.print(f"[{colour}]{step.decision}[/]\n", highlight=False)


def show(console: Console, tuning: Tuning) -> None:
    """Gains beside their reference and the five patterns, link by link."""
    for link in tuning.links:
        if link.gains is None:
            failed = link.steps[-1]
            console.print(
                f"[red bold]{LINKS[link.link]}: step {failed.number} found no acceptable value[/]: {failed.decision}",
                highlight=False,
            )
            continue
        name, rows = tuning.compared(link)
        console.print(f"[bold]{LINKS[link.link]}[/]", highlight=False)
        table = Table("gain", "unit", "tuned", name, "ratio", "why different")
        for row in rows:
            table.add_row(row.gain, row.unit, cell(row.tuned), cell(row.reference), f"{row.ratio:.2f}", row.why)
        console.print(table)
        console.print(worth_table(link))
    console.print(f"{tuning.trials} trials in {tuning.wall_s:.1f} s", highlight=False)


def worth_table(link: LinkTuning) -> Table:
    """The five patterns before and after."""
    scale, name = rad_per_unit(link.link), unit(link.link)
    table = Table("final law, rms error", f"before, {name}", f"tuned, {name}", "ratio")
    for one in link.worth:
        ratio = one.tuned_q / one.before_q
        table.add_row(one.pattern, cell(one.before_q / scale), cell(one.tuned_q / scale), f"{ratio:.2f}")
    return table
