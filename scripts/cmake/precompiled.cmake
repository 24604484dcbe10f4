# SPDX-License-Identifier: BSD-3-Clause
# Precompiled headers: parsing the standard library, Eigen and JSON takes longer than compiling most of our files. They
# change no code: sources include what they use, and build with -DSTILLPOINT_PRECOMPILE=OFF as well.
option(STILLPOINT_PRECOMPILE "precompile the headers of libraries" ON)

set(stillpoint_headers_core <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem>
    <functional> <limits> <map> <memory> <optional> <span> <string> <string_view> <utility> <vector>)
set(stillpoint_headers_bench ${stillpoint_headers_core} <fstream> <set> <sstream> <fmt/format.h> <nlohmann/json.hpp>
    <opencv2/core/mat.hpp>)
set(stillpoint_headers_cli ${stillpoint_headers_bench} <spdlog/spdlog.h>)
set(stillpoint_headers_test ${stillpoint_headers_core} <fstream> <sstream> <gtest/gtest.h>)
set(stillpoint_libraries_core Eigen3::Eigen)
set(stillpoint_libraries_bench Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json opencv_core)
set(stillpoint_libraries_cli ${stillpoint_libraries_bench} spdlog::spdlog)
set(stillpoint_libraries_test Eigen3::Eigen GTest::gtest)

# stillpoint_precompile(TARGET SET): uses the headers of SET (core, bench, cli or test), which are compiled once for all
# targets with the same options.
function(stillpoint_precompile target set)
  if(NOT STILLPOINT_PRECOMPILE)
    return()
  endif()
  set(host stillpoint_precompiled_${set})
  if(NOT TARGET ${host})
    set(source ${PROJECT_BINARY_DIR}/${host}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "// Holds the precompiled headers.\n")
    add_library(${host} OBJECT ${source})
    target_link_libraries(${host} PRIVATE stillpoint_options stillpoint_warnings ${stillpoint_libraries_${set}})
    target_precompile_headers(${host} PRIVATE ${stillpoint_headers_${set}})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${host})
endfunction()

# stillpoint_group_json(TARGET): compiles the sources of TARGET that use JSON in groups of three, because each unit
# instantiates the JSON library anew, which takes longer than the rest of such a file. A group contains files of one
# folder only.
function(stillpoint_group_json target)
  if(NOT STILLPOINT_PRECOMPILE)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  list(SORT sources)
  set(previous "")
  foreach(source IN LISTS sources)
    if(NOT EXISTS ${source})
      continue()
    endif()
    file(STRINGS ${source} uses REGEX "#include <nlohmann/json.hpp>")
    if(NOT uses)
      continue()
    endif()
    get_filename_component(folder ${source} DIRECTORY)
    if(NOT folder STREQUAL previous)
      set(count 0)
      set(previous ${folder})
    endif()
    file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR} ${folder})
    math(EXPR group "${count} / 3")
    math(EXPR count "${count} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${name}/${group})
  endforeach()
endfunction()
