# SPDX-License-Identifier: BSD-3-Clause
# The program of STILLPOINT_MINIMAL: the sources that `run`, `eval`, `config`, `device` and `data check` need, and
# absent_parts.cpp in place of what they could call beyond that.

file(GLOB minimal_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/run/*.cpp ${CMAKE_CURRENT_SOURCE_DIR}/record/*.cpp)
list(FILTER minimal_sources EXCLUDE REGEX "/run/sequence_source.cpp$")
set(more_sources
  bench/config/config_hash bench/minimal/absent_parts bench/profile/timeline bench/profile/meters/allocation_watch
  bench/profile/meters/allocations_uncounted bench/profile/meters/device_info bench/profile/meters/process_usage
  bench/profile/meters/run_monitor reports/drawing/chart reports/drawing/cost_plots reports/drawing/curves reports/drawing/drawing
  reports/drawing/evaluation/error_figures reports/drawing/evaluation/figures reports/drawing/name_spans reports/drawing/openloris_figure reports/drawing/evaluation/path_figure reports/drawing/evaluation/statistics_figure reports/frames/annotated_frames
  reports/frames/landmark_samples reports/frames/surface_samples reports/tables/data_table reports/tables/text_format reports/text/evaluation_report)
set(program_sources
  bench/cli/command_line bench/cli/console bench/cli/main bench/cli/analysis/eval_command
  bench/cli/analysis/eval_cloud_command bench/cli/analysis/eval_figures bench/cli/analysis/eval_results bench/cli/analysis/find_protocol_command
  bench/cli/analysis/pose_files
  bench/cli/analysis/eval_openloris_command bench/cli/data/inspect_commands
  bench/cli/run/config_command bench/cli/run/device_command bench/cli/run/run_command bench/cli/run/run_dumps bench/cli/run/sequence_playback bench/cli/run/version_command
  bench/minimal/commands)
# Full paths, which stillpoint_group requires.
list(TRANSFORM more_sources REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/\\1.cpp")
list(TRANSFORM program_sources REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/\\1.cpp")

stillpoint_library(stillpoint_minimal HEADERS bench
  SOURCES ${minimal_sources} ${more_sources} ${build_info_source}
  PUBLIC stillpoint_config stillpoint_pipeline stillpoint_datasets stillpoint_faults stillpoint_eval stillpoint_model Threads::Threads
  PRIVATE opencv_imgproc fmt::fmt nlohmann_json::nlohmann_json tomlplusplus::tomlplusplus)
stillpoint_group(stillpoint_minimal ACROSS_FOLDERS)
add_dependencies(stillpoint_minimal stillpoint_git_state)

add_executable(stillpoint ${program_sources})
stillpoint_precompile(stillpoint bench)
stillpoint_group(stillpoint ACROSS_FOLDERS)
target_link_libraries(stillpoint PRIVATE stillpoint_minimal stillpoint_warnings CLI11::CLI11 fmt::fmt
                      nlohmann_json::nlohmann_json spdlog::spdlog)
