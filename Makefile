# Everything runs in .venv, which is made and kept up to date by itself.
PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/ready
LOG ?= runs/$(shell date +%Y%m%d-%H%M%S).mcap
export OPENBLAS_NUM_THREADS := 1

.PHONY: run test quick check fuzz bench mutation figures clean

run: $(READY)  ## insert 30 parts on the mock cell with the trained skill; log and report go to runs/
	$(BIN)/python hil/run_cell.py --config config/mock_cell.yaml --insertions 30 \
		--controller skill --seed 1 --log $(LOG)

test: check  ## all checks and all tests
	$(BIN)/python -m pytest -n 2

quick: check  ## the short loop: all checks and the tests that take no time
	$(BIN)/python -m pytest -n 2 -m "not slow"

check: $(READY)  ## format, lint, types, layers
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

fuzz: $(READY)  ## the property tests with new examples, other ones each time
	$(BIN)/python -m pytest -n 2 -m hypothesis --hypothesis-profile fuzz

bench: $(READY)  ## speed, measured side by side on this machine
	$(BIN)/python benchmarks/contact_solves.py
	$(BIN)/python benchmarks/engine.py
	$(BIN)/python benchmarks/simulated_time.py
	$(BIN)/python benchmarks/real_time.py
	$(BIN)/python benchmarks/environment.py
	$(BIN)/python benchmarks/policy.py

mutation: $(READY)  ## break supervisor and gate on purpose, and see the tests notice
	$(BIN)/python tests/mutation.py

figures: $(READY)  ## draw the figures of README and docs
	$(BIN)/python docs/make_figures.py

clean:  ## remove everything made here except the logs in runs/
	rm -rf $(VENV) .cache .mypy_cache .ruff_cache .pytest_cache .hypothesis *.egg-info

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys, venv, ensurepip; sys.exit(sys.version_info[:2] != (3, 11))' || \
		{ echo "Tenon needs Python 3.11 with its venv module (Debian: apt install python3.11-venv);" \
		"name it with make PYTHON=/path/to/python3.11"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable ".[dev]"
	@touch $@
