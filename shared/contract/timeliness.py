"""Whether the controller keeps up with the samples: the supervisor judges it, the recorder logs it."""

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import Sample

LATE_IN_A_ROW = 3  # more of them give a warning; the lease decides when they are a trip


@kernel
def answered_in_time(sample: Sample) -> bool:
    """Whether the command that answers the sample before this one was in force at its latch."""
    return sample.command_number == sample.number - 1 and sample.command_late_substeps == 0
