# Two commands on a fresh machine: `make demo` and `make test`. Python >= 3.11 and make are all they need.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: test ready run demo docs lint loops modules clean

# The package alone: loops are compiled while the rest is installed. pip would compile modules on one core.
$(VENV)/.measures: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile -e .
	-$(BIN)/python -m compileall -q -j 0 $(VENV)/lib > /dev/null
	touch $@

$(VENV)/.installed: $(VENV)/.measures
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[test,lint]"
	touch $@

test:
	$(MAKE) --jobs=2 ready
	$(MAKE) run

ready: loops lint modules

# In lots of at most 200 tests: one core is not left with all the long ones of the end.
run: $(VENV)/.installed
	$(BIN)/python -m pytest -n 2 --maxschedchunk 200

lint: $(VENV)/.installed
	$(BIN)/ruff check src tests benchmarks docs
	$(BIN)/ruff format --check src tests benchmarks docs
	$(BIN)/mypy

# Compiled once, beside the linters, and not by each process that runs tests.
loops: $(VENV)/.measures
	$(BIN)/python tests/compile_loops.py

# The same of all modules of tests, while a core has nothing to do; what fails here is said by the run of tests.
modules: $(VENV)/.installed
	-$(BIN)/python -m pytest --collect-only --quiet > /dev/null

demo: $(VENV)/.installed
	$(BIN)/acutance demo demo

# Commands of the pages that take minutes, and those of the README, are run here; all others by `make test`.
docs: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[docs]"
	$(BIN)/python -m sphinx -W --keep-going -b html docs docs/_build/html
	PAGES=all $(BIN)/python -m pytest tests/docs

clean:
	find src -name '*.nb[ic]' -delete
	rm -f docs/examples/*.png
	rm -rf $(VENV) docs/_build docs/gallery docs/generated demo
