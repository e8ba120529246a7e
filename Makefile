# mocapd: `make demo` shows it, `make test` tests it. Both make the environment in .venv first.
VENV := .venv
clients test-clients: VENV := .venv-clients
BIN = $(VENV)/bin
READY = $(VENV)/ready
# The first Python that runs and that the locks are for, else one later; say PYTHON=... to choose another.
ifeq ($(origin PYTHON),undefined) # looked for once, not at each mention
PYTHON := $(shell for below in 15 99; do for p in python3 python3.13 python3.12 python3.11 python3.14; do \
	"$$p" -c "import sys; sys.exit(not (3, 11) <= sys.version_info < (3, $$below))" 2>/dev/null \
	&& echo "$$p" && exit; done; done)
endif
# What locks/ is for. Elsewhere pip chooses the versions, within the bounds in pyproject.toml.
LOCKED := import platform, sys; sys.exit(not (sys.version_info < (3, 15) and sys.platform == "linux" \
	and platform.machine() in ("x86_64", "aarch64")))
PIP_INSTALL = $(BIN)/python -m pip install --quiet --disable-pip-version-check
BY_HASH := --require-hashes --only-binary :all:

.DEFAULT_GOAL := help
.NOTPARALLEL: # one environment, made by one
.PHONY: help env dev clients demo test test-clients check bench fuzz attack faults soak load dist deb vm-test engines platforms lock sbom test-lowest clean

help: ## say what can be made
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' $(firstword $(MAKEFILE_LIST)) | expand -t 22

# .venv/ready holds what the environment was made from: this folder, pyproject.toml and the locks.
# When any differs, or the environment's Python is gone, it is made anew. .venv/ready-dev says the same
# of the developers' tools, which are added to it. Whatever is installed by a lock is a wheel with one of
# its hashes, hatchling for the checkout itself included: nothing else is downloaded.
env clients: STAMP = $(READY)
env clients: STAMPS = $(READY)
env: LOCKS := --requirement locks/run.txt --requirement locks/build.txt
env: PROJECT := .[print]
env: ## make or renew the environment in .venv
dev: STAMP = $(READY)-dev
dev: STAMPS = $(READY) $(READY)-dev
dev: LOCKS := --requirement locks/dev.txt
dev: PROJECT := .[all,dev]
clients: LOCKS := --requirement locks/clients.txt
clients: PROJECT := .[all,dev,clients]
# uv, itself from the lock, takes a fifth of pip's time; where it gets nowhere (an index of one's own), pip goes on.
# $(PYTHON)'s pip gets it, if there is one: installing pip takes longer than all the rest. Developers need pip, too.
WITH_PIP = { $(BIN)/python -c 'import pip' 2>/dev/null || $(BIN)/python -m ensurepip >/dev/null || { \
	echo "make: $(PYTHON) has no pip -- apt install python3-venv" >&2; false; }; }
GET_UV = sed -n '/^uv==/,/^[a-z]/{/^uv==\|^ /p}' locks/dev.txt > $(VENV)/uv.txt && { \
	"$(PYTHON)" -m pip --python $(BIN)/python install --quiet --disable-pip-version-check $(BY_HASH) --requirement $(VENV)/uv.txt || \
	{ $(WITH_PIP) && $(PIP_INSTALL) $(BY_HASH) --requirement $(VENV)/uv.txt; }; }
UV_INSTALL = $(BIN)/python -m uv --no-config --no-cache pip install --quiet --python $(BIN)/python
CHECKOUT := --no-deps --no-build-isolation --editable .
dev clients: NEEDS = $(WITH_PIP)
dev: ## the same with the developers' tools
clients: ## make or renew the environment of the clients' tests in .venv-clients
env dev clients:
	@if [ -z "$(PYTHON)" ]; then \
		echo "make: no Python 3.11 or later was found -- install one (apt install python3 python3-venv)," \
			"or name it: make demo PYTHON=/path/to/python3" >&2; exit 1; fi
	@want="$$(pwd) $$(cat pyproject.toml locks/*.txt | cksum)"; \
	if [ "$$(cat $(STAMP) 2>/dev/null)" = "$$want" ] && $(BIN)/python -c '' 2>/dev/null; then exit 0; fi; \
	echo "make: preparing $(VENV) with $(PYTHON) (once, about a quarter of a minute)" >&2; \
	rm -f $(READY) $(READY)-dev; \
	case "$$(cat $(VENV)/made-in 2>/dev/null)" in "$$(pwd)") ;; *) rm -rf $(VENV);; esac; \
	$(BIN)/python -c '' 2>/dev/null || { rm -rf $(VENV); "$(PYTHON)" -m venv --without-pip $(VENV); } || { \
		echo "make: $(PYTHON) cannot make an environment -- apt install python3-venv" >&2; exit 1; }; \
	pwd > $(VENV)/made-in && \
	if $(BIN)/python -c '$(LOCKED)'; then \
		{ $(GET_UV) && $(UV_INSTALL) $(BY_HASH) $(LOCKS) && $(UV_INSTALL) --reinstall $(CHECKOUT); } 2>/dev/null || \
		{ $(WITH_PIP) && $(PIP_INSTALL) $(BY_HASH) $(LOCKS) && $(PIP_INSTALL) $(CHECKOUT); }; \
	else \
		echo "make: $$($(BIN)/python -V) on $$(uname -sm) is none that locks/ is for (3.11 to 3.14 on Linux," \
			"x86_64 or aarch64): pip chooses the versions" >&2; \
		$(WITH_PIP) && $(PIP_INSTALL) --editable '$(PROJECT)'; \
	fi && $(or $(NEEDS),true) && \
	for stamp in $(STAMPS); do echo "$$want" > $$stamp || exit 1; done

demo: env ## two simulated webcams in, skeleton frames out on 127.0.0.1, one live line
	@$(BIN)/mocapd demo

# What is compiled is kept for the next process, whatever the caller's own wish: there are a hundred and more.
test: export PYTHONDONTWRITEBYTECODE :=
# Four processes on two cores, as many tests wait for something else. What each of them needs is made before;
# should that fail, a test says why.
test: dev ## run all tests but those of clients/
	-$(BIN)/python -m tests.made_once
	$(BIN)/python -m pytest --numprocesses 4 --dist loadfile --no-loadscope-reorder --ignore tests/clients

test-clients: export PYTHONDONTWRITEBYTECODE :=
test-clients: clients ## run the tests of clients/
	$(BIN)/python -m pytest --numprocesses 4 --dist loadfile tests/clients

check: dev ## lint, format, types, import contract, dead code, structure
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/vulture
	$(BIN)/python -m tests.code_structure

bench: env ## time every tracker, stage by stage
	@$(BIN)/mocapd bench

fuzz: dev ## feed every parser changed input and count what comes out; INPUTS=1000000 for so many in all
	$(BIN)/python -m tests.fuzz $(if $(INPUTS),--inputs $(INPUTS))

attack: dev ## attack a daemon of its own as another process of this machine could
	$(BIN)/python -m tests.attacks

faults: dev ## pull cameras, kill and starve daemons of its own at random for half an hour, and print the table
	$(BIN)/python -m tests.faults unplugging ailing killing ending

soak: dev ## send a daemon the frames of an hour in a quarter of one, and print what has grown
	$(BIN)/python -m tests.faults soaking

load: dev ## many camera nodes, streams and subscribers on this machine: print what was measured
	@$(BIN)/python -m tests.load

# hatchling is of locks/build.txt; where pip chose the versions it is not there yet.
dist: env ## build wheel and source distribution, and what is handed on of the clients, into dist/
	@$(BIN)/python -c 'import hatchling' 2>/dev/null || $(PIP_INSTALL) hatchling
	rm -rf dist
	$(BIN)/python -m hatchling build
	cd clients/python && $(abspath $(BIN))/python -m hatchling build -t wheel -d $(abspath dist)
	cd clients/goalkeeper && $(abspath $(BIN))/python -m hatchling build -t wheel -d $(abspath dist)
	$(BIN)/python clients/pack.py dist

deb: dist ## make a Debian package of it, with all that it runs on, for this machine's python3
	@$(WITH_PIP)
	deb/build.sh $(BIN)/python dist/mocapd-*.whl dist

vm-test: deb ## as root: install the package on a real kernel with two USB webcams, pull, freeze, kill, remove (needs ../shared/vm)
	tests/vm/vm_test.sh $(BIN)/python dist/mocapd_*.deb

engines: dev ## as root: the Godot add-on, another's VMC receiver (VMC_ADDON=folder) and Blender on our output, in a Debian sid of their own
	$(BIN)/python -m tests.engines $(if $(VMC_ADDON),--vmc-addon $(VMC_ADDON))

platforms: dev ## as root: wheels for every Python and machine; mocapd on Python 3.13, 3.14 and emulated ARM (ONLY="3.13 3.14 aarch64")
	$(BIN)/python -m tests.engines.platforms $(if $(ONLY),--only $(ONLY))

lock: dev ## make locks/ and the notices from pyproject.toml; UPGRADE=1 takes newer versions
	$(BIN)/python -m tests.supply.make_locks $(if $(UPGRADE),--upgrade)
	$(BIN)/python -m tests.supply.wheels
	@$(MAKE) --no-print-directory dev
	$(BIN)/python -m tests.supply.third_party_notices

sbom: dev ## write the bill of materials of what mocapd runs on to dist/ (CycloneDX)
	@$(BIN)/python -m tests.supply.sbom

test-lowest: dev ## run some tests with the oldest libraries that pyproject.toml allows, in an environment that is thrown away
	$(BIN)/python -m tests.supply.lowest

clean: ## remove the environment and every cache of the tools
	rm -rf $(VENV) .venv-clients .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
