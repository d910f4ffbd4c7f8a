# make setup | bench | test | check | wheel-check | browser-check | learn-check
PYTHON ?= python3.11
BIN := .venv/bin
STAMP := .venv/.installed
WORKERS ?= 2

.PHONY: setup bench test check wheel-check browser-check learn-check hand clean

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv
	PIP_CONSTRAINT=constraints.txt $(BIN)/pip install --quiet --disable-pip-version-check -e '.[dev]'
	touch $@

# material sheet -> finite elements -> calibration -> hand -> gas and valves -> grasps -> table
bench: $(STAMP)
	$(BIN)/python scripts/calibrate.py --density coarse --store out/bench/fingers --out out/bench/finger.json --json out/bench/calibrate.json
	$(BIN)/python scripts/grasp_benchmark.py --calibration out/bench/finger.json --objects apple,banana,mug,soup_can,cracker_box,tennis_ball --trials 4 \
	  --seed 0 --workers $(WORKERS) --json out/bench/grasps.json --pictures out/bench

test: $(STAMP)
	$(BIN)/pytest --numprocesses $(WORKERS) --dist worksteal

check: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# the wheel, in an empty environment outside the checkout
wheel-check: $(STAMP)
	bash .ci/wheel_check

# the HTML report in headless Chromium, which is installed on Debian if there is none
browser-check: $(STAMP)
	bash .ci/browser_check

# stable-baselines3's contract of all environments, torch against NumPy, training and data sets; needs the extras learn
# and minari (docs/learning.md)
learn-check: $(STAMP)
	@$(BIN)/python -c "import stable_baselines3, minari, jax" || { echo "learn-check: NOT RUN, see docs/learning.md" >&2; exit 1; }
	$(BIN)/pytest tests/learn/env_check.py tests/learn/learn_check.py tests/learn/video_check.py

# assets/hand/*.xml from the shipped calibration
hand: $(STAMP)
	$(BIN)/python scripts/build_hand.py

clean:
	rm -rf .venv out build dist
