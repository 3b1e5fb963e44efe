# `make demo` shows what the tool does; `make test` checks that it still does it; `make bench` measures it beside other tools;
# `make notebook` shows what the trained models in checkpoints/ are worth; `make proof` conceals effects, seals the answers, lets it speak,
# and scores it; `make docs` builds the documentation as a site.
# Everything runs in .venv, which is made once and refreshed when the dependencies change.

PYTHON ?= python3
BIN := .venv/bin
INSTALLED := .venv/.installed
PEERS := .venv/.peers
PROOF := .venv/.proof
DOCS := .venv/.docs

.PHONY: demo test lint bench notebook proof proof-quick docs dist clean

demo: $(INSTALLED)
	$(BIN)/greybox demo --out results/demo

# Two processes with a thread each: threads of BLAS that wait for a core which the other process has take 40 times as long.
test: $(INSTALLED)
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist worksteal

lint: $(INSTALLED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright

bench: $(PEERS)
	$(BIN)/python -m experiments.speed --out results/bench

notebook: $(INSTALLED)
	$(BIN)/python -m experiments.notebook --out results/notebook

# The site, in results/site; a link that leads nowhere or a name that does not exist ends it.
docs: $(DOCS)
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict

# The source distribution and the wheel, in dist/.
dist: $(INSTALLED)
	$(BIN)/python -m build --outdir dist

# Interrupted, it goes on where it was; a new draw needs another folder, or results/proof removed.
proof: $(PROOF)
	$(BIN)/python -m experiments.concealed.proof --page docs/validation/proof.md

proof-quick: $(PROOF)
	$(BIN)/python -m experiments.concealed.proof --set quick

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

$(PROOF): $(INSTALLED)
	$(BIN)/python -m pip install --quiet -c constraints.txt -e '.[dev,proof]'
	touch $@

$(DOCS): $(INSTALLED)
	$(BIN)/python -m pip install --quiet -c constraints.txt -e '.[dev,docs]'
	touch $@
