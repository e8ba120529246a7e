# mocapd: `make demo` shows it, `make test` tests it. Both make the environment in .venv first.
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/ready
# The first Python that runs and is 3.11 or later; say PYTHON=... to choose another.
PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11 python3.14; do \
	"$$p" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo "$$p" && break; done)

.DEFAULT_GOAL := help
.PHONY: help env demo test check bench clean

help: ## say what can be made
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1\t\2/p' $(firstword $(MAKEFILE_LIST)) | expand -t 16

# .venv/ready holds what the environment was made from: this folder and pyproject.toml. When either
# differs, or the environment's Python is gone, it is made anew.
env: ## make or renew the environment in .venv
	@if [ -z "$(PYTHON)" ]; then \
		echo "make: no Python 3.11 or later was found -- install one (apt install python3 python3-venv)," \
			"or name it: make demo PYTHON=/path/to/python3" >&2; exit 1; fi
	@want="$$(pwd) $$(cksum < pyproject.toml)"; \
	if [ "$$(cat $(READY) 2>/dev/null)" = "$$want" ] && $(BIN)/python -c '' 2>/dev/null; then exit 0; fi; \
	echo "make: preparing $(VENV) with $(PYTHON) (once, a minute or two)" >&2; \
	rm -f $(READY); \
	case "$$(cat $(VENV)/made-in 2>/dev/null)" in "$$(pwd)") ;; *) rm -rf $(VENV);; esac; \
	$(BIN)/python -c '' 2>/dev/null || { rm -rf $(VENV); "$(PYTHON)" -m venv $(VENV); } || { \
		echo "make: $(PYTHON) cannot make an environment -- apt install python3-venv" >&2; exit 1; }; \
	pwd > $(VENV)/made-in && \
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]' && \
	echo "$$want" > $(READY)

demo: env ## two simulated webcams in, skeleton frames out on 127.0.0.1, one live line
	@$(BIN)/mocapd demo

test: env ## run all tests
	$(BIN)/python -m pytest

check: env ## lint, format, types, import contract
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: env ## time every tracker, stage by stage
	@$(BIN)/mocapd bench

clean: ## remove the environment and every cache of the tools
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
