# Two commands matter: `make demo` and `make test`. Everything else is for the people who work here.
SHELL := /bin/bash
.DEFAULT_GOAL := help
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.synced

.PHONY: help demo serve test check bench clean
help: ## list the targets
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/'

$(STAMP): pyproject.toml client/pyproject.toml uv.lock scripts/bootstrap_uv.py
	@uv="$$($(PYTHON) scripts/bootstrap_uv.py)" && "$$uv" sync --frozen --quiet
	@touch $@

demo: $(STAMP) ## the main job on the real human body, over HTTP; leaves out/demo/
	$(BIN)/python scripts/demo.py

serve: $(STAMP) ## run the embedded server
	$(BIN)/integument serve

check: $(STAMP) ## style, types, import contracts, drift of openapi/
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python scripts/openapi.py --check

test: check ## everything a release needs
	$(BIN)/pytest

bench: $(STAMP) ## compare with peers; prints ratios
	$(BIN)/python -m benchmarks

clean: ## forget the environment and everything made
	rm -rf $(VENV) .uv out
