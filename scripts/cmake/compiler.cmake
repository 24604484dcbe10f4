# SPDX-License-Identifier: BSD-3-Clause
# Compiler settings shared by every target: warnings, the instruction set, sanitizers.

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 12)
  message(FATAL_ERROR "g++ ${CMAKE_CXX_COMPILER_VERSION} is too old for the C++20 used here; install g++ 12 or later (scripts/setup.sh)")
endif()

# The default instruction set is x86-64-v3 (AVX2, FMA) where the building machine runs it: half the time of the
# window solve is fixed-size Eigen. "native" is left to the user because valgrind knows no AVX-512.
set(STILLPOINT_MARCH "auto" CACHE STRING "value of -march; \"auto\" = x86-64-v3 where it runs, \"\" = the compiler's default")
set(STILLPOINT_SANITIZE "" CACHE STRING "value of -fsanitize, e.g. address,undefined")

if(STILLPOINT_MARCH STREQUAL "auto")
  include(CheckCXXSourceRuns)
  set(CMAKE_REQUIRED_FLAGS "-march=x86-64-v3")
  check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\") ? 0 : 1; }"
                        STILLPOINT_RUNS_X86_64_V3)
  unset(CMAKE_REQUIRED_FLAGS)
  if(STILLPOINT_RUNS_X86_64_V3)
    set(stillpoint_march "x86-64-v3")
  endif()
else()
  set(stillpoint_march "${STILLPOINT_MARCH}")
endif()

# mold links the hundred test programs in a tenth of the time of the default linker.
include(CheckLinkerFlag)
check_linker_flag(CXX -fuse-ld=mold STILLPOINT_HAS_MOLD)
if(STILLPOINT_HAS_MOLD)
  add_link_options(-fuse-ld=mold)
endif()

add_library(stillpoint_warnings INTERFACE)
# Off: designated initializers leave the other fields at their defaults; and warnings that g++ 12 raises for correct
# uses of std::string and Eigen at -O3.
target_compile_options(stillpoint_warnings INTERFACE -Wall -Wextra -Wshadow -Wconversion
                       -Wno-missing-field-initializers -Wno-array-bounds -Wno-restrict
                       -Wno-stringop-overflow -Wno-stringop-overread)
# From g++ 13 on: it takes a reference that a function returns for one to a temporary argument of the call.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
  target_compile_options(stillpoint_warnings INTERFACE -Wno-dangling-reference)
endif()
# Warnings are errors except under sanitizers, whose instrumentation makes g++ 12 see flows that do not exist.
if(STILLPOINT_SANITIZE)
  target_compile_options(stillpoint_warnings INTERFACE -Wno-maybe-uninitialized)
else()
  target_compile_options(stillpoint_warnings INTERFACE -Werror)
endif()

add_library(stillpoint_options INTERFACE)
target_include_directories(stillpoint_options INTERFACE ${PROJECT_SOURCE_DIR})
if(stillpoint_march)
  target_compile_options(stillpoint_options INTERFACE -march=${stillpoint_march})
endif()
# Debian's Ceres is built for baseline x86-64: its Eigen aligns to 16 bytes, so must ours. One thread per stage.
target_compile_definitions(stillpoint_options INTERFACE EIGEN_MAX_ALIGN_BYTES=16
                           EIGEN_MALLOC_ALREADY_ALIGNED=0 EIGEN_DONT_PARALLELIZE)
target_compile_options(stillpoint_options INTERFACE -fno-math-errno -fno-trapping-math)
if(STILLPOINT_SANITIZE)
  target_compile_options(stillpoint_options INTERFACE -fsanitize=${STILLPOINT_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(stillpoint_options INTERFACE -fsanitize=${STILLPOINT_SANITIZE})
  if(STILLPOINT_SANITIZE MATCHES "undefined")
    # Left out: checks of every pointer that Eigen touches. They double the time to compile, and wrong pointers are
    # what the address sanitizer finds.
    target_compile_options(stillpoint_options INTERFACE -fno-sanitize-recover=undefined
                           -fno-sanitize=null,alignment,object-size,pointer-overflow)
  endif()
endif()

# All code can be linked into shared objects as well, e.g. into the modules of Python, and shares precompiled headers.
# Functions cannot be replaced at run time, so they are inlined as in other programs.
add_compile_options(-fPIC -fno-semantic-interposition)

# stillpoint_library(NAME [SOURCES a.cpp ...] [EXCLUDE regex] [HEADERS set] [PUBLIC libs...] [PRIVATE libs...]): one module.
# Without SOURCES: every .cpp file below the current folder whose path does not match EXCLUDE.
# HEADERS: the set of precompiled headers (default: core), see precompiled.cmake.
function(stillpoint_library name)
  cmake_parse_arguments(ARG "" "EXCLUDE;HEADERS" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(NOT ARG_SOURCES)
    file(GLOB_RECURSE ARG_SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
    if(ARG_EXCLUDE)
      list(FILTER ARG_SOURCES EXCLUDE REGEX ${ARG_EXCLUDE})
    endif()
  endif()
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC stillpoint_options ${ARG_PUBLIC} PRIVATE stillpoint_warnings ${ARG_PRIVATE})
  if(NOT ARG_HEADERS)
    set(ARG_HEADERS core)
  endif()
  stillpoint_precompile(${name} ${ARG_HEADERS})
endfunction()
