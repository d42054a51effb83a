"""Every figure of the thesis that is computed rather than tried, in the order of the thesis."""

from analysis import deadband, explicit_force, gauge, loop_studies, plate, stiction, velocity
from experiments.study import Study

STUDIES: tuple[Study, ...] = (
    *deadband.STUDIES,
    *stiction.STUDIES,
    explicit_force.STUDY,
    *loop_studies.STUDIES,
    plate.STUDY,
    gauge.STUDY,
    *velocity.STUDIES,
)
