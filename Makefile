# Everything from a fresh Debian machine with python3 (and venv), make and git:
#   make demo    set up, run the main job on the built-in survey, say where the report is
#   make test    set up and run every test
#   make lint    style, types of import, direction of dependencies
#   make bench   speed beside the peers, in one run
#   make bench-pose   accuracy of the joint estimate beside its baselines

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check

.PHONY: demo test lint bench bench-pose format clean

$(VENV)/.run: requirements.lock pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(PIP) --requirement requirements.lock
	$(PIP) --no-deps --no-build-isolation --editable .
	touch $@

$(VENV)/.dev: $(VENV)/.run requirements-dev.lock
	$(PIP) --requirement requirements-dev.lock
	touch $@

demo: $(VENV)/.run
	$(BIN)/springline demo -o demo-report --force

test: $(VENV)/.dev
	$(BIN)/python -m pytest --numprocesses 2 --dist loadfile

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports

format: $(VENV)/.dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: $(VENV)/.dev
	$(BIN)/python -m bench

bench-pose: $(VENV)/.dev
	$(BIN)/python -m bench pose

clean:
	rm -rf $(VENV) demo-report .pytest_cache .ruff_cache .import_linter_cache
