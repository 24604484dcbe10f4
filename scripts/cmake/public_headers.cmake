# SPDX-License-Identifier: BSD-3-Clause
# The public headers: the ones that are installed, documented, and compiled alone by the tests. A public header includes
# only public headers, the standard library, Eigen and opencv2/core/mat.hpp, which public_headers_check.cmake verifies.
# Run as a script (cmake -P public_headers.cmake) it prints the list, one path per line.

# stillpoint_public_headers(ROOT RESULT): their paths, relative to ROOT, sorted.
function(stillpoint_public_headers root result)
  set(patterns base geometry types config imu)
  list(TRANSFORM patterns REPLACE "(.+)" "${root}/core/\\1/*.h")
  file(GLOB_RECURSE headers RELATIVE ${root} ${patterns} ${root}/eval/*.h)
  file(GLOB datasets_headers RELATIVE ${root} ${root}/datasets/*.h ${root}/datasets/io/sequence_info.h
       ${root}/datasets/cache/frame_cache_options.h)
  list(APPEND headers ${datasets_headers} bench/config/config_file.h core/dynamic/semantic_mask.h
       core/pipeline/stages/frame_report.h core/pipeline/odometry.h core/pipeline/threaded_odometry.h)
  list(REMOVE_ITEM headers
       core/base/thread_name.h       # needs pthreads
       datasets/read_sequence.h)     # for open_sequence and the validator
  list(SORT headers)
  set(${result} ${headers} PARENT_SCOPE)
endfunction()

if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  get_filename_component(root ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)
  stillpoint_public_headers(${root} headers)
  list(JOIN headers "\n" headers)
  execute_process(COMMAND ${CMAKE_COMMAND} -E echo "${headers}")
endif()
