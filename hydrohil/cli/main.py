"""`hydrohil`: the entry point. Each command imports what it needs, so that a service starts fast."""

from hydrohil.cli import (
    analysis_commands,
    campaign_command,
    cell_commands,
    experiment_commands,
    explain_command,
    faults_command,
    inject_command,
    qualify_command,
    reproduce_command,
    service_commands,
    set_command,
    trip_command,
    tune_command,
)
from hydrohil.cli.options import app

__all__ = [
    "analysis_commands",
    "app",
    "campaign_command",
    "cell_commands",
    "experiment_commands",
    "explain_command",
    "faults_command",
    "inject_command",
    "main",
    "qualify_command",
    "reproduce_command",
    "service_commands",
    "set_command",
    "trip_command",
    "tune_command",
]


def main() -> None:
    """Entry point."""
    app()


if __name__ == "__main__":
    main()
