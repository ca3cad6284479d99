# The two commands of the README, and what they stand on. Everything lands in .venv, build and out.

VENV ?= .venv
PY := $(VENV)/bin/python
SOURCES := $(shell find cpp python cmake -type f -not -name '*.pyc') CMakeLists.txt pyproject.toml README.md LICENSE

.PHONY: run figures docs test bench bench-short bench-cpp benchmark-library lint sanitize check check-long clean system

run: $(VENV)/.installed
	$(PY) examples/four_gradings.py out

# The figures of the paper, for print at 85 and 170 mm.
figures: $(VENV)/.installed
	$(PY) docs/gallery/run_all.py out/figures

docs: $(VENV)/.installed
	$(PY) -m pip install --quiet '.[docs]'
	$(PY) -m sphinx -q -W docs docs/_build

test: $(VENV)/.installed build/release/.built
	ctest --preset release
	$(PY) -m pytest -n auto

# Comparison with peers; see bench/README.md. The short form checks answers at small sizes and times nothing.
bench: $(VENV)/.bench benchmark-library build/bench/.transforms
	cmake --build --preset bench
	$(PY) bench/compare.py

bench-short: $(VENV)/.bench build/bench/.transforms
	$(PY) bench/compare.py --short

# The hot loops alone, with flops and bytes.
bench-cpp: benchmark-library build/bench/.transforms
	cmake --preset bench
	cmake --build --preset bench
	build/bench/bench/cpp/hot_loops

$(VENV)/.bench: $(VENV)/.installed
	$(PY) -m pip install --quiet 'comminute[bench]'  # the one just installed, which brings no new build
	touch $@

build/bench/.transforms: $(VENV)/.made CMakeLists.txt CMakePresets.json $(wildcard bench/cpp/*)
	cmake --preset bench
	cmake --build --preset bench --target bare_transforms
	touch $@

# Debian packages, where they are missing.
system:
	sh cmake/system_packages.sh

benchmark-library:
	sh cmake/system_packages.sh --bench

$(VENV)/.made: | system
	python3 -m venv $(VENV)
	$(PY) -m pip install --quiet --upgrade pip
	touch $@

$(VENV)/.installed: $(VENV)/.made $(SOURCES)
	$(PY) -m pip install --quiet '.[dev]'
	touch $@

build/release/.built: $(VENV)/.made $(SOURCES) $(shell find tests/cpp tests/consumer tests/CMakeLists.txt -type f)
	cmake --preset release -DPython3_EXECUTABLE=$(abspath $(PY))
	cmake --build --preset release
	touch $@

lint: $(VENV)/.installed
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy --strict python/comminute examples tests docs/gallery docs/validation bench
	PYTHONPATH=python $(VENV)/bin/lint-imports --no-logo
	clang-format --dry-run --Werror $$(git ls-files '*.hpp' '*.cpp')
	cmake --preset release > /dev/null
	ls cpp/src/*/*.cpp | xargs -P 2 -n 1 clang-tidy --quiet -p build/release --extra-arg=-Wno-unknown-warning-option

# C++ tests under AddressSanitizer with UBSan, under ThreadSanitizer, not optimised and without FFTW, and by clang.
sanitize: $(VENV)/.made
	for preset in asan tsan no-fftw clang; do \
	  cmake --preset $$preset -DPython3_EXECUTABLE=$(abspath $(PY)) && cmake --build --preset $$preset && ctest --preset $$preset || exit 1; \
	done

check: lint sanitize test

# Long random checks; all but the first write their reports under docs/validation.
check-long: $(VENV)/.installed
	cmake --preset release > /dev/null
	ls cpp/src/*/*.cpp | xargs -P 2 -n 1 clang-tidy --quiet -p build/release --checks='-*,clang-analyzer-*' \
	  --extra-arg=-Wno-unknown-warning-option
	COMMINUTE_HYPOTHESIS=long $(PY) -m pytest -q tests/laws/test_against_reference.py tests/laws/test_laws.py \
	  tests/laws/test_default_grid.py tests/laws/test_true_warnings.py tests/python/resolved \
	  tests/python/lattice/test_lattice.py
	$(PY) tests/support/mutations.py 60000 30000 20000 100000
	$(PY) tests/support/kills.py 50
	$(PY) tests/long/fuzz_quasi_static.py
	$(PY) tests/long/fuzz_three_cells.py
	$(PY) tests/long/lattice_statistics.py

clean:
	rm -rf $(VENV) build out
