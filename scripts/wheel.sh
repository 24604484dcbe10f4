#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes a wheel of the Python package with the evaluation only (stillpoint.eval; code of this project and Eigen, no other library), for
# the Python of this system and any amd64 or arm64 processor.
#   scripts/wheel.sh           builds it for the baseline of the architecture; the wheel is in build/wheel/wheels
#   scripts/wheel.sh BUILD     packs what the build folder BUILD has, with its instruction set, into BUILD/wheels
#   scripts/wheel.sh ... --full   with the odometry, stores, datasets and rendering: for this system and its libraries only, and under the
#                              GPL of SuiteSparse when it is redistributed
#   scripts/wheel.sh ... --test   also installs it in a new virtual environment, which has no other package but the system's
#                              numpy, and runs an example there
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

fail() { echo "wheel: error: $*" >&2; exit 2; }
build="" test=no full=""
for argument in "$@"; do
  case "$argument" in
    --test) test=yes ;;
    --full) full=full ;;
    -*) fail "unknown option \"$argument\"; the options are --full and --test" ;;
    *) [[ -z "$build" ]] || fail "more than one build folder"; build="$argument" ;;
  esac
done
if [[ -z "$build" ]]; then
  build=build/wheel
  march="" targets=(stillpoint_python stillpoint)
  [[ -n "$full" ]] || targets=(stillpoint_python_eval)
  [[ "$(uname -m)" != x86_64 ]] || march=x86-64
  cmake --preset release -B "$build" "-DSTILLPOINT_MARCH=$march" --log-level=WARNING >"$(log_file configure-wheel)" 2>&1 ||
    show_failure configure-wheel
  cmake --build "$build" --target "${targets[@]}" --parallel "$(nproc)"
fi
python="$(sed -n 's/^STILLPOINT_PYTHON:[A-Z]*=//p' "$build/CMakeCache.txt" 2>/dev/null)" || true
needed=_eval
[[ -z "$full" ]] || needed=_odometry
compgen -G "$build/python/stillpoint/$needed*.so" >/dev/null ||
  fail "$build has no Python package; run scripts/setup.sh --python, and build it"
version="$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$build/CMakeCache.txt")"
wheel="$("$python" -B bench/python/make_wheel.py "$build/python/stillpoint" "$version" LICENSE "$build/wheels" $full)"
echo "wheel: $wheel"
[[ $test == yes ]] || exit 0

scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
"$python" -m venv "$scratch/venv" 2>"$scratch/log" || fail "no virtual environment; run scripts/setup.sh --python: $(tail -n 1 "$scratch/log")"
"$scratch/venv/bin/pip" install --quiet --disable-pip-version-check --no-index --no-deps "$wheel"
"$python" -c 'import numpy, os; print(os.path.dirname(os.path.dirname(numpy.__file__)))' >"$scratch"/numpy.pth
mv "$scratch"/numpy.pth "$(echo "$scratch"/venv/lib/python3*/site-packages)"
for i in {1..40}; do echo "$i.0 $((i * i)) $i 0 0 0 0 1"; done >"$scratch/poses.tum"
program="$(realpath -m -- "$build/stillpoint")"  # which reads the configs for the odometry
cd "$scratch"
env -u PYTHONPATH venv/bin/python "$OLDPWD/core/examples/python/score_files.py" poses.tum poses.tum
if [[ -n "$full" ]]; then
  env -u PYTHONPATH venv/bin/python -c 'import stillpoint
stillpoint.synth.render("walking_xyz", "walk", seconds=1.0, width=160, height=120, focal_px=134.0)'
  env -u PYTHONPATH STILLPOINT_PROGRAM="$program" venv/bin/python "$OLDPWD/core/examples/python/feed_odometry.py" walk | tail -n 1
  exit 0
fi
env -u PYTHONPATH venv/bin/python -c 'import stillpoint
try:
    stillpoint.store
except AttributeError as error:
    print(error)
else:
    raise SystemExit("the wheel has more than the evaluation")'
