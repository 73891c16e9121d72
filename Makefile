# Every command of the project. The first two are the newcomer's; both start from Python 3.11+.
PYTHON ?= python3
VENV ?= .venv
BIN = $(VENV)/bin
STAMP = $(VENV)/.installed

.PHONY: demo test slow check lint types docs pages snippets figures listings screenshots verdicts wheel bench lock clean

demo: $(STAMP)  ## predict a 5-mm germanium disk, with bands; verdict here, figures and data in demo/
	@test -e demo/flyer.toml || { mkdir -p demo && $(BIN)/lightflyer init demo/flyer.toml --kind laden > /dev/null; }
	$(BIN)/lightflyer predict demo/flyer.toml --out demo

# All tests of a file run in one process, where its fixtures are made once.
test: $(STAMP)  ## run the tests, except those that take long
	$(BIN)/pytest -n auto --dist loadfile -m "not slow and not snippets"

slow: $(STAMP)  ## run the tests that take more than five seconds each; PART=2/8 runs an eighth
	$(BIN)/pytest -n auto --dist loadfile -m "slow and not snippets" $(if $(PART),--part $(PART))

check: lint types test slow docs wheel  ## everything; continuous integration leaves most slow tests out

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(STAMP)
	$(BIN)/mypy

docs: $(STAMP)  ## build the documentation into docs/_build and run what its pages show
	$(MAKE) --no-print-directory --jobs=2 --output-sync=line pages snippets

pages: $(STAMP)
	$(BIN)/sphinx-build -W --keep-going -b html docs docs/_build

snippets: $(STAMP)
	$(BIN)/pytest -n auto -m snippets tests/docs

figures: $(STAMP)  ## after a change of figures on purpose: take those of the pages of commands anew
	LIGHTFLYER_RENEW_FIGURES=yes $(BIN)/pytest -n auto -m snippets tests/docs/test_snippets.py -k commands

listings: $(STAMP)  ## after a change of results on purpose: take what commands print on pages anew
	LIGHTFLYER_RENEW_LISTINGS=yes $(BIN)/pytest -n auto -m snippets tests/docs/test_snippets.py

screenshots: $(STAMP)  ## after a change of the calculator's or the explorer's page: take their pictures anew
	$(BIN)/python docs/screenshots.py docs/_build

verdicts: $(STAMP)  ## after a change of published flyers: compute our verdicts on them
	$(BIN)/python docs/_extensions/published/verdicts.py

wheel: $(STAMP)  ## build the package and use its wheel in an empty environment
	VENV=$(VENV) .ci/check_wheel

bench: $(STAMP)  ## measure speed beside others'; prints tables and draws the figure of docs/benchmarks.md
	$(BIN)/python benchmarks/solver.py
	$(BIN)/python -O benchmarks/film.py
	$(BIN)/python benchmarks/story.py
	$(BIN)/python benchmarks/answers.py

# What is installed is exactly what the lock file names.
$(STAMP): pyproject.toml requirements.lock
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --require-hashes --requirement requirements.lock
	$(BIN)/python -m pip install --quiet --no-deps --editable .
	@touch $@

lock: $(STAMP)  ## resolve the newest versions into requirements.lock
	$(BIN)/python -m pip install --quiet uv
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --no-header \
		--generate-hashes --all-extras --group test --group lint --group docs \
		--upgrade --output-file requirements.lock pyproject.toml

clean:
	rm -rf $(VENV) demo docs/_build docs/generated docs/api/generated .pytest_cache .mypy_cache .ruff_cache
