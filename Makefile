# Everything a developer or a new user types. Needs Python >= 3.11 with pip and venv, and make; with a C compiler the
# kernels become machine code, without one they run as plain Python.
#
#   make demo    decide the robustness of a real network exactly, with a certificate, and check it independently
#   make test    the fast tests and every example in a docstring
#   make help    all targets

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
SHELL := /bin/sh

# The first Python that is new enough; `make PYTHON=/path/to/python demo` overrides it.
PYTHON ?= $(firstword $(foreach p,python3 python3.14 python3.13 python3.12 python3.11 python,$(shell \
	$(p) -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && echo $(p))))

VENV := .venv
BIN := $(VENV)/bin
# Where the system splits ensurepip off its Python, the second line brings pip in through the system's own.
# The stamp is written last and only on success, so an interrupted installation is taken up again by the next make.
READY := $(VENV)/installed-from-lock
LOCK := requirements.lock
BUILD := build
JOBS ?= 2

# A real backbone (SNDlib di-yuan, 11 nodes) with r* = 5.
DEMO_GRAPH := topohub:sndlib/di-yuan
DEMO_R := 5
DEMO_CERTIFICATE := $(BUILD)/demo/di-yuan-$(DEMO_R)-robust.cert
DEMO_CANONICAL := $(BUILD)/demo/di-yuan.graph

.PHONY: help demo venv test test-slow fuzz lint types docs figures coverage-kernel formal bench bench-quick wheel lock clean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## */\1\t/' | expand -t 18

# --no-deps: the lock is whole, and a resolver that looked further would trip over any release newer than the lock.
# `pip check` then proves that nothing was missing from it.
$(READY): $(LOCK) pyproject.toml setup.py $(wildcard robustness/kernels/*.py robustness/kernels/*.pxd)
	@test -n "$(PYTHON)" || { echo "Python 3.11 or newer is needed and none was found: make PYTHON=/path/to/python" >&2; exit 3; }
	@rm -f $@
	$(BIN)/python -m pip --version >/dev/null 2>&1 || $(PYTHON) -m venv --clear $(VENV) || \
		{ $(PYTHON) -m venv --clear --without-pip $(VENV) && $(PYTHON) -m pip --python $(BIN)/python install --quiet pip; }
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes --no-deps -r $(LOCK)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --config-settings editable_mode=compat -e .
	$(BIN)/python -m pip check --disable-pip-version-check >/dev/null
	@touch $@

venv: $(READY) ## the virtual environment, exactly as locked

# The last line is the independent verification: the kernel alone. -I: no file of the current folder and no variable of
# the environment stands in for a part of Python.
demo: $(READY) ## certify a real topology and verify the certificate with the kernel alone
	@mkdir -p $(dir $(DEMO_CERTIFICATE))
	$(BIN)/robustness check $(DEMO_GRAPH)
	$(BIN)/robustness certify $(DEMO_GRAPH) -r $(DEMO_R) -o $(DEMO_CERTIFICATE) --canonical $(DEMO_CANONICAL)
	$(BIN)/robustness verify $(DEMO_GRAPH) $(DEMO_CERTIFICATE) --expect robust -r $(DEMO_R)
	$(BIN)/python -I -m certificates verify $(DEMO_CANONICAL) $(DEMO_CERTIFICATE)

test: $(READY) ## the fast tests and the examples in the docstrings
	$(BIN)/python -m pytest -q -n $(JOBS) -m "not slow"

test-slow: $(READY) ## the exhaustive sweeps
	$(BIN)/python -m pytest -q -n $(JOBS) -m slow

coverage-kernel: $(READY) ## every branch of the trusted kernel is taken by its own tests
	$(BIN)/python -m pytest -q tests/certificates --cov=certificates --cov-fail-under=100 --cov-report=term-missing

# The Coq proofs in their order, the statement of what they rest on, and the checker that Coq makes of them.
FORMAL := $(BUILD)/formal
PROOFS := Counting Bytes Robustness Apart Sets Rules Soundness Refutation RefutationSound Tables Evidence Checks Growth \
	Roles RolesSound RolesCount Separation SeparationSound Tolerance Canonical Reading Lemmas Certificate Unique Traps \
	Examples Proposition1 Literal Assumptions Extract

$(FORMAL)/robustness-verified: $(wildcard certificates/formal/*)
	@command -v coqc >/dev/null && command -v ocamlopt >/dev/null || \
		{ echo "Coq 8.16 and OCaml 4.13 are needed: apt-get install coq ocaml-nox" >&2; exit 3; }
	rm -rf $(FORMAL) && mkdir -p $(FORMAL) && cp certificates/formal/*.v certificates/formal/main.ml $(FORMAL)
	cd $(FORMAL) && for proof in $(PROOFS); do coqc -q -Q . Formal $$proof.v >$$proof.out || exit 1; done
	@cat $(FORMAL)/Assumptions.out
	@! grep -v "^Closed under the global context$$" $(FORMAL)/Assumptions.out >&2
	cd $(FORMAL) && ocamlopt -inline 200 -w -a checker.mli checker.ml main.ml -o building && mv building robustness-verified

formal: $(FORMAL)/robustness-verified ## the checker that is proved correct (needs Coq and OCaml)
	@echo "the verified checker: $(FORMAL)/robustness-verified"

lint: $(READY) ## ruff: rules, docstrings and format; spelling
	$(BIN)/ruff check .
	$(BIN)/ruff format --check --quiet .
	$(BIN)/python -m pytest -q -n 0 tests/test_spelling.py

types: $(READY) ## mypy --strict
	$(BIN)/mypy

docs: $(READY) ## the documentation, warnings as errors, into build/docs
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs $(BUILD)/docs
	$(BIN)/python -m benchmarks.atlas page $(BUILD)/docs/atlas.html
	@echo "documentation: $(BUILD)/docs/index.html"

atlas: $(READY) ## survey all topohub networks and small graphs anew into docs/atlas.jsonl (half an hour), and its page
	$(BIN)/python -m benchmarks.atlas measure
	@mkdir -p $(BUILD)/docs
	$(BIN)/python -m benchmarks.atlas page $(BUILD)/docs/atlas.html

# The commands that the pages name beside their pictures; the last takes a few minutes and writes its page as well.
TUTORIAL := $(BUILD)/tutorial
figures: $(READY) ## draw the pictures of the documents anew
	$(BIN)/robustness draw topohub:sndlib/polska -r 2 -o docs/figures/first.svg
	$(BIN)/python examples/how_many_liars.py docs/figures/how-many-liars.svg
	$(BIN)/python examples/mending_stories.py docs/figures
	$(BIN)/python examples/platoon_links.py --save $(BUILD)/joint
	$(BIN)/robustness joint $(BUILD)/joint/fast.json -r 3 --tau 11 --plot docs/figures/joint.svg
	@mkdir -p $(TUTORIAL)
	$(BIN)/robustness build platoon --n 10 --k 3 -o $(TUTORIAL)/platoon.graphml
	$(BIN)/robustness tolerance $(TUTORIAL)/platoon.graphml --model delayed -o $(TUTORIAL)/evidence
	$(BIN)/robustness simulate $(TUTORIAL)/platoon.graphml --attack $(TUTORIAL)/evidence/delayed-attack.json --steps 60 \
		--plot docs/figures/tutorial-platoon.png
	$(BIN)/robustness simulate --experiment setting-1 --plot docs/figures/paper
	$(BIN)/robustness simulate --experiment setting-2 --plot docs/figures/paper
	$(BIN)/python -m benchmarks.frontier --record docs/frontier.jsonl --show --picture docs/figures/frontier.svg
	$(BIN)/python -m robustness.paper.audit docs

SECONDS := 60
fuzz: $(READY) ## mutated files, certificates and options for SECONDS=60: only promised exit codes; build/fuzz keeps finds
	$(BIN)/python -m tests.fuzzing --seconds $(SECONDS) --keep $(BUILD)/fuzz

bench: $(READY) ## the full benchmark
	$(BIN)/python -m benchmarks

bench-quick: $(READY) ## the benchmark in a minute or two
	$(BIN)/python -m benchmarks --quick

wheel: $(READY) ## the wheel, into build/dist
	$(BIN)/python -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir $(BUILD)/dist .

lock: ## resolve requirements.lock anew (the only target that does not use it)
	$(PYTHON) -m venv $(BUILD)/lock
	$(BUILD)/lock/bin/python -m pip install --quiet --disable-pip-version-check pip-tools
	cp pyproject.toml setup.py README.md LICENSE $(BUILD)/lock/
	mkdir -p $(BUILD)/lock/robustness && cp -r robustness/kernels $(BUILD)/lock/robustness/
	cd $(BUILD)/lock && bin/pip-compile --quiet --upgrade --all-extras --generate-hashes --allow-unsafe --strip-extras --no-header \
		--no-annotate --no-emit-options --no-emit-index-url --no-emit-trusted-host --no-emit-find-links -o resolved.txt pyproject.toml
	{ echo "# Every package of every extra, pinned with hashes for all platforms. Written by 'make lock'; do not edit."; \
		grep -v "^#" $(BUILD)/lock/resolved.txt; } > $(LOCK)

clean: ## what the other targets made, but not the virtual environment
	rm -rf $(BUILD) dist robustness/kernels/*.so .pytest_cache .mypy_cache .ruff_cache .hypothesis .coverage .coverage.* *.egg-info
	find robustness certificates cli tests benchmarks examples docs -name __pycache__ -type d -prune -exec rm -rf {} +
