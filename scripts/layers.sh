#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks every #include against the layers of ARCHITECTURE.md: which folder may include which, and which files may
# include each external library. Prints each violation as file:line; exit 1 if there is one.
#   scripts/layers.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"

# row FOLDER FOLDERS...: the folders that FOLDER may include, besides itself. A folder stands for its own files only, not
# for its subfolders. A folder without a row must not contain sources.
declare -A may_include
row() {
  local folder="$1"
  shift
  may_include[$folder]=" $* "
}

# --- core ---
messages="core/base core/geometry core/types"
common="$messages core/config"
row core/base
row core/geometry core/base
row core/types core/base core/geometry
row core/config core/base
row core/imu $common
row core/frontend/klt $common
row core/frontend/detect $common
row core/frontend/outliers $common
row core/frontend/patch $common core/frontend/klt
frontend="core/frontend/klt core/frontend/detect core/frontend/outliers core/frontend/patch"
row core/frontend $common $frontend
row core/dynamic $common
row core/detector $common
row core/backend/factors $common core/imu
row core/backend/window $common core/imu core/backend/factors
window="core/imu core/backend/factors core/backend/window"
row core/backend/solvers $common $window
row core/backend/reference $common $window core/backend/solvers
row core/backend/vision $common $window
row core/backend/start $common $window core/backend/solvers core/backend/vision
row core/backend/health $common $window core/backend/vision
backend="$window core/backend/solvers core/backend/reference core/backend/vision core/backend/start core/backend/health"
row core/backend $common $backend
row core/loop $common core/backend/factors
row core/calibration $common core/imu core/backend/factors core/backend/reference
row core/pipeline/stages $common core/imu core/frontend core/dynamic core/detector core/loop core/backend \
  core/backend/start core/backend/window
row core/pipeline $common core/imu core/frontend core/dynamic core/detector core/loop core/backend core/backend/start \
  core/backend/window core/pipeline/stages
row core/pipeline/runners $common core/detector core/pipeline core/pipeline/stages
core="$common core/imu core/frontend $frontend core/dynamic core/detector core/backend $backend core/loop core/pipeline
  core/pipeline/stages core/pipeline/runners"

# --- eval: no odometry, no datasets ---
row eval/io $messages
row eval/trajectory $messages eval/io
row eval/metrics $messages eval/trajectory
row eval/statistics $messages eval/metrics
row eval/compare $messages eval/io eval/trajectory eval/metrics
row eval/openloris $messages eval/io eval/trajectory eval/metrics
row eval/protocols $messages eval/trajectory eval/metrics eval/openloris
row eval $messages eval/trajectory eval/metrics
eval="eval eval/io eval/trajectory eval/metrics eval/statistics eval/compare eval/openloris eval/protocols"

# --- datasets: no odometry ---
trajectories="eval/io eval/trajectory"
row datasets/io/png
row datasets/io $messages $trajectories datasets/io/png
row datasets/calibration $messages eval/io datasets/io
row datasets/foxglove $messages datasets/io
row datasets/bags $messages $trajectories datasets/io datasets/calibration datasets/foxglove
row datasets/formats $messages $trajectories datasets/io datasets/calibration datasets/bags
row datasets/cache $messages datasets/io datasets/calibration datasets/formats
row datasets $messages $trajectories datasets/io datasets/calibration datasets/bags datasets/formats datasets/cache
row datasets/mapping $messages datasets/io eval/io
row datasets/minimal core/base eval/io datasets/bags datasets/formats
row datasets/synthetic core/base core/geometry
row datasets/synthetic/materials core/base datasets/synthetic
row datasets/synthetic/motion $messages $trajectories datasets/io datasets/synthetic
row datasets/synthetic/render core/base core/geometry datasets/synthetic datasets/synthetic/materials
scene="core/base core/geometry datasets/synthetic datasets/synthetic/materials datasets/synthetic/motion
  datasets/synthetic/render"
row datasets/synthetic/scenes $scene datasets/io
row datasets/synthetic/actors $scene datasets/io datasets/synthetic/scenes
row datasets/synthetic/sensors $scene core/types datasets/synthetic/actors
row datasets/synthetic/sequence $scene core/types $trajectories datasets/calibration datasets/cache datasets/io datasets/synthetic/scenes datasets/synthetic/actors \
  datasets/synthetic/sensors
row datasets/catalogue core/base
row datasets/download core/base
row datasets/tiles core/base datasets/cache datasets/download datasets/io datasets/mapping
row datasets/faults core/base core/geometry core/types datasets datasets/io datasets/synthetic datasets/synthetic/materials
datasets="datasets datasets/io datasets/calibration datasets/formats datasets/synthetic/sequence"

row core/examples $core $eval $datasets bench/config

# --- bench: each folder includes those above it ---
row bench/model $messages eval eval/metrics eval/trajectory
row bench/config core/base core/config bench/model
row bench/store core/base core/types eval/io bench/model
row bench/store/maintenance core/base eval/io bench/model bench/store
row bench/process core/base bench/model
row bench/run $common core/pipeline core/pipeline/runners datasets datasets/cache datasets/faults datasets/synthetic/sequence eval eval/compare eval/metrics eval/trajectory \
  bench/model bench/config
row bench/profile/meters core/base bench/model
row bench/profile $common core/pipeline/runners eval/io eval/metrics bench/model bench/config bench/process bench/run \
  bench/profile/meters
row bench/diagnose/evidence $messages datasets
row bench/diagnose $common bench/diagnose/evidence datasets datasets/io eval/metrics eval/trajectory bench/config bench/model bench/run
row bench/record $common bench/profile/meters core/pipeline/runners datasets/cache datasets/io eval eval/io eval/metrics bench/model bench/config bench/run \
  bench/profile
row bench/systems $messages datasets datasets/cache datasets/calibration datasets/faults datasets/synthetic/sequence eval eval/compare eval/io eval/metrics eval/trajectory bench/model bench/config bench/process \
  bench/run bench/profile bench/record
row bench/plan core/base datasets datasets/cache datasets/catalogue datasets/faults datasets/synthetic/sequence eval/io eval/metrics eval/protocols eval/trajectory \
  bench/model bench/config bench/store bench/process bench/run bench/record bench/systems
row bench/plan/execution core/base datasets datasets/synthetic/sequence eval/io eval/metrics eval/protocols eval/statistics eval/trajectory \
  bench/model bench/config bench/store bench/process bench/run bench/profile/meters bench/record bench/systems bench/plan
row bench/fetch $common core/detector datasets datasets/bags datasets/cache datasets/io datasets/catalogue datasets/download eval/io bench/model bench/config bench/process bench/record bench/plan
row bench/executors core/base eval/io bench/model bench/config bench/store bench/store/maintenance bench/process bench/record bench/systems \
  bench/plan bench/plan/execution
row bench/analysis core/base eval/metrics eval/statistics bench/model bench/store
row bench/analysis/search core/base eval/statistics bench/model bench/analysis
row bench/serve core/base bench/record
row bench/python $common $eval core/detector core/pipeline core/pipeline/stages datasets datasets/bags datasets/synthetic/sequence bench/model bench/store bench/analysis
row bench/rivals core/base core/geometry core/types datasets eval/io
row bench/micro $core tests/support tests/support/simulated

# --- reports ---
stored="core/base bench/model bench/store bench/analysis"
row reports/tables $stored bench/config eval/metrics eval/statistics bench/systems
row reports/drawing core/base core/geometry core/types datasets/io eval/io eval/metrics eval/openloris eval/protocols eval/statistics eval/trajectory bench/run bench/record \
  reports/tables
row reports/drawing/evaluation core/base core/geometry core/types datasets/mapping eval/io eval/metrics eval/protocols eval/trajectory reports/drawing
row reports/frames core/base core/types core/pipeline/runners bench/model bench/store bench/run datasets datasets/bags datasets/foxglove datasets/io datasets/mapping eval/metrics eval/trajectory
row reports/text $stored eval/io eval/metrics eval/compare eval/openloris eval/protocols bench/systems reports/tables
row reports/page $stored core/types datasets/faults eval/io eval/metrics eval/openloris eval/protocols bench/config bench/profile bench/record bench/systems bench/plan reports/tables \
  reports/drawing
row reports/dashboard $stored bench/record reports/tables reports/page
row reports/live core/base bench/model bench/store reports/tables

# --- the program ---
row bench/cli core/base eval/io bench/config bench/record
execution="core/base bench/cli bench/model bench/config bench/record"
row bench/cli/run $execution bench/systems core/calibration core/config core/geometry core/types core/pipeline/runners datasets datasets/cache datasets/calibration datasets/faults datasets/mapping eval/io eval/metrics eval/statistics bench/diagnose bench/diagnose/evidence bench/store bench/process bench/run bench/profile bench/profile/meters \
  bench/plan reports/tables reports/drawing reports/frames
row bench/cli/data $execution core/detector bench/fetch datasets datasets/catalogue datasets/download datasets/cache datasets/faults datasets/io datasets/mapping datasets/synthetic/sequence eval/io eval/metrics eval/trajectory bench/run bench/plan reports/tables
row bench/cli/plan $execution bench/analysis bench/cli/data bench/profile/meters bench/fetch datasets datasets/catalogue datasets/io eval/io eval/openloris eval/trajectory reports/drawing bench/store bench/process bench/systems bench/plan bench/plan/execution bench/executors reports/tables \
  reports/text reports/page
row bench/cli/analysis/import core/base core/types datasets/download datasets/io eval eval/compare eval/io bench/model bench/process bench/store bench/store/maintenance
row bench/cli/analysis $execution core/types datasets/bags eval/io eval/metrics eval/trajectory eval/compare eval/openloris eval/protocols bench/store bench/store/maintenance bench/systems bench/plan bench/run \
  bench/plan/execution bench/analysis bench/analysis/search bench/cli/analysis/import \
  bench/executors bench/serve datasets/mapping datasets/tiles reports/tables reports/text reports/drawing reports/drawing/evaluation reports/frames reports/page reports/dashboard reports/live
row bench/cli/stats $execution eval/metrics bench/store bench/systems bench/plan bench/analysis reports/tables
row bench/cli/analysis/search $execution bench/systems bench/plan bench/plan/execution bench/analysis bench/analysis/search bench/cli/analysis

# The minimal build: its commands, and the functions that it does not have.
row bench/minimal core/base bench/config bench/cli bench/plan bench/run bench/systems datasets datasets/synthetic/sequence datasets/tiles reports/drawing \
  reports/frames

# header prefix (extended regex) -> the files that may include it (extended regex); the first match decides
libraries=(
  '<OpenImageIO/      ^datasets/io/image_module\.cpp$'
  '<blosc            ^datasets/cache/frame_file\.cpp$'
  '<isa-l/           ^datasets/(io/(image_io|png/huffman_deflate)|bags/bag_chunks|download/archive_extraction)\.cpp$'
  '<(bzlib|lz4)       ^datasets/bags/bag_chunks\.cpp$'
  '<turbojpeg        ^datasets/io/image_io\.cpp$'
  '<embree[34]/        ^datasets/synthetic/render/embree\.h$'
  '<assimp/           ^datasets/synthetic/scenes/mesh_file\.cpp$'
  '<hwy/              ^core/frontend/(detect/fast_kernel|patch/patch_kernel)\.cpp$'
  '<ceres/            ^core/backend/(factors|reference)/|^core/(loop|calibration)/'
  '<(cholmod|suitesparse/|SuiteSparse)  ^core/backend/solvers/|^core/loop/'
  '<opencv2/core[./]  ^bench/(diagnose|rivals|python)/|^core/(types|calibration|frontend|dynamic|detector|loop|examples)/|^datasets/|^bench/micro/|^reports/frames/'
  '<opencv2/imgproc[./]  ^bench/rivals/|^core/(frontend|dynamic|detector|loop)/|^datasets/(synthetic|faults|tiles)/|^bench/micro/|^reports/frames/'
  '<opencv2/calib3d[./]  ^bench/rivals/|^core/(frontend/outliers|dynamic|loop)/|^core/backend/start/monocular_structure\.cpp$'
  '<opencv2/dnn[./]   ^core/detector/'
  '<opencv2/videoio[./]  ^reports/frames/video_module\.cpp$'
  '<opencv2/          ^core/(frontend|dynamic|detector|loop)/|^bench/rivals/'
  '<pybind11/         ^bench/python/'
  '<sqlite3           ^bench/store/|^datasets/bags/'
  '<zstd              ^bench/store/|^datasets/bags/bag_chunks\.cpp$'
  '<(cairo|pango/)   ^reports/drawing/drawing_module\.cpp$'
  '<proj\.h          ^datasets/tiles/projection_module\.cpp$'
  '<microhttpd        ^bench/serve/'
  '<CLI/              ^bench/cli/command_line\.cpp$'
  '<spdlog/           ^bench/cli/'
  '<toml\+\+/         ^bench/(config|systems)/|^datasets/(calibration|catalogue)/'
  '<curl/            ^datasets/download/http_transfer\.cpp$'
  '<archive          ^datasets/download/archive_extraction\.cpp$'
  '<openssl/         ^datasets/download/transfer_checks\.cpp$'
  '<yaml-cpp/         ^datasets/io/'
  '<nlohmann/         ^(bench|reports)/|^datasets/formats/'
  '<benchmark/        ^bench/micro/'
  '<gtest/            ^$'
  '<(iostream|print)> ^bench/cli/|^core/examples/'
)
# The files that start threads, or ask for the number of processors.
threads=(
  'core/frontend/detect/thread_pool\.(h|cpp)'
  'core/pipeline/(threaded_odometry|loop_worker)\.(h|cpp)'
  'core/pipeline/runners/(realtime_runner|pacing)\.(h|cpp)'
  'datasets/synthetic/sequence/render_sequence\.cpp'
  'bench/plan/execution/(sequence_renderer|outcome_scorer)\.(h|cpp)'
  'bench/run/(frame_prefetcher|odometry_run)\.(h|cpp)'
  'bench/diagnose/trials\.cpp'
  'bench/profile/meters/run_monitor\.(h|cpp)'
  'bench/record/run_environment\.cpp'
  'bench/cli/plan/reproduce_command\.cpp'
  'bench/cli/analysis/(eval_command|pose_files)\.cpp'
)
libraries+=("<(thread|future|execution)> ^($(IFS='|' && echo "${threads[*]}"))\$")

violations=0
violation() { # FILE:LINE TEXT
  echo "$1: $2"
  violations=$((violations + 1))
}

check_project_include() { # WHERE FOLDER TARGET
  local target_folder="${3%/*}"
  if [[ "$3" != */* || ! -e "$3" ]]; then
    violation "$1" "\"$3\" is no header of the project; write includes from the root of the sources"
  elif [[ "$target_folder" != "$2" && "${may_include[$2]}" != *" $target_folder "* ]]; then
    violation "$1" "$2 must not include $target_folder (\"$3\")"
  fi
}

declare -A place_of # header -> the files that may include it; empty without a rule
check_library_include() { # WHERE FILE HEADER
  local rule pattern place
  if [[ -z "${place_of[$3]+known}" ]]; then
    place_of[$3]=""
    for rule in "${libraries[@]}"; do
      read -r pattern place <<<"$rule"
      [[ "$3" =~ ^$pattern ]] || continue
      place_of[$3]="$place"
      break # the first rule that matches decides
    done
  fi
  place="${place_of[$3]}"
  [[ -z "$place" || "$2" =~ $place ]] || violation "$1" "$3 must only be included by files that match $place"
}

while IFS=: read -r file line text; do
  folder="${file%/*}"
  if [[ -z "${may_include[$folder]+known}" ]]; then
    violation "$file:$line" "folder \"$folder\" has no row in scripts/layers.sh"
    continue
  fi
  header="${text#*include}"
  header="${header#"${header%%[\"<]*}"}" # from the opening mark on
  case "$header" in
    \"*) header="${header#\"}" && check_project_include "$file:$line" "$folder" "${header%%\"*}" ;;
    *) check_library_include "$file:$line" "$file" "${header%%>*}>" ;;
  esac
done < <(grep -rHnE --include='*.h' --include='*.cpp' '^ *# *include' core datasets eval bench reports || true)

((violations == 0)) || { echo "layers: $violations violation(s)"; exit 1; }
echo "layers: clean"
