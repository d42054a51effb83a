from hydrohil.shared.contract.messages import Command, Sample
from hydrohil.shared.contract.topics import BY_KEY, BY_SCHEMA, SERVICES, TOPICS, WARMUP, expression


def test_keys_and_schemas_name_one_topic_each():
    assert len(BY_KEY) == len(TOPICS) + 1
    assert len(BY_SCHEMA) == len(TOPICS) + 3
    assert {topic.publisher for topic in TOPICS} <= set(SERVICES)


def test_every_topic_of_the_loop_has_a_deadline_and_comes_once_a_sample():
    loop = [topic for topic in TOPICS if topic.loop]
    assert {topic.key for topic in loop} == {"plant/sample", "controller/command", "supervisor/permit"}
    assert all(topic.deadline and topic.per_sample for topic in loop)


def test_a_warm_up_frame_cannot_be_taken_for_a_sample_and_is_not_recorded():
    assert (WARMUP.message, WARMUP.publisher) == (Sample, "plant")
    assert WARMUP not in TOPICS and WARMUP.schema != BY_KEY["plant/sample"].schema


def test_cells_share_a_network_by_their_keys():
    assert expression("left", "plant/sample") == "hydrohil/left/plant/sample"
    assert (BY_KEY["plant/sample"].message, BY_KEY["controller/command"].message) == (Sample, Command)
