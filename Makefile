# `make explore` and `make test` do everything; they need git, make and Python 3.11 or newer.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# pip speaks only when something is wrong.
PIP := PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore PIP_NO_INPUT=1 $(BIN)/python -m pip -qq
LOCK := $(BIN)/uv pip compile --quiet --universal --fork-strategy fewest --python-version 3.11 \
	--no-header --no-annotate --no-emit-index-url --no-emit-find-links
SEED := 5

# One thread per process: the arrays are small, and a second thread only waits for the first.
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1
export PYTHONNOUSERSITE := 1
unexport PYTHONPATH

.PHONY: help explore serve test lint docs bench lock clean
.DELETE_ON_ERROR:

help:
	@echo "make explore   explore two objects: a recorded banana, then a simulated trick object"
	@echo "make serve     show a store with example data at http://127.0.0.1:8000/"
	@echo "make test      formatting, lint, types, layers, tests, examples, documentation"
	@echo "make docs      build the documentation in docs/_build/html"
	@echo "make bench     measure speed and accuracy and print them as a table"
	@echo "make lock      pin the newest versions of all dependencies in requirements/"
	@echo "make clean     remove the environment and everything that was built"

explore: $(VENV)/run.stamp
	@printf '\n== A real session, replayed: a robot meets the plastic banana of the YCB set ==\n'
	@$(BIN)/palpate explore banana_ycb --robot replay
	@printf '\n== A simulated trick object: a wineglass that looks like glass and is plastic ==\n'
	@$(BIN)/palpate explore wineglass_ycb --robot sampled --seed $(SEED)

# What is served needs more than exploring does; its versions are those of the development tools.
serve: $(VENV)/serve.stamp
	@$(BIN)/palpate serve --example --store $(VENV)/example.sqlite

test: lint
	@echo "== tests and examples"
	@$(BIN)/python -m pytest -q -n 2 --dist loadfile -m "not alone"
	@$(BIN)/python -m pytest -q -m alone tests
	@$(MAKE) --no-print-directory docs

lint: $(VENV)/dev.stamp
	@echo "== format and lint (ruff)"
	@$(BIN)/ruff format --check --quiet . || { echo "run '$(BIN)/ruff format .'"; exit 1; }
	@$(BIN)/ruff check --quiet .
	@echo "== types (mypy --strict)"
	@$(BIN)/mypy --no-error-summary
	@echo "== layers (import-linter)"
	@$(BIN)/lint-imports --no-logo > $(VENV)/layers.log 2>&1 || { cat $(VENV)/layers.log; exit 1; }

docs: $(VENV)/dev.stamp
	@echo "== documentation (sphinx, warnings are errors)"
	@$(BIN)/sphinx-build -q -W --keep-going -b html docs docs/_build/html
	@echo "docs/_build/html/index.html"

bench: $(VENV)/bench.stamp
	@$(BIN)/python -m pytest benchmarks -q --benchmark-only --benchmark-quiet

lock: $(VENV)/run.stamp
	@$(PIP) install uv
	@$(LOCK) --upgrade pyproject.toml --group dev -o requirements/dev.txt
	@$(LOCK) pyproject.toml --group build --extra store -c requirements/dev.txt -o requirements/run.txt
	@$(LOCK) pyproject.toml --group build --extra store --extra server -c requirements/dev.txt -o requirements/serve.txt
	@$(LOCK) pyproject.toml --group build --group bench --extra store -c requirements/dev.txt -o requirements/bench.txt

clean:
	rm -rf $(VENV) build dist docs/_build docs/api/generated .benchmarks .hypothesis \
		.import_linter_cache .mypy_cache .pytest_cache .ruff_cache
	find src tests benchmarks docs -name __pycache__ -type d -prune -exec rm -rf {} +

# Each stamp is newer than what it was made from, so that a second run starts at once.
$(VENV)/run.stamp: requirements/run.txt pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
		echo "palpate needs Python 3.11 or newer, and '$(PYTHON)' is not: run 'make PYTHON=/path/to/python3.11 ...'" >&2; \
		exit 1; }
	@echo "Setting up $(VENV) (a minute or two, once) ..."
	@$(PYTHON) -m venv --clear $(VENV)
	@$(PIP) install -r requirements/run.txt
	@$(PIP) install --no-deps --no-build-isolation --editable .
	@touch $@

$(VENV)/dev.stamp: requirements/dev.txt $(VENV)/run.stamp
	@echo "Adding the development tools to $(VENV) (a minute, once) ..."
	@$(PIP) install -r requirements/dev.txt
	@touch $@

$(VENV)/serve.stamp: requirements/serve.txt $(VENV)/run.stamp
	@echo "Adding what the server needs to $(VENV) (a minute, once) ..."
	@$(PIP) install -r requirements/serve.txt
	@touch $@

$(VENV)/bench.stamp: requirements/bench.txt $(VENV)/dev.stamp
	@echo "Adding the benchmark tools to $(VENV) (a minute, once) ..."
	@$(PIP) install -r requirements/bench.txt
	@touch $@
