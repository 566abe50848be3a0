# Two commands do everything, including setup: `make demo` and `make test`.
# All targets build with one profile, and by the names of programs instead of packages. Dependencies therefore have the
# same features in all targets, and are compiled once.

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

# Rustup's folder, for shells that were opened before it was installed.
export PATH := $(PATH):$(HOME)/.cargo/bin
CARGO ?= cargo

# The real grooms that some tests and rows of `make bench` read. Both print a note if they are missing.
TRESSES_ASSETS ?= $(abspath $(wildcard ../shared/assets))
ifneq ($(TRESSES_ASSETS),)
export TRESSES_ASSETS
# If the folder exists, a test fails if its file is missing.
export TRESSES_REQUIRE_ASSETS ?= 1
endif

# Without a session, Mesa's device-selection layer prints an error for every program. There is nothing to select.
ifeq ($(XDG_RUNTIME_DIR),)
export NODEVICE_SELECT ?= 1
endif

.PHONY: help setup setup-viewer setup-tests setup-web-tests demo test web-test check-features proof semver fuzz truth bench gpu benchmarks book gallery web viewer web-serve python blender bevy package release clean

help: ## Show this list
	@grep -E '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  make \1\t\2/' | expand -t 14

setup: ## Install what is missing: toolchain, C compiler, a Vulkan driver
	@scripts/setup

comma := ,
# A display to open a window on. Windows and macOS always have one; other systems set a variable.
WINDOW := $(or $(DISPLAY),$(WAYLAND_DISPLAY),$(filter Windows_NT,$(OS)),$(filter Darwin,$(shell uname -s)))

demo: setup ## Open the studio; without a display, draw out/demo.png and out/demo.webp
	@echo "demo: compiling; four to five minutes the first time on two cores, seconds afterwards"
	$(CARGO) build --bin tresses
	@echo "demo: $(if $(WINDOW),opening the studio,drawing out/demo.png$(comma) then the loop out/demo.webp)"
	$(CARGO) run --quiet --bin tresses -- $(if $(WINDOW),studio,demo)

setup-viewer:
	@scripts/setup --viewer

setup-tests:
	@scripts/setup --tests

setup-web-tests:
	@scripts/setup --web-tests

# Lints while compiling, so that dependencies are compiled once. A separate check would compile them a second time.
LINTED := RUSTC_WORKSPACE_WRAPPER=clippy-driver CARGO_BUILD_WARNINGS=deny $(CARGO)

# The software driver that `scripts/setup --tests` unpacked, if it did and the environment names no other.
MESA := $(CURDIR)/target/tools/mesa/lvp_icd.json
DRIVER = $(if $(VK_DRIVER_FILES)$(VK_ICD_FILENAMES),,$(shell test -e '$(MESA)' && echo "VK_DRIVER_FILES='$(MESA)'"))

test: setup-tests ## Check the format, lint, then run every test that needs no browser
	$(CARGO) fmt --all --check
	$(DRIVER) $(LINTED) test --workspace --exclude tresses-web

web-test: setup-web-tests ## Build the web pages and test them in Chromium
	$(DRIVER) $(LINTED) test --workspace --test page

check-features: setup ## Check the library and the plugin for Bevy with each feature alone
	scripts/check-features

proof: setup-tests setup-web-tests ## The docs of the code, the library alone for browsers, the slow evidence behind docs/, which it prints, and damaged files
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps --quiet
	$(CARGO) check --package tresses --lib --example minimal --target wasm32-unknown-unknown --quiet
	@failed=0; set -x; \
	$(LINTED) test --workspace --lib --bins --tests --no-fail-fast -- --ignored --show-output || failed=1; \
	$(LINTED) test --workspace --lib physics:: -- --show-output || failed=1; \
	for workgroups in reversed permuted filled; do \
		TRESSES_WORKGROUPS=$$workgroups $(LINTED) test --workspace --test gpu --no-fail-fast || failed=1; \
		TRESSES_WORKGROUPS=$$workgroups $(LINTED) test --workspace --lib stages:: --no-fail-fast || failed=1; \
	done; \
	$(MAKE) --no-print-directory fuzz || failed=1; \
	$(MAKE) --no-print-directory semver || failed=1; \
	exit $$failed

# The library for systems that this machine is not: those whose standard library `rustup target add` has installed. The
# command and the studio contain C code, which needs a compiler of the target.
FOREIGN = $(shell rustup target list --installed 2>/dev/null | grep -E 'windows|apple')

semver: ## Compare the library's interface with the last tag, if there is one, and check it for other installed targets
	@if tag=$$(git describe --tags --abbrev=0 2>/dev/null); then set -x; \
		command -v cargo-semver-checks >/dev/null || $(CARGO) install --locked --quiet cargo-semver-checks; \
		$(CARGO) semver-checks --baseline-rev "$$tag" --package tresses-groom --package tresses; \
	else echo "semver: there is no tag yet to compare with"; fi
	$(foreach target,$(FOREIGN),$(CARGO) check --package tresses --all-features --lib --target $(target) --quiet;)

# A virtual environment with the wheel. The tests in it compare the wheel with the command.
PYTHON := target/python

python: setup ## Build the wheel for Python into dist/python/, install it in target/python and test it there
	test -x $(PYTHON)/bin/python || python3 -m venv $(PYTHON)
	$(PYTHON)/bin/pip install --quiet maturin==1.16.0 numpy pillow pytest \
		"ray[data]==2.60.0" webdataset==1.0.2 nbclient nbformat ipykernel
	rm -rf dist/python
	$(LINTED) build --bin tresses
	RUSTC_WORKSPACE_WRAPPER=clippy-driver CARGO_BUILD_WARNINGS=deny $(PYTHON)/bin/maturin build --release --strip \
		--manifest-path bindings/python/Cargo.toml --interpreter $(PYTHON)/bin/python --out dist/python
	$(PYTHON)/bin/pip install --quiet --force-reinstall --no-deps dist/python/*.whl
	TRESSES_COMMAND=$(CURDIR)/target/debug/tresses TRESSES_WHEEL=$$(echo dist/python/*.whl) \
		$(PYTHON)/bin/python -m pytest -q -p no:cacheprovider bindings/python/tests

# Blender's Python module wants one version of Python: 3.13 since Blender 5.1, 3.11 before.
BLENDER := target/blender
BLENDER_PYTHON ?= $(or $(shell for it in python3.13 python3.11; do $$it -c '' 2>/dev/null && echo $$it && break; done),python3)
BPY ?= bpy

blender: setup ## Pack the extension for Blender into dist/blender/, and test it in Blender's Python module (0.4 GB)
	test -x $(BLENDER)/bin/python || $(BLENDER_PYTHON) -m venv $(BLENDER)
	$(BLENDER)/bin/pip install --quiet maturin==1.16.0 pytest "$(BPY)"
	rm -rf $(BLENDER)/wheel
	$(BLENDER)/bin/maturin build --release --strip --manifest-path bindings/python/Cargo.toml \
		--interpreter $(BLENDER)/bin/python --out $(BLENDER)/wheel
	$(BLENDER)/bin/python bindings/blender/pack.py $(BLENDER)/wheel/*.whl dist/blender
	$(DRIVER) TRESSES_EXTENSION=$(CURDIR)/dist/blender/tresses-blender.zip \
		$(BLENDER)/bin/python -m pytest -q -p no:cacheprovider bindings/blender/tests

fuzz: setup ## Give readers damaged files, a minute each and 8 GB for all
	cd fuzz && $(CARGO) fmt --check && ulimit -v 8388608 && \
		BOLERO_RANDOM_TEST_TIME_MS=60000 BOLERO_RANDOM_ITERATIONS=1000000000 $(LINTED) test
	TRESSES_DAMAGED_SECONDS=60 $(LINTED) test --workspace --lib -- damaged

release: setup ## Pack the command for this machine into dist/
	@scripts/release

package: setup ## Pack each crate that is meant to be published, and compile it from what was packed
	# Cargo keeps the unpacked and compiled files of a version forever, even before that version is published.
	rm -rf target/package $${CARGO_HOME:-$$HOME/.cargo}/registry/src/-*/tresses*
	$(CARGO) clean --quiet -p tresses-groom -p tresses -p tresses-scene -p tresses-studio
	$(CARGO) package --workspace

bevy: setup ## Check the plugin for Bevy and run its tests, without a window
	cd bindings/bevy && $(CARGO) fmt --check && $(LINTED) test --features cards

truth: setup ## Path-trace 65 views of hair with Mitsuba, two hours, and compare ours with them (docs/validation/path-tracing.md)
	test -d target/truth/python || python3 -m venv target/truth/python
	target/truth/python/bin/pip install --quiet mitsuba==3.9.1 numpy pillow
	$(CARGO) build --bin tresses
	target/truth/python/bin/python tools/evidence/truth target/truth/views
	target/debug/tresses compare target/truth/views/scenes.json --out target/truth/beside

MDBOOK := target/tools/bin/mdbook

book: setup ## Build the book, docs/, into target/book/
	test -x $(MDBOOK) || $(CARGO) install --quiet --locked --root target/tools --no-default-features --features search mdbook@0.5.4
	$(CARGO) run --quiet --bin tresses-web -- book --mdbook $(MDBOOK)

gallery: setup ## Draw the pictures of the docs anew
	$(CARGO) build --bin tresses --example sheet --example embed
	tools/evidence/gallery target/debug/tresses docs/pictures

web: setup ## Build the web page into dist/, for any static file server
	$(CARGO) run --quiet --bin tresses-web -- build

viewer: setup-viewer ## Build <tresses-viewer>, hair as an element for web pages, into dist-viewer/
	$(CARGO) run --quiet --bin tresses-web -- build --page viewer --out dist-viewer

web-serve: web ## Serve the web page on http://127.0.0.1:8080/
	$(CARGO) run --quiet --bin tresses-web -- serve

bench: setup ## Measure every stage on this machine's GPU
	$(CARGO) run --quiet --bin tresses -- bench

gpu: setup ## Test and measure this machine's GPU: out/gpu-report.html, to send; with TESTS=--tests also the tests
	$(CARGO) build --bin tresses
	$(CARGO) run --quiet --bin tresses -- gpu $(TESTS)

benchmarks: setup ## Measure this machine and write docs/benchmarks.md; with FULL=--full also distances, crowds and methods
	$(CARGO) build --bin tresses --bin tresses-evidence
	$(CARGO) run --quiet --bin tresses-evidence -- benchmarks $(FULL)

clean: ## Remove what was built, out/ and dist/
	$(CARGO) clean
	rm -rf out dist
