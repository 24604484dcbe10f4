# SPDX-License-Identifier: BSD-3-Clause
# Writes OUTPUT from TEMPLATE with the git state of ROOT; the file changes only when its content does.
# Run at every build by: cmake -DROOT=... -DTEMPLATE=... -DOUTPUT=... -P build_info.cmake
set(GIT_COMMIT "unknown")
set(GIT_TIME "")
set(GIT_DIRTY "false")
set(GIT_CHANGES "")
find_program(GIT_PROGRAM git)
if(GIT_PROGRAM)
  execute_process(COMMAND ${GIT_PROGRAM} -C ${ROOT} rev-parse HEAD
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(GIT_COMMIT ${commit})
    execute_process(COMMAND ${CMAKE_COMMAND} -E env TZ=UTC ${GIT_PROGRAM} -C ${ROOT} show --no-patch
                            --format=%cd --date=format-local:%Y-%m-%dT%H:%M:%SZ HEAD
                    OUTPUT_VARIABLE GIT_TIME OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    execute_process(COMMAND ${GIT_PROGRAM} -C ${ROOT} status --porcelain
                    OUTPUT_VARIABLE changes OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(changes)
      set(GIT_DIRTY "true")
      execute_process(COMMAND ${GIT_PROGRAM} -C ${ROOT} diff HEAD OUTPUT_VARIABLE difference ERROR_QUIET)
      string(SHA1 GIT_CHANGES "${changes}${difference}")
      string(SUBSTRING "${GIT_CHANGES}" 0 12 GIT_CHANGES)
    endif()
  endif()
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
