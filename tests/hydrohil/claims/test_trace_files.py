"""Traces as files: the suffix says how, and every bit comes back."""

import numpy as np
import pytest

from hydrohil.claims.trace import Trace
from hydrohil.claims.trace_files import FORMATS, column_names, columns, read_trace, write_trace
from hydrohil.shared.errors import FileError
from tests.hydrohil.claims.test_trace import standing


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_saved_trace_is_read_back_bit_for_bit(suffix, tmp_path):
    noise = np.random.default_rng(1).normal(size=(len(standing(1.0).t_s), 3))
    trace = standing(1.0)._replace(force_n=noise[:, 0], q=noise, sample_age_s=np.full(len(noise), np.nan))
    write_trace(trace, tmp_path / f"trial{suffix}")
    again = read_trace(str(tmp_path / f"trial{suffix}"))
    for name, column, other in zip(Trace._fields, trace, again, strict=True):
        assert np.array_equal(column, other, equal_nan=column.dtype == float) and column.dtype == other.dtype, name


def test_another_suffix_is_refused_with_those_there_are(tmp_path):
    for use in (lambda path: write_trace(standing(0.1), path), read_trace):
        with pytest.raises(FileError, match=r"trial\.xls: .*\.npz, \.csv, \.parquet"):
            use(tmp_path / "trial.xls")
    assert not list(tmp_path.iterdir())


def test_a_file_without_a_column_is_refused_by_name(tmp_path):
    columns = standing(0.1)._asdict()
    del columns["force_n"]
    np.savez(tmp_path / "trial.npz", **columns)
    with pytest.raises(FileError, match="no column force_n"):
        read_trace(tmp_path / "trial.npz")
    (tmp_path / "trial.csv").write_text("tick,t_s\n0,0.0\n")
    with pytest.raises(FileError, match=r"no column q\.rotate, q\.down_up"):
        read_trace(tmp_path / "trial.csv")


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize("content", [b"", b"tick\nno number\n", b"\x00\xff" * 20], ids=["empty", "text", "bytes"])
def test_what_is_no_trace_is_one_line_that_names_the_file(suffix, content, tmp_path):
    path = tmp_path / f"trial{suffix}"
    path.write_bytes(content)
    with pytest.raises(FileError, match=f"trial{suffix} is no trace") as refused:
        read_trace(path)
    assert "\n" not in str(refused.value)


def test_a_table_has_a_column_a_link_and_an_axis_and_they_are_the_traces_own():
    trace = standing(0.1)
    trace.q[:, 1], trace.x_m[:, 2] = 0.25, 0.5
    table = columns(trace)
    assert set(table["q.down_up"]) == {0.25} and set(table["x_m.z"]) == {0.5}
    assert column_names("encoder_counts") == tuple(f"encoder_counts.{k}" for k in range(5))
    assert all(column.shape == trace.t_s.shape for column in table.values())
