"""Whether the controller keeps up with the samples: judged by the supervisor, told by the recorder."""

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import Sample

LATE_IN_A_ROW = 3  # more of them warn; the lease decides when it is borne no more


@kernel
def answered_in_time(sample: Sample) -> bool:
    """Whether the command that answers the sample before this one was in force at its latch."""
    return sample.command_number == sample.number - 1 and sample.command_late_substeps == 0
