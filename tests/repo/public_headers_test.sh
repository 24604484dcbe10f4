#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Plants includes in public headers and expects scripts/cmake/public_headers_check.cmake to report the forbidden ones.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"

check() { cmake -DROOT="$scratch" -P "$root/scripts/cmake/public_headers_check.cmake" >"$scratch/output" 2>&1; }
expect_refused() { # TEXT WHAT
  if check; then fail "$2 is not seen"; fi
  grep -qF -- "$1" "$scratch/output" || fail "$2: expected \"$1\" in: $(<"$scratch/output")"
}

empty_tree
while read -r header; do put "$header" '#pragma once'; done < <(cmake -P "$root/scripts/cmake/public_headers.cmake")
put core/base/error.h '#include <string>'
put core/types/frame.h '#include <opencv2/core/mat.hpp>'
put eval/score.h '#include "core/types/frame.h"  // comment'
check || fail "a clean tree is refused: $(<"$scratch/output")"

put eval/score.h '#include <ceres/ceres.h>'
expect_refused 'eval/score.h includes <ceres/ceres.h>' "Ceres"
put eval/score.h '#include <opencv2/imgproc.hpp>'
expect_refused 'eval/score.h includes <opencv2/imgproc.hpp>' "a module of OpenCV"
put eval/score.h '#include "core/backend/estimator.h"'
expect_refused 'eval/score.h includes "core/backend/estimator.h"' "a private header"
put eval/score.h '#pragma once'
rm "$scratch/core/pipeline/odometry.h"
expect_refused 'core/pipeline/odometry.h is listed as public but does not exist' "a header that is gone"
finish
