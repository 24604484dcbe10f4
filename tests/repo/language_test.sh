#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Plants private vocabulary and expects scripts/language.sh to report it, and correct English to pass.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"

# refused TEXT...: each is a line of one source file, and each must be reported
refused() {
  local output line=0
  empty_tree
  put core/imu/a.h "$(printf '%s\n' "$@")"
  output="$("$root/scripts/language.sh" "$scratch" 2>&1)" && fail "no text is refused"
  for text in "$@"; do
    line=$((line + 1))
    [[ $'\n'"$output" == *$'\n'"core/imu/a.h:$line:"* ]] || fail "\"$text\" is not seen"
  done
}
# accepted TEXT...: lines of one source file, none of which is reported
accepted() {
  empty_tree
  put core/imu/a.h "$(printf '%s\n' "$@")"
  expect_clean language.sh "correct English"
}
refused '/// One picture of the camera.' 'int picture_count;' 'struct PictureOnWay;' 'struct PointSighting {};' 'Verdict verdict;' \
  'void judge(int);' 'std::string recipe;' 'BoardModel board;' 'Journal journal_;' '// another driver holds the run' \
  '// the person mattes' 'struct Flown {};' '// in flight nothing is allocated' 'double pixel_misfit_px;' 'bool begun_;' \
  '// the plan of the house' '// runs that ended well' 'double miss_share;' 'Feedback feedback(Feedback memory = {});' \
  '// played to and fro' 'class Doctor;' '// slow creep' '// it asks for memory' '// 30 pictures a second' 'KeptMatrix S_;' \
  '// who takes part' '// frames at hand'
accepted '// gyroscope random walk' '// the wall of a room' '// the memory limit of a run' '// a full disk' '// a keyboard on a desk' \
  '// the dashboard of a store' '// a person walks' '// shared landmarks' '// flat ground truth' 'std::shared_ptr<int> p;' \
  'int64_t peak_memory_bytes;' '// the device driver reports an error' '// background features'
finish
