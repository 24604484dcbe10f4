#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Plants allowed and forbidden includes and expects scripts/layers.sh to name each of the latter.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"

tree_with_folders() {
  empty_tree
  for header in core/base/error core/types/frame core/imu/buffer core/frontend/tracker core/frontend/klt/klt \
    core/backend/estimator core/backend/window/window core/backend/factors/prior core/backend/solvers/solver \
    core/pipeline/odometry core/pipeline/runners/runner datasets/stream datasets/io/image_io \
    datasets/formats/tum_format datasets/synthetic/sequence/preset eval/score eval/io/trajectory_file \
    eval/metrics/ate bench/model/run bench/config/setting bench/store/store bench/process/child_process \
    bench/run/result bench/profile/timeline bench/profile/meters/energy bench/record/manifest bench/systems/system \
    bench/plan/plan bench/analysis/comparison bench/serve/server bench/cli/command_line bench/cli/run/report \
    reports/tables/table reports/page/page; do
    put "$header.h" '#pragma once'
  done
}
# allowed FILE INCLUDE, forbidden FILE INCLUDE: collected, as each call of scripts/layers.sh reads the whole tree
allowed_includes=() forbidden_includes=()
allowed() { allowed_includes+=("$1 #include $2"); }
forbidden() { forbidden_includes+=("$1 #include $2"); }
# append PATH TEXT: adds a line to a file of the tree. Sets `place` to file:line
append() {
  mkdir -p "$scratch/${1%/*}"
  printf '%s\n' "$2" >>"$scratch/$1"
  place="$1:$(wc -l <"$scratch/$1")"
}
check_includes() {
  local include output places=()
  tree_with_folders
  for include in "${allowed_includes[@]}"; do append "${include%% *}" "${include#* }"; done
  expect_clean layers.sh "an allowed include"
  append core/imu/alone.cpp '#include "core/frontend/tracker.h"'
  expect_fault layers.sh "$place:" "a single forbidden include"
  tree_with_folders
  for include in "${forbidden_includes[@]}"; do
    append "${include%% *}" "${include#* }"
    places+=("$place")
  done
  output="$("$root/scripts/layers.sh" "$scratch" 2>&1)" && fail "no include is refused"
  for include in "${!places[@]}"; do
    [[ $'\n'"$output" == *$'\n'"${places[include]}: "* ]] || fail "not seen: ${forbidden_includes[include]}"
  done
}

# core
allowed core/imu/a.cpp '"core/imu/buffer.h"'
allowed core/imu/a.cpp '"core/types/frame.h"'
allowed core/frontend/a.cpp '"core/frontend/klt/klt.h"'
allowed core/backend/factors/a.cpp '"core/imu/buffer.h"'
allowed core/backend/solvers/a.cpp '"core/backend/factors/prior.h"'
allowed core/backend/a.cpp '"core/backend/solvers/solver.h"'
allowed core/loop/a.cpp '"core/backend/factors/prior.h"'
allowed core/pipeline/a.cpp '"core/frontend/tracker.h"'
allowed core/pipeline/runners/a.cpp '"core/pipeline/odometry.h"'
allowed core/examples/a.cpp '"datasets/stream.h"'
forbidden core/base/a.h '"core/types/frame.h"'
forbidden core/imu/a.cpp '"core/frontend/tracker.h"'
forbidden core/frontend/a.cpp '"core/imu/buffer.h"'
forbidden core/frontend/a.cpp '"core/backend/window/window.h"'
forbidden core/frontend/klt/a.cpp '"core/frontend/tracker.h"'
forbidden core/backend/factors/a.cpp '"core/backend/window/window.h"'
forbidden core/backend/window/a.cpp '"core/backend/solvers/solver.h"'
forbidden core/backend/solvers/a.cpp '"core/backend/estimator.h"'
forbidden core/backend/a.cpp '"core/pipeline/odometry.h"'
forbidden core/loop/a.cpp '"core/backend/window/window.h"'
forbidden core/loop/a.cpp '"core/frontend/tracker.h"'
forbidden core/pipeline/a.cpp '"core/pipeline/runners/runner.h"'
forbidden core/pipeline/a.cpp '"core/backend/solvers/solver.h"'
forbidden core/pipeline/runners/a.cpp '"core/frontend/tracker.h"'
forbidden core/examples/a.cpp '"bench/model/run.h"'

# datasets, eval
allowed datasets/formats/a.cpp '"eval/io/trajectory_file.h"'
allowed datasets/a.cpp '"datasets/formats/tum_format.h"'
forbidden datasets/a.cpp '"core/imu/buffer.h"'
forbidden datasets/a.cpp '"eval/score.h"'
forbidden datasets/formats/a.cpp '"eval/metrics/ate.h"'
forbidden datasets/formats/a.cpp '"datasets/stream.h"'
forbidden datasets/io/a.cpp '"datasets/formats/tum_format.h"'
forbidden eval/metrics/a.cpp '"core/pipeline/runners/runner.h"'
forbidden eval/io/a.cpp '"datasets/io/image_io.h"'
forbidden eval/metrics/a.cpp '"eval/score.h"'

# bench: model < config < store < process < run < profile < record < systems < plan < analysis < serve < cli
allowed bench/config/a.cpp '"bench/model/run.h"'
allowed bench/profile/a.cpp '"bench/profile/meters/energy.h"'
allowed bench/systems/a.cpp '"bench/record/manifest.h"'
allowed bench/plan/a.cpp '"bench/systems/system.h"'
allowed bench/run/a.cpp '"core/pipeline/runners/runner.h"'
allowed bench/cli/run/a.cpp '"bench/cli/command_line.h"'
forbidden bench/model/a.cpp '"bench/store/store.h"'
forbidden bench/config/a.cpp '"bench/plan/plan.h"'
forbidden bench/config/a.cpp '"bench/systems/system.h"'
forbidden bench/store/a.cpp '"bench/run/result.h"'
forbidden bench/process/a.cpp '"bench/run/result.h"'
forbidden bench/run/a.cpp '"bench/profile/timeline.h"'
forbidden bench/profile/a.cpp '"bench/record/manifest.h"'
forbidden bench/profile/meters/a.cpp '"bench/profile/timeline.h"'
forbidden bench/record/a.cpp '"bench/systems/system.h"'
forbidden bench/systems/a.cpp '"bench/plan/plan.h"'
forbidden bench/plan/a.cpp '"bench/analysis/comparison.h"'
forbidden bench/plan/a.cpp '"reports/tables/table.h"'
forbidden bench/plan/a.cpp '"bench/cli/command_line.h"'
forbidden bench/cli/a.cpp '"bench/cli/run/report.h"'
forbidden bench/cli/data/a.cpp '"bench/cli/run/report.h"'
forbidden bench/config/a.cpp '"core/pipeline/odometry.h"'

# reports
allowed reports/page/a.cpp '"reports/tables/table.h"'
allowed bench/cli/plan/a.cpp '"reports/tables/table.h"'
forbidden reports/tables/a.cpp '"reports/page/page.h"'
forbidden reports/page/a.cpp '"bench/cli/command_line.h"'

# folders without a row, and includes that are not from the root of the sources
forbidden core/newcomer/a.cpp '"core/base/error.h"'
forbidden core/backend/newcomer/a.cpp '"core/base/error.h"'
forbidden bench/newcomer/a.cpp '"core/base/error.h"'
forbidden bench/a.cpp '"core/base/error.h"'
forbidden core/imu/a.cpp '"buffer.h"'
forbidden core/imu/a.cpp '"core/imu/no_such_file.h"'

# libraries
allowed datasets/io/image_module.cpp '<OpenImageIO/imageio.h>'
allowed datasets/synthetic/render/embree.h '<embree3/rtcore.h>'
allowed core/frontend/patch/patch_kernel.cpp '<hwy/highway.h>'
allowed core/backend/factors/a.cpp '<ceres/ceres.h>'
allowed core/frontend/klt/a.cpp '<opencv2/video/tracking.hpp>'
allowed datasets/io/a.cpp '<opencv2/core/mat.hpp>'
allowed reports/frames/a.cpp '<opencv2/imgproc.hpp>'
allowed reports/drawing/drawing_module.cpp '<pango/pangocairo.h>'
allowed datasets/tiles/projection_module.cpp '<proj.h>'
allowed bench/store/a.cpp '<sqlite3.h>'
allowed bench/cli/command_line.cpp '<CLI/CLI.hpp>'
allowed core/pipeline/runners/realtime_runner.cpp '<thread>'
allowed eval/metrics/a.cpp '<Eigen/Core>'
forbidden datasets/io/other.cpp '<OpenImageIO/imageio.h>'
forbidden datasets/synthetic/scenes/a.cpp '<embree3/rtcore.h>'
forbidden datasets/tiles/map_tiles.cpp '<proj.h>'
forbidden core/frontend/a.cpp '<hwy/highway.h>'
forbidden core/frontend/a.cpp '<ceres/ceres.h>'
forbidden core/backend/a.cpp '<ceres/ceres.h>'
forbidden bench/run/a.cpp '<ceres/ceres.h>'
forbidden core/backend/a.cpp '<opencv2/core/mat.hpp>'
forbidden core/types/a.h '<opencv2/calib3d.hpp>'
forbidden datasets/a.cpp '<opencv2/calib3d.hpp>'
forbidden eval/metrics/a.cpp '<opencv2/core/mat.hpp>'
forbidden reports/drawing/a.cpp '<opencv2/imgproc.hpp>'
forbidden datasets/io/image_io.cpp '<OpenImageIO/imageio.h>'
forbidden reports/frames/a.cpp '<opencv2/videoio.hpp>'
forbidden core/base/a.cpp '<sqlite3.h>'
forbidden bench/cli/run/run_command.cpp '<CLI/CLI.hpp>'
forbidden bench/run/a.cpp '<spdlog/spdlog.h>'
forbidden core/imu/a.cpp '<iostream>'
forbidden core/backend/a.cpp '<thread>'
forbidden core/pipeline/runners/sequential_runner.cpp '<thread>'
forbidden bench/plan/a.cpp '<thread>'
forbidden eval/io/a.cpp '<nlohmann/json.hpp>'

check_includes
finish
