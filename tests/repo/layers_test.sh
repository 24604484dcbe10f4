#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Plants one violation at a time and expects scripts/layers.sh to name it.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"

tree_with_modules() {
  empty_tree
  for header in core/base/error core/types/frame core/imu/buffer core/frontend/tracker core/backend/window/window \
    core/backend/factors/prior core/pipeline/runners/runner datasets/stream eval/ate bench/plan reports/table bench/cli/command; do
    put "$header.h" '#pragma once'
  done
}
# allowed FILE INCLUDE
allowed() {
  tree_with_modules
  put "$1" "#include $2"
  expect_clean layers.sh "$2 in $1"
}
# forbidden FILE INCLUDE
forbidden() {
  tree_with_modules
  put "$1" "#include $2"
  expect_fault layers.sh "$1:1:" "$2 in $1"
}

allowed core/imu/a.cpp '"core/imu/buffer.h"'
allowed core/imu/a.cpp '"core/types/frame.h"'
allowed core/backend/a.cpp '"core/imu/buffer.h"'
allowed core/loop/a.cpp '"core/backend/factors/prior.h"'
allowed core/pipeline/a.cpp '"core/frontend/tracker.h"'
allowed bench/a.cpp '"core/pipeline/runners/runner.h"'
allowed reports/a.cpp '"bench/plan.h"'
allowed bench/cli/a.cpp '"reports/table.h"'
forbidden core/base/a.h '"core/types/frame.h"'
forbidden core/imu/a.cpp '"core/frontend/tracker.h"'
forbidden core/frontend/a.cpp '"core/imu/buffer.h"'
forbidden core/frontend/a.cpp '"core/backend/window/window.h"'
forbidden core/loop/a.cpp '"core/backend/window/window.h"'
forbidden core/backend/a.cpp '"core/pipeline/runners/runner.h"'
forbidden datasets/a.cpp '"core/imu/buffer.h"'
forbidden datasets/a.cpp '"eval/ate.h"'
forbidden eval/a.cpp '"core/pipeline/runners/runner.h"'
forbidden eval/a.cpp '"datasets/stream.h"'
forbidden bench/a.cpp '"reports/table.h"'
forbidden bench/a.cpp '"bench/cli/command.h"'
forbidden reports/a.cpp '"bench/cli/command.h"'
forbidden core/newcomer/a.cpp '"core/base/error.h"'
forbidden core/imu/a.cpp '"buffer.h"'
forbidden core/imu/a.cpp '"core/imu/no_such_file.h"'

allowed datasets/io/image_io.cpp '<OpenImageIO/imageio.h>'
allowed datasets/synthetic/scene.cpp '<embree3/rtcore.h>'
allowed core/backend/factors/a.cpp '<ceres/ceres.h>'
allowed core/frontend/a.cpp '<opencv2/video/tracking.hpp>'
allowed datasets/a.cpp '<opencv2/imgproc.hpp>'
allowed bench/store/a.cpp '<sqlite3.h>'
allowed bench/cli/command_line.cpp '<CLI/CLI.hpp>'
allowed eval/a.cpp '<Eigen/Core>'
forbidden datasets/other.cpp '<OpenImageIO/imageio.h>'
forbidden datasets/a.cpp '<embree3/rtcore.h>'
forbidden core/frontend/a.cpp '<ceres/ceres.h>'
forbidden bench/a.cpp '<ceres/ceres.h>'
forbidden core/backend/a.cpp '<opencv2/core/mat.hpp>'
forbidden core/types/a.h '<opencv2/calib3d.hpp>'
forbidden datasets/a.cpp '<opencv2/calib3d.hpp>'
forbidden eval/a.cpp '<opencv2/core/mat.hpp>'
forbidden core/base/a.cpp '<sqlite3.h>'
forbidden bench/cli/run/run_command.cpp '<CLI/CLI.hpp>'
forbidden core/imu/a.cpp '<spdlog/spdlog.h>'
forbidden core/imu/a.cpp '<iostream>'
forbidden core/backend/a.cpp '<thread>'
forbidden eval/a.cpp '<nlohmann/json.hpp>'
finish
