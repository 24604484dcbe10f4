# SPDX-License-Identifier: BSD-3-Clause
# Build time. Precompiled headers: parsing the standard library, Eigen and JSON takes longer than compiling most of our
# files. Groups: several sources compiled as one, so that templates are instantiated once. Neither changes any code:
# sources include what they use, and build with -DSTILLPOINT_PRECOMPILE=OFF and -DSTILLPOINT_UNITY=OFF as well.
option(STILLPOINT_PRECOMPILE "precompile the headers of libraries" ON)

set(stillpoint_headers_core <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem>
    <functional> <limits> <map> <memory> <optional> <span> <string> <string_view> <utility> <vector>
    <opencv2/core/mat.hpp>)
set(stillpoint_headers_bench ${stillpoint_headers_core} <fstream> <set> <sstream> <fmt/format.h> <nlohmann/json.hpp>)
set(stillpoint_headers_test ${stillpoint_headers_core} <fstream> <sstream> <gtest/gtest.h>)
set(stillpoint_libraries_core Eigen3::Eigen opencv_core)
set(stillpoint_libraries_bench ${stillpoint_libraries_core} fmt::fmt nlohmann_json::nlohmann_json)
set(stillpoint_libraries_test ${stillpoint_libraries_core} GTest::gtest)

# Sources without the computations of core, datasets and eval: bench, reports and tests. Optimizing them would take a
# third of their compile time. -fexpensive-optimizations fuses products and sums as -O3 does: the linker may take an
# inline function that both sides emit from here.
set(stillpoint_options_bench $<$<CONFIG:Release>:-O1> $<$<CONFIG:Release>:-fexpensive-optimizations>)
set(stillpoint_options_test $<$<CONFIG:Release>:-O1>)
# Under sanitizers they are not optimized at all: a third of their compile time.
if(STILLPOINT_SANITIZE)
  list(APPEND stillpoint_options_bench -O0)
  list(APPEND stillpoint_options_test -O0)
endif()

# The garbage collector of g++ runs whenever the heap has doubled, and then visits all that the precompiled headers
# contain: a tenth of the compile time. It starts at 1 GiB instead of 128 MiB, which few files reach.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(--param=ggc-min-heapsize=1048576)
endif()

# stillpoint_precompiled_headers(SET): compiles the headers of SET (core, bench or test) in this folder, unless another one did.
function(stillpoint_precompiled_headers set)
  set(host stillpoint_precompiled_${set})
  if(NOT STILLPOINT_PRECOMPILE OR TARGET ${host})
    return()
  endif()
  set(source ${PROJECT_BINARY_DIR}/${host}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Holds the precompiled headers.\n")
  add_library(${host} OBJECT ${source})
  target_link_libraries(${host} PRIVATE stillpoint_options stillpoint_warnings ${stillpoint_libraries_${set}})
  target_compile_options(${host} PRIVATE ${stillpoint_options_${set}})
  target_precompile_headers(${host} PRIVATE ${stillpoint_headers_${set}})
endfunction()

# stillpoint_precompile(TARGET SET): uses the headers of SET, which are compiled once for all targets with the same options,
# and the options of SET.
function(stillpoint_precompile target set)
  target_compile_options(${target} PRIVATE ${stillpoint_options_${set}})
  if(NOT STILLPOINT_PRECOMPILE)
    return()
  endif()
  stillpoint_precompiled_headers(${set})
  target_precompile_headers(${target} REUSE_FROM stillpoint_precompiled_${set})
endfunction()

# stillpoint_group(TARGET [ACROSS_FOLDERS] [EXCEPT regex]): compiles the sources of TARGET in groups: one per folder, or few
# of equal size. Left out are sources with results that would depend on it: inlining between sources can let the
# compiler fuse other products, which changes last bits. Signatures of helpers must differ within a folder or target.
option(STILLPOINT_UNITY "compile sources in groups: half the time from scratch, longer after a change of one file" OFF)
function(stillpoint_group target)
  cmake_parse_arguments(ARG "ACROSS_FOLDERS" "EXCEPT" "" ${ARGN})
  if(NOT STILLPOINT_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  list(SORT sources)
  set(grouped "")
  foreach(source IN LISTS sources)
    cmake_path(IS_PREFIX PROJECT_BINARY_DIR "${source}" is_generated)
    if(NOT is_generated AND NOT (ARG_EXCEPT AND source MATCHES "${ARG_EXCEPT}"))
      list(APPEND grouped ${source})
    endif()
  endforeach()
  list(LENGTH grouped count)
  math(EXPR groups "(${count} + 39) / 40")  # up to 40 sources take 2 GB of memory
  set(index 0)
  foreach(source IN LISTS grouped)
    if(ARG_ACROSS_FOLDERS)
      math(EXPR group "${index} * ${groups} / ${count}")
      math(EXPR index "${index} + 1")
      set(group ${target}/${group})
    else()
      get_filename_component(folder ${source} DIRECTORY)
      file(RELATIVE_PATH group ${PROJECT_SOURCE_DIR} ${folder})
    endif()
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
endfunction()
