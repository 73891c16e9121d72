# Every command of the project. The first two are the newcomer's; both start from Python 3.11+.
PYTHON ?= python3
VENV ?= .venv
BIN = $(VENV)/bin
STAMP = $(VENV)/.installed
DEV = $(VENV)/.installed-dev
LOCK = $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --no-header --generate-hashes

.PHONY: demo test slow check lint types docs pages snippets figures listings picture screenshots verdicts wheel bench lock clean

demo: $(STAMP)  ## predict a 5-mm germanium disk, with bands; verdict here, figures and data in demo/
	@test -e demo/flyer.toml || { mkdir -p demo && $(BIN)/lightflyer init demo/flyer.toml --kind laden > /dev/null; }
	$(BIN)/lightflyer predict demo/flyer.toml --out demo

# All tests of a file run in one process, where its fixtures are made once.
test: $(DEV)  ## run the tests, except those that take long
	$(BIN)/pytest -n auto --dist loadfile -m "not slow and not snippets"

slow: $(DEV)  ## run the tests that take more than five seconds each; PART=2/8 runs an eighth
	$(BIN)/pytest -n auto --dist loadfile -m "slow and not snippets" $(if $(PART),--part $(PART))

check: lint types test slow docs wheel  ## everything; continuous integration leaves most slow tests out

lint: $(DEV)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(DEV)
	$(BIN)/mypy

docs: $(DEV)  ## build the documentation into docs/_build and run what its pages show
	$(MAKE) --no-print-directory --jobs=2 --output-sync=line pages snippets

pages: $(DEV)
	$(BIN)/sphinx-build -W --keep-going -b html docs docs/_build

snippets: $(DEV)
	$(BIN)/pytest -n auto -m snippets tests/docs

figures: $(DEV)  ## after a change of figures on purpose: take those of the pages of commands anew
	LIGHTFLYER_RENEW_FIGURES=yes $(BIN)/pytest -n auto -m snippets tests/docs/test_snippets.py -k commands

listings: $(DEV)  ## after a change of results on purpose: take what commands print on pages anew
	LIGHTFLYER_RENEW_LISTINGS=yes $(BIN)/pytest -n auto -m snippets tests/docs/test_snippets.py

screenshots: $(DEV)  ## after a change of the calculator's or the explorer's page: take their pictures anew
	$(BIN)/python docs/screenshots.py docs/_build

picture: $(STAMP)  ## after a change of results on purpose: draw the picture of the README anew
	$(BIN)/python docs/readme_picture.py

verdicts: $(DEV)  ## after a change of published flyers: compute our verdicts on them
	$(BIN)/python docs/_extensions/published/verdicts.py

wheel: $(DEV)  ## build the package and use its wheel in an empty environment
	VENV=$(VENV) .ci/check_wheel

bench: $(DEV)  ## measure speed beside others'; prints tables and draws the figure of docs/benchmarks.md
	$(BIN)/python benchmarks/solver.py
	$(BIN)/python -O benchmarks/film.py
	$(BIN)/python benchmarks/story.py
	$(BIN)/python benchmarks/answers.py

# What is installed is exactly what a lock file names: what a prediction needs, then all of the rest.
# Python compiles a module when it is first imported, which installs three times as fast.
$(STAMP): pyproject.toml requirements.lock
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --require-hashes --requirement requirements.lock
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	@touch $@

$(DEV): $(STAMP) requirements-dev.lock
	$(BIN)/python -m pip install --quiet --no-compile --require-hashes --requirement requirements-dev.lock
	$(BIN)/python -W ignore -m compileall -qq -j 0 $(VENV)/lib || true  # or others' odd literals warn in tests
	@touch $@

lock: $(DEV)  ## resolve the newest versions into the lock files
	$(BIN)/python -m pip install --quiet uv
	$(LOCK) --extra all --group dev --upgrade --output-file requirements-dev.lock pyproject.toml
	$(LOCK) --group build --constraint requirements-dev.lock --upgrade \
		--output-file requirements.lock pyproject.toml

clean:
	rm -rf $(VENV) demo docs/_build docs/generated docs/api/generated .pytest_cache .mypy_cache .ruff_cache
