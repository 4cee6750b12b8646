# Two commands matter: `make demo` and `make test`. Everything else is for the people who work here.
SHELL := /bin/bash
.DEFAULT_GOAL := help
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.synced
PAGE := api/static/index.html
VIEWER := core/reports/viewer/viewer.js
PAGE_SOURCES := $(shell find web -name node_modules -prune -o -type f -print)

.PHONY: help demo serve test check docs bench clean web kernels debian faults fuzz audit soak load
help: ## list the targets
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/'

$(STAMP): pyproject.toml client/pyproject.toml uv.lock scripts/bootstrap_uv.py
	@uv="$$($(PYTHON) scripts/bootstrap_uv.py)" && "$$uv" sync --frozen --quiet
	@touch $@

$(PAGE) $(VIEWER) &: $(STAMP) $(PAGE_SOURCES) scripts/web.py
	$(BIN)/python scripts/web.py build

web: $(PAGE) $(VIEWER) ## build the web page into api/static, and the viewer that reports carry

demo: $(STAMP) $(PAGE) $(VIEWER) ## the main job on the real human body, over HTTP; leaves out/demo/
	$(BIN)/python scripts/demo.py

serve: $(STAMP) $(PAGE) $(VIEWER) ## run the embedded server
	$(BIN)/integument serve

check: $(STAMP) ## style, types, import contracts, drift of openapi/
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python scripts/openapi.py --check
	$(BIN)/python scripts/web.py check

docs: $(STAMP) ## build the documentation site, which the server shows at /handbook/; a link that leads nowhere is an error
	$(BIN)/python scripts/docs.py

kernels: $(STAMP) ## compile the kernels ahead of their first use, about a minute
	$(BIN)/python -m core.processes.warm_up

debian: $(STAMP) # a browser and libraries that the tests need
	@$(BIN)/python scripts/debian_packages.py

test: $(PAGE) $(VIEWER) debian ## everything a release needs
	$(MAKE) --no-print-directory --jobs 2 check kernels
	$(BIN)/python scripts/web.py test
	$(BIN)/pytest --numprocesses 2 --max-worker-restart 0 --dist loadfile

bench: $(STAMP) $(VIEWER) ## compare with peers; prints ratios
	$(BIN)/python -m benchmarks

load: $(STAMP) $(VIEWER) ## load a server of its own on loopback; prints what it holds of its promises, about 15 minutes
	$(BIN)/python -m benchmarks.load

SEED ?= 1
JOBS ?= 200
faults: $(STAMP) $(VIEWER) ## kill, pause, cut, fill and confuse a whole lab by SEED while it does JOBS; leaves out/faults/, about 10 minutes
	$(BIN)/python -m tests.acceptance.faults --seed $(SEED) --jobs $(JOBS)

soak: $(STAMP) $(VIEWER) ## a busy day of a lab by a set clock, on both databases; prints what is left after each hour, about 10 minutes
	$(BIN)/pytest -m slow -s tests/soak

FUZZ_SECONDS ?= 60
fuzz: $(STAMP) ## every reader and the whole API against a coverage-guided fuzzer, FUZZ_SECONDS each; leaves out/fuzz/
	@uv="$$($(PYTHON) scripts/bootstrap_uv.py)" && "$$uv" sync --frozen --quiet --group fuzz
	$(BIN)/python -m tests.fuzz --seconds $(FUZZ_SECONDS)

audit: $(STAMP) ## ask the advisory services about every locked package; needs the internet, so it is no part of `make test`
	@uv="$$($(PYTHON) scripts/bootstrap_uv.py)" && "$$uv" audit --frozen

clean: ## forget the environment and everything made
	rm -rf $(VENV) .uv out web/node_modules api/static api/handbook core/reports/viewer
