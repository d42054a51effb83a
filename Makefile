PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: install demo test check slow coverage mutants fuzz docs lock clean

install: $(STAMP)

$(STAMP): pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "hydrohil needs Python 3.11 or later: make PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $(STAMP)

# A lease of 100 ms: on a host that stalls for longer than a few ms now and then, the default of 20 ms trips.
# Unqualified: it moves no machine, so it runs on any host, whatever `hydrohil qualify` has said of it.
DEMO := --permit-ttl-ms 100 --unqualified

demo: install
	$(BIN)/hydrohil run fig-4-25 $(DEMO) --rrd runs/fig-4-25.rrd --json runs/fig-4-25.json
	$(BIN)/hydrohil run fig-5-5 $(DEMO) --rrd runs/fig-5-5.rrd --json runs/fig-5-5.json
	@echo "recordings in runs/: $(BIN)/hydrohil view runs/fig-4-25.rrd"

test: install
	$(BIN)/python -m pytest

check: install
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# Kernels run plain, so that their branches count; fails below 100 %.
COVERED := tests/plant/test_gate_*.py tests/supervisor/test_*.py tests/proof/test_black_channel.py tests/proof/test_wire_fuzz.py \
	tests/shared/transport/test_acceptance.py tests/shared/transport/test_bus.py tests/shared/contract/test_codec.py tests/shared/transport/test_inbox.py \
	tests/shared/transport/test_protection.py tests/shared/transport/test_link_stats.py tests/shared/transport/test_requests.py tests/shared/contract/test_timeliness.py tests/shared/transport/test_step_lock.py \
	tests/plant/test_gatekeeper*.py tests/shared/host/test_lease.py tests/shared/host/test_two_phase_load.py tests/plant/test_ledger.py tests/plant/test_mailbox.py \
	tests/plant/test_cause_values.py

coverage: install
	NUMBA_DISABLE_JIT=1 $(BIN)/python -m coverage run -m pytest -q $(COVERED)
	$(BIN)/python -m coverage report

mutants: install
	$(BIN)/python bench/mutate.py

fuzz: install
	$(BIN)/python bench/fuzz.py --count 1000000

slow: install
	$(BIN)/python -m pytest -m slow

# The site in build/site; fails on a link or an anchor that leads nowhere.
docs: install
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[docs]'
	$(BIN)/python -m docs.generate
	$(BIN)/zensical build --clean --strict

# The versions of .venv become those that CI installs.
lock: install
	echo '# Versions that CI installs; `make lock` writes them anew from a fresh .venv.' > .ci/constraints.txt
	$(BIN)/python -m pip freeze --exclude-editable >> .ci/constraints.txt

clean:
	rm -rf $(VENV) runs build .pytest_cache .mypy_cache .ruff_cache .hypothesis .coverage *.egg-info
