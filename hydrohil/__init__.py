"""A distributed hardware-in-the-loop rig for force-controlled hydraulic manipulators, as a library.

    import hydrohil as hh

    run = hh.simulate(hh.load("fig-5-5").with_values({"controller.law": "pi"}), seed=3)
    print(run, run.trace.force_n.max())

Everything that a program needs is one of the names in `__all__`; each says its shapes, units, errors and source. Positions `q`
are in rad, rad and m, in the order of the links `rotate`, `down_up`, `out_in`; everything else is in SI, with the unit in the
name. Whatever is refused raises a `HydrohilError` of one clear line a problem; nothing is printed.

A name is imported when it is first used (PEP 562): `import hydrohil` alone loads nothing, since every service starts with it.
"""

from importlib import import_module

TYPE_CHECKING = False  # of `typing`, which would be loaded for it
if TYPE_CHECKING:  # what type checkers and editors see; a test holds that it is the table below
    from hydrohil.campaign.cluster import ClusterError
    from hydrohil.campaign.run import CampaignProgress, CampaignResult, run_campaign
    from hydrohil.campaign.store import StoreError
    from hydrohil.cell.cell import Cell
    from hydrohil.cell.processes import CellError, NotConfirmedError, RefusedError, TrippedError, UnqualifiedError
    from hydrohil.claims.claims import Claim, Verdict, judge
    from hydrohil.claims.trace import Trace
    from hydrohil.claims.trace_files import read_trace, write_trace
    from hydrohil.experiment.errors import ExperimentError
    from hydrohil.experiment.experiment import Experiment, validate, warnings
    from hydrohil.experiment.run import Run
    from hydrohil.experiment.sections import (
        AdaptationConfig,
        ControllerConfig,
        Environment,
        GateLimits,
        ImpedanceConfig,
        LinkGains,
        LinkParams,
        MachineParams,
        PlantConfig,
        ScheduledChange,
        Segment,
        SupervisorConfig,
    )
    from hydrohil.explanation.causes import Explanation, explain
    from hydrohil.faulttest.run import FaultTestProgress, run_fault_tests
    from hydrohil.linear.linearize import Linearization, linearize
    from hydrohil.qualification.qualify import Qualification, QualificationProgress, qualify
    from hydrohil.recording.recording import Recording, TopicRecord, read_recording
    from hydrohil.recording.trips import read_trip, write_trip
    from hydrohil.reproduction.report import Report
    from hydrohil.reproduction.reproduce import ReproductionProgress, reproduce
    from hydrohil.shared.contract.faults import Fault
    from hydrohil.shared.errors import FileError, HydrohilError, MissingPackageError, UnknownNameError
    from hydrohil.simulation.simulate import simulate
    from hydrohil.thesis.library import catalogue, load
    from hydrohil.tuning.tune import Tuning, TuningProgress, tune

_NAMES_OF = {  # module: its public names
    "thesis.library": (
        "catalogue",
        "load",
    ),
    "experiment.experiment": (
        "Experiment",
        "validate",
        "warnings",
    ),
    "experiment.sections": (
        "AdaptationConfig",
        "ControllerConfig",
        "Environment",
        "GateLimits",
        "ImpedanceConfig",
        "LinkGains",
        "LinkParams",
        "MachineParams",
        "PlantConfig",
        "ScheduledChange",
        "Segment",
        "SupervisorConfig",
    ),
    "claims.claims": (
        "Claim",
        "Verdict",
        "judge",
    ),
    "shared.contract.faults": ("Fault",),
    "simulation.simulate": ("simulate",),
    "experiment.run": ("Run",),
    "claims.trace": ("Trace",),
    "claims.trace_files": (
        "read_trace",
        "write_trace",
    ),
    "recording.recording": (
        "Recording",
        "TopicRecord",
        "read_recording",
    ),
    "recording.trips": (
        "read_trip",
        "write_trip",
    ),
    "cell.cell": ("Cell",),
    "cell.processes": (
        "CellError",
        "NotConfirmedError",
        "RefusedError",
        "TrippedError",
        "UnqualifiedError",
    ),
    "linear.linearize": (
        "Linearization",
        "linearize",
    ),
    "tuning.tune": (
        "Tuning",
        "TuningProgress",
        "tune",
    ),
    "campaign.run": (
        "CampaignProgress",
        "CampaignResult",
        "run_campaign",
    ),
    "qualification.qualify": (
        "Qualification",
        "QualificationProgress",
        "qualify",
    ),
    "explanation.causes": (
        "Explanation",
        "explain",
    ),
    "reproduction.reproduce": (
        "ReproductionProgress",
        "reproduce",
    ),
    "reproduction.report": ("Report",),
    "faulttest.run": (
        "FaultTestProgress",
        "run_fault_tests",
    ),
    "shared.errors": (
        "FileError",
        "HydrohilError",
        "MissingPackageError",
        "UnknownNameError",
    ),
    "experiment.errors": ("ExperimentError",),
    "campaign.cluster": ("ClusterError",),
    "campaign.store": ("StoreError",),
}
_MODULE_OF = {name: module for module, names in _NAMES_OF.items() for name in names}

__all__ = [
    "AdaptationConfig",
    "CampaignProgress",
    "CampaignResult",
    "Cell",
    "CellError",
    "Claim",
    "ClusterError",
    "ControllerConfig",
    "Environment",
    "Experiment",
    "ExperimentError",
    "Explanation",
    "Fault",
    "FaultTestProgress",
    "FileError",
    "GateLimits",
    "HydrohilError",
    "ImpedanceConfig",
    "Linearization",
    "LinkGains",
    "LinkParams",
    "MachineParams",
    "MissingPackageError",
    "NotConfirmedError",
    "PlantConfig",
    "Qualification",
    "QualificationProgress",
    "Recording",
    "RefusedError",
    "Report",
    "ReproductionProgress",
    "Run",
    "ScheduledChange",
    "Segment",
    "StoreError",
    "SupervisorConfig",
    "TopicRecord",
    "Trace",
    "TrippedError",
    "Tuning",
    "TuningProgress",
    "UnknownNameError",
    "UnqualifiedError",
    "Verdict",
    "catalogue",
    "explain",
    "judge",
    "linearize",
    "load",
    "qualify",
    "read_recording",
    "read_trace",
    "read_trip",
    "reproduce",
    "run_campaign",
    "run_fault_tests",
    "simulate",
    "tune",
    "validate",
    "warnings",
    "write_trace",
    "write_trip",
]

if not TYPE_CHECKING:

    def __getattr__(name):
        """A public name, imported now. Raises AttributeError for what is none."""
        if name == "__version__":
            return import_module("importlib.metadata").version("hydrohil")
        if name not in _MODULE_OF:
            raise AttributeError(f"module 'hydrohil' has no attribute {name!r}")
        value = getattr(import_module(f"hydrohil.{_MODULE_OF[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    """The public names, and what every module has."""
    return sorted({*globals(), *__all__})
