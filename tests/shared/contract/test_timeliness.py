from hydrohil.shared.contract.timeliness import LATE_IN_A_ROW, answered_in_time
from tests.support.supervisor_scene import sample


def test_an_answer_is_in_time_if_it_was_in_force_at_the_latch_of_its_sample():
    assert answered_in_time(sample(50, 5, command_number=49))
    assert not answered_in_time(sample(50, 5, command_number=48))
    assert not answered_in_time(sample(50, 5, command_number=50))
    assert not answered_in_time(sample(50, 5, command_number=49, command_late_substeps=1))
    assert answered_in_time(sample(50, 5, command_number=49, command_late_substeps=0))


def test_more_than_three_in_a_row_warn():
    assert LATE_IN_A_ROW == 3
