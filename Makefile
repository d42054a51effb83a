PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: install demo test check slow clean

install: $(STAMP)

$(STAMP): pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "hydrohil needs Python 3.11 or later: make PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $(STAMP)

# A lease of 100 ms: on a host that stalls for longer than a few ms now and then, the default of 20 ms trips.
LEASE := --permit-ttl-ms 100

demo: install
	$(BIN)/hydrohil run fig-4-25 $(LEASE) --rrd runs/fig-4-25.rrd --json runs/fig-4-25.json
	$(BIN)/hydrohil run fig-5-5 $(LEASE) --rrd runs/fig-5-5.rrd --json runs/fig-5-5.json
	@echo "recordings in runs/: $(BIN)/hydrohil view runs/fig-4-25.rrd"

test: install
	$(BIN)/python -m pytest

check: install
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

slow: install
	$(BIN)/python -m pytest -m slow

clean:
	rm -rf $(VENV) runs .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info
