#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks every #include against the layers of ARCHITECTURE.md: who may include whom, and where each library from
# outside may be seen. Prints each violation as file:line; exit 1 if there is one.
#   scripts/layers.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"

# module -> the modules it may include, besides itself. "*" stands for the rest of a path.
below_types="core/base core/geometry core/types"
declare -A may_include=(
  [core/base]=""
  [core/geometry]="core/base"
  [core/types]="core/base core/geometry"
  [core/imu]="$below_types"
  [core/frontend]="$below_types"
  [core/dynamic]="$below_types"
  [core/detector]="$below_types"
  [core/backend]="$below_types core/imu"
  [core/loop]="$below_types core/backend/factors"
  [core/pipeline]="core/*"
  [datasets]="$below_types"
  [eval]="$below_types"
  [bench]="core/* datasets eval"
  [bench/micro]="core/* datasets eval tests/support"
  [reports]="core/* datasets eval bench"
  [bench/cli]="core/* datasets eval bench reports"
)

# header prefix (extended regex) -> the files that may include it (extended regex)
libraries=(
  '<OpenImageIO/      ^datasets/io/image_io\.cpp$'
  '<embree3/          ^datasets/synthetic/'
  '<hwy/              ^core/frontend/(fast|patch)_kernel.cpp'
  '<ceres/            ^core/(backend|loop)/'
  '<(cholmod|suitesparse/|SuiteSparse)  ^core/(backend|loop)/'
  '<opencv2/(core|imgproc)[./]  ^core/(types|frontend|dynamic|detector|loop)/|^datasets/|^bench/micro/|^reports/(picture_annotator\.|(raster_drawing|worst_pictures)\.cpp$|video_file\.)'
  '<opencv2/calib3d[./]  ^core/(frontend|dynamic|detector|loop)/|^core/backend/start/relative_pose\.cpp$'
  '<opencv2/videoio[./]  ^reports/frames/video_file\.cpp$'
  '<opencv2/          ^core/(frontend|dynamic|detector|loop)/'
  '<(sqlite3|zstd)    ^bench/store/'
  '<microhttpd       ^bench/serve/'
  '<CLI/              ^bench/cli/command_line\.cpp$'
  '<spdlog/           ^bench/'
  '<toml\+\+/         ^(bench|datasets)/'
  '<yaml-cpp/         ^datasets/'
  '<nlohmann/         ^(bench|reports|datasets)/'
  '<benchmark/        ^bench/micro/'
  '<gtest/            ^$'
  '<(iostream|print)> ^(bench|reports)/'
  '<(thread|future|execution)>  ^core/(pipeline|frontend)/|^(datasets|bench|reports)/'
)

violations=0
violation() { # FILE:LINE TEXT
  echo "$1: $2"
  violations=$((violations + 1))
}

# module_of PATH -> REPLY; empty for what is in no module
module_of() {
  case "$1" in
    core/*/*) REPLY="${1#core/}" REPLY="core/${REPLY%%/*}" ;;
    bench/cli/*) REPLY=bench/cli ;;
    bench/micro/*) REPLY=bench/micro ;;
    tests/support/*) REPLY=tests/support ;;
    datasets/* | eval/* | bench/* | reports/*) REPLY="${1%%/*}" ;;
    *) REPLY="" ;;
  esac
}

check_project_include() { # WHERE MODULE TARGET
  local where="$1" module="$2" target="$3" allowed
  module_of "$target"
  local target_module="$REPLY"
  if [[ -z "$target_module" || ! -e "$target" ]]; then
    violation "$where" "\"$target\" is no header of the house; write includes from the root of the sources"
    return
  fi
  [[ "$target_module" == "$module" ]] && return
  for allowed in ${may_include[$module]}; do
    case "$allowed" in
      *'*') [[ "$target" == "${allowed%\*}"* ]] && return ;;
      core/*/*) [[ "$target" == "$allowed"/* ]] && return ;;
      *) [[ "$target_module" == "$allowed" ]] && return ;;
    esac
  done
  violation "$where" "$module must not include $target_module (\"$target\")"
}

check_library_include() { # WHERE FILE HEADER
  local rule pattern place
  for rule in "${libraries[@]}"; do
    read -r pattern place <<<"$rule"
    [[ "$3" =~ ^$pattern ]] || continue
    [[ "$2" =~ $place ]] || violation "$1" "$3 is not to be seen here, only in files that match $place"
    return 0 # the first rule that matches decides
  done
}

set -f # the tables hold "*"
while IFS=: read -r file line text; do
  module_of "$file"
  module="$REPLY"
  if [[ -z "${may_include[$module]+known}" ]]; then
    violation "$file:$line" "module \"$module\" has no row in scripts/layers.sh"
    continue
  fi
  header="${text#*include}"
  header="${header#"${header%%[\"<]*}"}" # from the opening mark on
  case "$header" in
    \"*) header="${header#\"}" && check_project_include "$file:$line" "$module" "${header%%\"*}" ;;
    *) check_library_include "$file:$line" "$file" "${header%%>*}>" ;;
  esac
done < <(grep -rHnE --include='*.h' --include='*.cpp' '^ *# *include' core datasets eval bench reports || true)

((violations == 0)) || { echo "layers: $violations violation(s)"; exit 1; }
echo "layers: clean"
