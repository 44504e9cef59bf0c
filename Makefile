# flatrig: `make demo` runs the comparison, `make test` checks everything, `make help` lists the rest.

PYTHON ?= $(shell command -v python3.11 || echo python3)
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
INSTALL := $(PIP) install --quiet --constraint constraints.txt

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help install demo test lint types bench regress stress mutants docs figures scenes train policies reproduce clean

help:  ## list the targets
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 18

# Installs are repeated only when the package's metadata or the pins change.
$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.version_info >= (3, 11) or sys.exit("flatrig needs Python 3.11 or later, found " + sys.version.split()[0] + "; try make PYTHON=/path/to/python3.11")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.core: pyproject.toml constraints.txt | $(BIN)/python
	$(INSTALL) setuptools
	$(INSTALL) --no-build-isolation --editable .
	@touch $@

$(VENV)/.dev: pyproject.toml constraints.txt | $(BIN)/python
	$(INSTALL) setuptools
	$(INSTALL) --no-build-isolation --editable '.[dev,train,video,hands,onnx,ray,slurm,tools]'
	@mkdir -p $(VENV)/src && ln -sfn ../.. $(VENV)/src/flatrig
	@touch $@ $(VENV)/.core

$(VENV)/.docs: pyproject.toml constraints.txt | $(BIN)/python
	$(INSTALL) setuptools
	$(INSTALL) --no-build-isolation --editable '.[docs]'
	@touch $@ $(VENV)/.core

install: $(VENV)/.core  ## set up .venv with what the package needs, without torch

demo: $(VENV)/.core  ## compare the controllers on the overhead crane: a table, and a figure in results/
	$(BIN)/flatrig compare overhead

test: lint types  ## ruff, mypy and the whole test suite
	$(BIN)/python -m pytest --numprocesses auto

lint: $(VENV)/.dev  ## ruff alone
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

# mypy cannot follow an editable install; .venv/src/flatrig is a link to this folder (pyproject.toml).
types: $(VENV)/.dev  ## mypy alone
	$(BIN)/mypy

bench: $(VENV)/.core  ## measure speed, accuracy in MuJoCo, and error against run time on this machine
	$(BIN)/flatrig bench
	$(BIN)/flatrig bench feedforward
	$(BIN)/flatrig accuracy

regress: $(VENV)/.core  ## compare every model and integrator with the stored numbers
	$(BIN)/flatrig regress --processes 2

stress: $(VENV)/.core  ## stiff and extreme cases, ten thousand random rigs
	$(BIN)/flatrig stress

mutants: $(VENV)/.dev  ## plant faults one at a time, and see whether tests, regress and stress notice
	$(BIN)/python tests/mutants/run.py

docs: $(VENV)/.docs  ## build the documentation's site, into build/docs/html
	$(BIN)/python docs/site/build.py

figures: $(VENV)/.dev  ## draw the sources' figures anew, into docs/
	$(BIN)/flatrig reproduce all --page docs/reference/reproduced.md

scenes: $(VENV)/.core  ## write the default scenes to models/*.xml
	$(BIN)/flatrig scenes

train: $(VENV)/.dev  ## train a residual for the overhead crane, ten minutes, into runs/
	$(BIN)/flatrig train overhead --sensors sway

policies: $(VENV)/.dev  ## train what is shipped anew, for every crane, hours, into runs/
	for sensors in encoders sway; do for crane in overhead roped-overhead rotary extended-rotary \
	cantilever gantry navy-2d navy-3d cable-manipulator; do \
	$(BIN)/flatrig train $$crane --sensors $$sensors || exit 1; done; done

reproduce: scenes figures train  ## make scenes, figures and a policy anew, and compare with this policy
	$(BIN)/flatrig compare overhead --policy runs/overhead_crane-sway-seed0/policy.json

clean:  ## remove .venv, caches and build files; results/ and runs/ stay
	rm -rf $(VENV) build dist *.egg-info .mypy_cache .pytest_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
