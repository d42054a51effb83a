"""What the plant's command line refuses."""

import pytest

from hydrohil.services.plant.main import main


@pytest.mark.parametrize("lease_ms", ["nan", "inf", "-inf", "-5", "0", "201", "1e300"])
def test_a_lease_that_is_none_is_refused_in_one_line(lease_ms: str, capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit) as ended:
        main([f"--permit-ttl-ms={lease_ms}"])
    assert ended.value.code == 2 and "the lease must be in 0..200 ms" in capsys.readouterr().err
