"""A host as found: from what was granted and from its files."""

import os

from hydrohil.qualification.host import IDLE, found


def files(root, **texts):
    for name, text in texts.items():
        path = root / name.replace("__", "/")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def properties(root, **granted):
    return {row.what: row for row in found(granted, 0.1, root)}


def test_a_host_that_is_set_up_well_is_described_so(tmp_path):
    files(
        tmp_path,
        sys__kernel__realtime="1\n",
        sys__devices__system__cpu__smt__active="0\n",
        sys__devices__system__cpu__isolated="2-3\n",
        sys__devices__system__cpu__cpu0__cpufreq__scaling_governor="performance\n",
        sys__devices__system__cpu__cpu1__cpufreq__scaling_governor="performance\n",
        proc__cpuinfo="flags : fpu vme\n",
    )
    rows = properties(tmp_path, fifo=True, memory_locked=True, idle_latency=True)
    names = (
        "SCHED_FIFO",
        "mlockall",
        "/dev/cpu_dma_latency",
        "frequency governor",
        "SMT",
        "isolated processors",
        "kernel",
        "machine",
    )
    assert [rows[name].good for name in names] == [True] * len(names)
    assert "PREEMPT_RT" in rows["kernel"].found and rows["isolated processors"].found == "2-3"


def test_a_host_that_is_not_is_shown_what_would_help(tmp_path):
    files(
        tmp_path,
        sys__devices__system__cpu__smt__active="1\n",
        sys__devices__system__cpu__cpu0__cpufreq__scaling_governor="performance\n",
        sys__devices__system__cpu__cpu1__cpufreq__scaling_governor="powersave\n",
        proc__cpuinfo="flags : fpu hypervisor vme\n",
    )
    rows = properties(tmp_path, fifo=False)
    names = ("SCHED_FIFO", "mlockall", "/dev/cpu_dma_latency", "frequency governor", "SMT", "isolated processors", "machine")
    assert [rows[name].good for name in names] == [False] * len(names)
    assert all(row.advice for row in rows.values())


def test_what_a_host_does_not_say_is_neither_good_nor_bad(tmp_path):
    rows = properties(tmp_path)
    assert [rows[name].good for name in ("frequency governor", "SMT")] == [None, None]


def test_a_load_on_the_limit_is_idle_and_more_is_not(tmp_path):
    limit = IDLE * len(os.sched_getaffinity(0))
    assert [found({}, load, tmp_path)[-1].good for load in (limit, limit + 0.01)] == [True, False]
