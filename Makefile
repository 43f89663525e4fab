# Python and make are all that is needed: every target sets up what it uses.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := .make/ready

.PHONY: run test fuzz lint format benchmark clean

run: $(READY)
	$(BIN)/ompl-risk plan $(ARGS)

test: $(READY)
	$(BIN)/python -m pytest -n 2 $(ARGS)

# Properties are tried with the same examples each time by `test`, with new ones by `fuzz`.
fuzz: $(READY)
	$(BIN)/python -m pytest -n 2 -m hypothesis --hypothesis-profile=new $(ARGS)

lint: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/pyright
	$(BIN)/lint-imports

format: $(READY)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

benchmark: $(READY)
	$(BIN)/python -m benchmarks $(ARGS)

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; v = sys.version_info; sys.exit(None if (3, 10) <= v < (3, 14) else f"Python 3.10 to 3.13 is needed, this is {v[0]}.{v[1]}: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	mkdir -p $(@D) && touch $@

clean:
	rm -rf $(VENV) .make build dist runs
	find . -name __pycache__ -prune -exec rm -rf {} +
