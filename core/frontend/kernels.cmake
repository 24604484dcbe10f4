# SPDX-License-Identifier: BSD-3-Clause
# How the SIMD kernels are compiled: for all attainable instruction sets including the portable fallback, independent of
# -march. Without fused multiply-add all of them give bit-identical results. Left out: SVE, whose vectors have no fixed size
# and therefore cannot be elements of arrays; its processors also have NEON.
set(stillpoint_kernel_definitions HWY_COMPILE_ALL_ATTAINABLE
    "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)")
set(stillpoint_kernel_options -ffp-contract=off)
# Highway's code for NEON is compiled with the cryptography extension, which its callers in the standard library must share.
# No instruction of it is used.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  list(APPEND stillpoint_kernel_options -march=armv8-a+crypto)
endif()
