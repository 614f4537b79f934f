# Entry point of the repository: `make help` lists the targets. Every target does its own set-up.
#
#   make PYTHON=python3.12 test    another Python for the virtual environment
#   make test PYTEST="-k mean -x"  arguments for pytest
#   make test JOBS=1               how many tests run at the same time
#   make bench BENCH="rotations"   arguments for the benchmarks
#   make test-properties SEEDS=20  number of seeds of the property tests

PYTHON ?= python3
VENV ?= .venv
PYTEST ?=
JOBS ?= 2
BENCH ?=
TRAIN ?=
SEEDS ?= 20

ifeq ($(OS),Windows_NT)
BIN := $(VENV)/Scripts
else
BIN := $(VENV)/bin
endif

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

# One interpreter for every build of the bindings, or each tool rebuilds them for its own.
export PYO3_PYTHON := $(abspath $(BIN)/python)
export PIP_DISABLE_PIP_VERSION_CHECK := 1

CRATES := -p quatfilt-core -p quatfilt-formats
RUST_SOURCES := Cargo.toml Cargo.lock $(shell find rust -name '*.rs' -o -name Cargo.toml)

.PHONY: help  ## List the targets
help:
	@grep -E '^\.PHONY: .*  ## ' $(firstword $(MAKEFILE_LIST)) \
		| awk 'BEGIN {FS = "^\\.PHONY: |  ## "} {printf "  make %-18s %s\n", $$2, $$3}'

# ---- set-up: stamp files in the virtual environment mark the steps that are done

.PHONY: prerequisites
prerequisites:
	@sh .ci/prerequisites "$(PYTHON)"

$(VENV)/.pip:
	@sh .ci/prerequisites "$(PYTHON)"
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade 'pip>=25.1'
	@touch $@

$(VENV)/.group-%: pyproject.toml $(VENV)/.pip
	$(BIN)/python -m pip install --quiet --group $*
	@touch $@

# Python sources are installed in place and need no rebuild.
$(VENV)/.built: $(RUST_SOURCES) pyproject.toml $(VENV)/.group-build
	@sh .ci/prerequisites "$(PYTHON)"
	$(BIN)/maturin develop --release --locked --extras plot,wavelet
	@touch $@

.PHONY: build  ## Set up the virtual environment and build the package into it
build: $(VENV)/.built

# ---- what users run

.PHONY: demo  ## Clean a synthetic walk: a table of measures, BVH files and a picture in out/demo
demo: build
	$(BIN)/quatfilt demo -o out/demo

# ---- what developers run

.PHONY: test  ## Run all tests, Rust and Python
test: test-rust test-python

.PHONY: test-rust  ## Run the tests and doctests of the Rust crates
test-rust: prerequisites
	cargo test --locked $(CRATES)

.PHONY: test-python  ## Run the tests and doctests of the Python package (arguments: PYTEST="...")
test-python: build $(VENV)/.group-test
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal tests python/quatfilt $(PYTEST)

.PHONY: test-properties  ## Run the property tests with SEEDS other random seeds (arguments: SEEDS=20 PYTEST="...")
test-properties: build $(VENV)/.group-test
	@failed=; for seed in $$(seq $(SEEDS)); do echo "== seed $$seed"; \
		$(BIN)/python -m pytest -n $(JOBS) --dist worksteal tests -m hypothesis --quiet --hypothesis-seed=$$seed $(PYTEST) || failed="$$failed $$seed"; \
	done; [ -z "$$failed" ] || { echo "failed with the seeds$$failed"; exit 1; }

.PHONY: test-debug  ## Run the contract and parity tests on a build with overflow checks
test-debug: build $(VENV)/.group-test
	$(BIN)/maturin build --locked --profile dev --out $(VENV)/debug-wheel
	$(BIN)/python -m pip install --quiet --no-deps --no-index --upgrade \
		--target $(VENV)/debug $(VENV)/debug-wheel/*.whl
	PYTHONPATH=$(abspath $(VENV)/debug) $(BIN)/python -m pytest $(wildcard tests/contract tests/parity) \
		-W 'ignore:quatfilt was built without optimisation' $(PYTEST)

.PHONY: lint  ## Check format, lints, types, stubs and documentation
lint: build $(VENV)/.group-lint
	cargo fmt --all --check
	cargo clippy --locked --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS='-D warnings' cargo doc --locked --workspace --no-deps
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest quatfilt._core

.PHONY: format  ## Format all sources
format: $(VENV)/.group-lint
	cargo fmt --all
	$(BIN)/ruff check --fix --exit-zero --quiet
	$(BIN)/ruff format

.PHONY: bench  ## Time whole calls against other packages (arguments: BENCH="rotations -o docs/results")
bench: build $(VENV)/.group-bench
	$(BIN)/python benches/python $(BENCH)

.PHONY: bench-rust  ## Time the kernels with criterion
bench-rust: prerequisites
	cargo bench --locked -p quatfilt-benches

.PHONY: bench-test  ## Check that the criterion benchmarks run, without timing them
bench-test: prerequisites
	cargo test --locked -p quatfilt-benches --benches

.PHONY: bench-instructions  ## Count the instructions of the kernels with valgrind (arguments: BENCH="log-f32")
bench-instructions: build
	cargo build --release --locked -p quatfilt-benches --bin instructions
	$(BIN)/python benches/python/instructions.py target/release/instructions $(BENCH)

.PHONY: train-gains  ## Train the optional network of automatic smoothing on QUATFILT_DATA (arguments: TRAIN="--crops 10")
train-gains: build
	$(BIN)/python training/train_gains.py $(TRAIN)

.PHONY: docs  ## Build the API reference: Rust crates in target/doc, Python package in out/docs
docs: build $(VENV)/.group-docs
	RUSTDOCFLAGS='-D warnings' cargo doc --locked --no-deps $(CRATES)
	$(BIN)/pdoc --docformat numpy --output-directory out/docs quatfilt

.PHONY: pictures  ## Draw the pictures of the documentation again
pictures: build
	$(BIN)/python -m quatfilt.evaluation.picture docs/images/denoise.png
	$(BIN)/python docs/images/filters.py
	$(BIN)/python docs/images/pages.py

.PHONY: dist  ## Build the source distribution and a wheel into dist
dist: $(VENV)/.group-build
	rm -rf dist
	$(BIN)/maturin sdist --out dist
	$(BIN)/maturin build --release --locked --out dist

.PHONY: smoke  ## Install the source distribution into a clean environment and run it
smoke: $(VENV)/.group-build
	bash .ci/smoke $(BIN)

.PHONY: ci  ## Run the checks of continuous integration
ci:
	bash .ci/run

.PHONY: clean  ## Remove everything that was built, and the virtual environment
clean:
	rm -rf $(VENV) target dist out .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find python -name '__pycache__' -prune -exec rm -rf {} +
	find python -name '_core*.so' -delete -o -name '_core*.pyd' -delete
