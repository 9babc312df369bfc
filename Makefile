# Everything runs in .venv, made from a hash-pinned lock by the first target that needs it.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
TEST_JOBS ?= 2

.PHONY: install demo test lint format bench bench-sph-validation bench-rigid-validation lock clean help

help:  ## Say what can be made
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 10

install: $(STAMP)  ## Make .venv and install wsim in it

$(STAMP): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit("wsim needs Python 3.11 or newer, this is " + sys.version.split()[0]) if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes --no-deps -r requirements.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps --editable .
	@touch $(STAMP)

demo: install  ## A sentence becomes a judged world
	$(BIN)/wsim generate "Three wooden blocks float on the water in a glass tank while a steel ball drops in and sinks." --yes

# Tests start hundreds of Pythons: where none may keep what it compiled, each compiles wsim anew. A worker that crashes
# ends them: xdist would wait for ever for the group that it had.
test: install  ## Run the tests
	PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -n $(TEST_JOBS) --dist loadscope --no-loadscope-reorder --max-worker-restart 0 $(PYTEST_ARGS)

lint: install  ## Check format, lint, types and import directions
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: install  ## Format and fix
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

bench: install  ## Measure what the README claims
	$(BIN)/python benchmarks/sph_scenes.py

bench-sph-validation: install  ## Hold the fluid against flows whose answer is known
	$(BIN)/python benchmarks/sph_validation.py --device auto --json build/sph_validation/results.json \
		--markdown build/sph_validation/table.md --plots build/sph_validation/plots

bench-rigid-validation: install  ## Hold rigid bodies against motions whose answer is known
	$(BIN)/python benchmarks/rigid_validation.py --device auto --write --plot

lock:  ## Pin the versions of pyproject.toml (needs uv)
	uv pip compile pyproject.toml --extra dev --universal --python-version 3.11 --generate-hashes \
		--no-emit-index-url --no-emit-find-links --no-header --quiet --output-file requirements.lock

clean:  ## Remove what was made
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache
