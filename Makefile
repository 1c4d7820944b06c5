# Every target sets itself up; needs CPython 3.13 as python3.13, through pyenv, or through uv.
PYTHON := .venv/bin/python
LTS_PYTHON := .venv-lts/bin/python
STAMP := .venv/.installed
LTS_STAMP := .venv-lts/.installed
DIST := dist
# The version stands in pyproject.toml; the manifest names the same file (a test compares them).
COLOUR := $(shell sed -n 's/.*"colour-science==\([^"]*\)".*/\1/p' pyproject.toml)
WHEEL := wheels/colour_science-$(COLOUR)-py3-none-any.whl
# What "blender --command extension" runs, with its list of valid tags, without a Blender application.
BLENDER_EXTENSION = $(PYTHON) -c 'import sys, bpy; from bl_pkg.bl_extension_cli import cli_extension_handler as run; sys.exit(run(sys.argv[1:]))'
# Small renders mostly wait for one thread that compiles shaders, so two files at a time take half as long.
PYTEST_OPTIONS := -n 2 --dist loadfile --no-loadscope-reorder

.PHONY: check demo presets assets docs test test-quick test-lts stress bench bench-quick extension clean

demo: $(STAMP)
	$(PYTHON) -m nested_dielectric demo

test: $(STAMP)
	$(PYTHON) -m pytest $(PYTEST_OPTIONS)

# Style, of Python and of OSL: settings in pyproject.toml and .clang-format.
check: $(STAMP)
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/clang-format --dry-run --Werror osl/*.h osl/*.osl

# What renders nothing, which "make test" runs first.
test-quick: $(STAMP)
	$(PYTHON) -m pytest $(PYTEST_OPTIONS) -m quick

# What touches Blender, each claim on few inputs, on the long-term release, and files that cross between both.
test-lts: $(STAMP) $(LTS_STAMP)
	ND_OTHER_BLENDER=$(PYTHON) $(LTS_PYTHON) -m pytest $(PYTEST_OPTIONS) -m 'not pure and not again'

# All of tests/stress, within an hour, and its tables and plots in benchmarks/.
stress: $(STAMP)
	rm -rf out/stress
	$(PYTHON) -m pytest $(PYTEST_OPTIONS) --dist load --stress tests/stress; status=$$?; \
	  $(PYTHON) benchmarks/stress.py && exit $$status

# The files of presets, from the tables and formulae in presets/build.
presets: $(STAMP)
	$(PYTHON) -m presets.build

# The manual's generated pages, and those of its pictures whose scripts have changed.
docs: $(STAMP)
	$(PYTHON) docs/build

bench: $(STAMP)
	$(PYTHON) benchmarks/bench.py

bench-quick: $(STAMP)
	$(PYTHON) benchmarks/bench.py --quick

# Pictures of presets, those alone that have none or have changed since, and the asset library that shows them. The
# long-term release writes it, as every Blender that the extension is for reads what that one has written.
assets: $(STAMP) $(LTS_STAMP)
	$(PYTHON) presets/assets/previews.py
	$(LTS_PYTHON) presets/assets/library.py library

extension: $(STAMP) $(LTS_STAMP) $(WHEEL)
	$(LTS_PYTHON) presets/assets/library.py library
	@mkdir -p $(DIST)
	$(BLENDER_EXTENSION) build --output-dir $(DIST)
	$(BLENDER_EXTENSION) validate $(DIST)/nested_dielectric-0.2.0.zip

$(WHEEL): | $(STAMP)
	$(PYTHON) -m pip download --quiet --disable-pip-version-check --no-deps --only-binary :all: -d wheels colour-science==$(COLOUR)

# pyproject.toml pins everything; the long-term release takes the place of its Blender.
REQUIREMENTS = $(@D)/bin/python -c 'import tomllib; p = tomllib.load(open("pyproject.toml", "rb")); \
  extras = p["project"]["optional-dependencies"]; \
  lts = p["tool"]["nested-dielectric"]["lts"] if "$(@D)" == ".venv-lts" else None; \
  found = p["project"]["dependencies"] + extras["test"] + ([] if lts else extras["presets"] + extras["check"]); \
  print(*[lts if lts and each.startswith("bpy==") else each for each in found])'

.venv/.installed .venv-lts/.installed: pyproject.toml
	@python=$$(python3.13 -c 'import sys; print(sys.executable)' 2>/dev/null \
	  || PYENV_VERSION=$$(pyenv versions --bare 2>/dev/null | grep '^3\.13' | tail -n 1) pyenv which python3.13 2>/dev/null \
	  || uv python find 3.13 2>/dev/null) \
	  && "$$python" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 13))' 2>/dev/null \
	  || { echo 'CPython 3.13 is needed: install it as python3.13, with "pyenv install 3.13" or with "uv python install 3.13"' >&2; exit 1; }; \
	"$$python" -m venv --clear $(@D)
	$(@D)/bin/python -m pip install --quiet --disable-pip-version-check $$($(REQUIREMENTS))
	$(@D)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps -e .
	@touch $@

clean:
	rm -rf .venv .venv-lts out dist
