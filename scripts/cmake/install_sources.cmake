# SPDX-License-Identifier: BSD-3-Clause
# Installs sources below a folder "stillpoint". Includes in the sources begin at the root of the repository ("core/x.h").
# Installed as they are, the folders core/ and eval/ would lie directly in include/ and could collide with those of
# another project, so the installed copies include "stillpoint/core/x.h".
# Included by the install script with ROOT (of the sources), FILES (relative to ROOT), STAGE (a scratch folder) and
# DESTINATION, which receives FILES with their folders.
file(REMOVE_RECURSE ${STAGE})
foreach(name IN LISTS FILES)
  file(READ ${ROOT}/${name} text)
  string(REGEX REPLACE "(#include \")(core|eval|datasets|bench)/" "\\1stillpoint/\\2/" text "${text}")
  file(WRITE ${STAGE}/${name} "${text}")
endforeach()
file(INSTALL ${STAGE}/ DESTINATION ${DESTINATION})
