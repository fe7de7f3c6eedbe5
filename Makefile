# make results [CONFIG=mine.yaml] [CORES=2]   every dataset and figure of a run
# make archive [CONFIG=mine.yaml]             the run as one file, for a data repository
# make reproduce FILE=thesis.zip INTO=folder  an archive, a run or a dataset made anew there, and compared
# make test                                   the test suite, but for trials that take long
# make test-all                               the whole of it
# make test-processors                        tests of numbers, as other processors compute them
# make test-pythons                           the wheel on other Pythons that are here
# make lint                                   formatting, style, types and what may import what
# make docs                                   the parts of docs/ that are made
# make site                                   the docs as a site, in docs/_site/
# make bench                                  speed, as ratios within one run
# make bench-sweeps                           what a grid of 1000 combinations takes, minutes
# make bench-growth                           how cost grows with points, rays, combinations, minutes
# make bench-peers                            beside other codes and methods, optional, minutes
# make slurm                                  installs what runs on a cluster need besides
# make test-slurm                             the same results on a private Slurm, also if a node dies
# make bench-slurm                            what Slurm adds to each job
# make bench-scheduler                        what 10 000 jobs ask of a scheduler, a quarter of an hour
# make kills                                  30 kills at random moments, 30 same results
# make soak [MINUTES=20]                      random configs under kills, signals, full disks, optional
# make mutants [NUMBER=300]                   wrong changes to the package that no test notices, long
# make lock                                   resolve the dependencies anew
PYTHON ?= python3
CORES ?= 2
CONFIG ?= config/default.yaml
BIN = .venv/bin
PEERS_PIP = .venv-peers/$(1)/bin/python -m pip --disable-pip-version-check --quiet
PIP = $(BIN)/python -m pip --disable-pip-version-check --quiet

# what a user's environment tells other programs of Python's (octsim/base/surroundings.py)
unexport $(filter-out PYTHONS PYTHONDONTWRITEBYTECODE PYTHONPYCACHEPREFIX PYTHONUNBUFFERED,$(filter PYTHON%,$(.VARIABLES)))

# names of files as they are given, whatever make and the shell would read into them
export GIVEN_CONFIG := $(value CONFIG)
export GIVEN_FILE := $(value FILE)
export GIVEN_INTO := $(value INTO)

# a module's tests stay together, so that what they share is made once
# tests of runs wait for much of their time, so that four at once fill two cores; threads of
# OpenBLAS that wait for a core would keep it busy
TESTS = OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n 4 --dist loadscope --no-loadscope-reorder

.PHONY: results archive reproduce test test-all test-processors test-pythons lint format docs site bench \
	bench-sweeps bench-growth bench-peers kills soak mutants lock slurm test-slurm bench-slurm \
	bench-scheduler clean
results: .venv/run
	@exec $(BIN)/octsim run "$$GIVEN_CONFIG" --cores "$(CORES)"

archive: .venv/run
	@exec $(BIN)/octsim run "$$GIVEN_CONFIG" archive --cores "$(CORES)"

reproduce: .venv/run
	@test -n "$$GIVEN_FILE" -a -n "$$GIVEN_INTO" || { echo "octsim: make reproduce needs FILE= and INTO=" >&2; exit 2; }
	@$(BIN)/octsim reproduce "$$GIVEN_FILE" "$$GIVEN_INTO" --cores $(CORES) $(TOLERANCE:%=--tolerance %)

test: .venv/dev
	$(TESTS) -m "not trial"

test-all: .venv/dev
	$(TESTS) --durations=40

test-processors: .venv/dev
	.ci/processors

test-pythons: .venv/dev
	.ci/pythons

lint: .venv/dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/snakefmt --check Snakefile
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo

format: .venv/dev
	$(BIN)/ruff check --fix
	$(BIN)/ruff format
	$(BIN)/snakefmt Snakefile

docs: results .venv/dev
	$(BIN)/snakemake stability tradeoff validity diffraction interferometers causes estimators calibration action_potential detector effects scenes responses design --cores $(CORES)
	$(BIN)/python docs/generate.py

site: .venv/dev
	rm -rf docs/_site docs/api docs/jupyter_execute
	$(BIN)/sphinx-build -q -W --keep-going docs docs/_site

.venv/bin/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "octsim needs Python 3.11 or later, this is " + sys.version)'
	$(PYTHON) -m venv .venv

# The package itself is installed in place: an edit of octsim/ needs no further command.
.venv/run: .venv/bin/python requirements.lock pyproject.toml
	$(PIP) install --require-hashes -r requirements.lock
	$(PIP) install --no-deps --no-build-isolation -e .
	touch $@

.venv/dev: .venv/run requirements-dev.lock
	$(PIP) install --require-hashes -r requirements-dev.lock
	touch $@

slurm: .venv/slurm
.venv/slurm: .venv/run requirements-slurm.lock
	$(PIP) install --require-hashes -r requirements-slurm.lock
	touch $@

test-slurm: .venv/dev .venv/slurm
	OCTSIM_SLURM=1 $(BIN)/pytest -n 4 --dist worksteal tests/workflow/test_slurm.py tests/workflow/test_scheduler.py

bench-slurm: .venv/dev .venv/slurm
	$(BIN)/python benchmarks/slurm.py

bench-scheduler: .venv/run .venv/slurm
	PYTHONPATH=benchmarks $(BIN)/python -P benchmarks/scheduler_load.py --write

COMPILE = $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
	--no-emit-index-url --no-emit-find-links --no-header --no-annotate
RUN = --extra run --extra archive --extra lab
lock: .venv/bin/python
	$(PIP) install --require-hashes -r requirements-uv.lock
	$(COMPILE) pyproject.toml $(RUN) --group build -o requirements.lock
	$(COMPILE) pyproject.toml $(RUN) --extra stability --group dev -c requirements.lock -o requirements-dev.lock
	$(COMPILE) pyproject.toml $(RUN) --extra slurm --group build -c requirements.lock -o requirements-slurm.lock
	$(COMPILE) --group lock -o requirements-uv.lock
	for name in rays waves cycles; do $(COMPILE) benchmarks/peers/$$name.in -o benchmarks/peers/$$name.lock || exit; done

bench: .venv/run
	$(BIN)/python benchmarks/bench.py

bench-sweeps: .venv/run
	$(BIN)/python benchmarks/large.py

bench-growth: .venv/run
	PYTHONPATH=benchmarks $(BIN)/python -P benchmarks/growth.py --write

bench-peers: .venv-peers/rays/run .venv-peers/waves/run .venv-peers/cycles/run
	OPENBLAS_NUM_THREADS=1 PYTHONPATH=benchmarks .venv-peers/rays/bin/python -m peers

# Peers hold numpy and scipy at versions of their own. One that can't be installed is named by the page.
.venv-peers/rays/run: requirements.lock benchmarks/peers/rays.lock pyproject.toml
	$(PYTHON) -m venv .venv-peers/rays
	$(call PEERS_PIP,rays) install --require-hashes -r requirements.lock -r benchmarks/peers/rays.lock
	$(call PEERS_PIP,rays) install --no-deps --no-build-isolation -e .
	touch $@

.venv-peers/%/run: benchmarks/peers/%.lock
	$(PYTHON) -m venv .venv-peers/$*
	-$(call PEERS_PIP,$*) install --require-hashes -r $< && touch $@

kills: .venv/dev
	OCTSIM_KILLS=30 $(BIN)/pytest -n 2 tests/workflow/test_kill.py tests/instrument/test_point_store.py -k killed

MINUTES ?= 20
soak: .venv/dev
	PYTHONPATH=benchmarks:tests $(BIN)/python -P -m soak --minutes $(MINUTES) --write

NUMBER ?= 300
mutants: .venv/dev
	PYTHONPATH=benchmarks $(BIN)/python -P -m mutants --number $(NUMBER) --jobs $(CORES)
	PYTHONPATH=benchmarks $(BIN)/python -P -m mutants --number $(NUMBER) --jobs $(CORES) --compiled --write

clean:
	rm -rf .venv .venv-peers results .snakemake
