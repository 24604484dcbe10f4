# SPDX-License-Identifier: BSD-3-Clause
# cmake -D PROGRAM=... -D EXPECTED=FILE -P compare.cmake: fails unless PROGRAM prints the content of the file.
list(REMOVE_ITEM PROGRAM "")
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE digests COMMAND_ERROR_IS_FATAL ANY)
file(READ ${EXPECTED} expected)
if(NOT digests STREQUAL expected)
  message(FATAL_ERROR "the kernels give other bits than expected:\n${digests}expected:\n${expected}")
endif()
message("${digests}")
