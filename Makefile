# `make demo` shows what the tool does; `make test` checks that it still does it; `make bench` measures it beside other tools,
# `make notebook` shows what the trained models in checkpoints/ are worth.
# Everything runs in .venv, which is made once and refreshed when the dependencies change.

PYTHON ?= python3
BIN := .venv/bin
INSTALLED := .venv/.installed
PEERS := .venv/.peers

.PHONY: demo test lint bench notebook clean

demo: $(INSTALLED)
	$(BIN)/greybox demo --out results/demo

test: $(INSTALLED)
	$(BIN)/python -m pytest -n 2

lint: $(INSTALLED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright

bench: $(PEERS)
	$(BIN)/python -m experiments.speed --out results/bench

notebook: $(INSTALLED)
	$(BIN)/python -m experiments.notebook --out results/notebook

clean:
	rm -rf .venv results build dist *.egg-info .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(INSTALLED): pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet -c constraints.txt -e '.[dev]'
	touch $@

$(PEERS): $(INSTALLED)
	$(BIN)/python -m pip install --quiet -c constraints.txt -e '.[dev,peers]'
	touch $@
