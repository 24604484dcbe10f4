# SPDX-License-Identifier: BSD-3-Clause
# Debian packages by CPack: "stillpoint" (program, modules, man page, completion), "stillpoint-dev" (static libraries,
# headers, package config, examples) and, if it is built, "python3-stillpoint" (the Python package with its examples).
# scripts/package.sh sets STILLPOINT_PACKAGES, and generates the documents.
set(STILLPOINT_PACKAGES OFF CACHE BOOL "prepare the installation for Debian packages")
set(STILLPOINT_CONTACT "The Stillpoint developers <developers@stillpoint.example.org>" CACHE STRING "maintainer of the packages")

set(STILLPOINT_PACKAGE_DEPENDS "" CACHE STRING "packages that the program depends on; empty: found by dpkg-shlibdeps")

if(NOT STILLPOINT_PACKAGES)
  return()
endif()

set(package_documents ${PROJECT_BINARY_DIR}/package_documents)
set(components program library)
if(TARGET stillpoint_python)
  list(APPEND components python)
endif()
foreach(component IN LISTS components)
  set(package stillpoint)
  if(component STREQUAL library)
    set(package stillpoint-dev)
  elseif(component STREQUAL python)
    set(package python3-stillpoint)
  endif()
  install(FILES ${package_documents}/copyright ${package_documents}/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
endforeach()
install(FILES ${package_documents}/stillpoint.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
    WORLD_EXECUTE)
set(CPACK_PACKAGE_CONTACT "${STILLPOINT_CONTACT}")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME stillpoint)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
if(STILLPOINT_PACKAGE_DEPENDS)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${STILLPOINT_PACKAGE_DEPENDS}")
else()
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
endif()
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "RGB-D inertial odometry for dynamic scenes
Estimates the motion of an RGB-D camera in scenes with moving people, and
benchmarks such systems: readers of datasets, rendered sequences with ground
truth, trajectory evaluation, and plans of experiments.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME stillpoint-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
string(CONCAT library_depends "stillpoint (= ${PROJECT_VERSION}), libeigen3-dev, libceres-dev, libsuitesparse-dev, libopencv-dev, "
       "libhwy-dev, libfmt-dev, libtomlplusplus-dev, libyaml-cpp-dev, libsqlite3-dev, libturbojpeg0-dev, libisal-dev, "
       "libblosc-dev, libbz2-dev, liblz4-dev, libzstd-dev, pkg-config")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "${library_depends}")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "RGB-D inertial odometry for dynamic scenes (development files)
Static libraries and headers of the odometry, of the trajectory evaluation
and of the readers of datasets, for find_package(stillpoint) of CMake.")

if(TARGET stillpoint_python)
  set(python_folder ${stillpoint_python_folder}/stillpoint)
  set(python_destination lib/python3/dist-packages/stillpoint)
  file(GLOB python_files ${PROJECT_SOURCE_DIR}/bench/python/stillpoint/*)
  install(FILES ${python_files} DESTINATION ${python_destination} COMPONENT python)
  foreach(module IN LISTS stillpoint_python_modules)
    install(TARGETS stillpoint_python_${module} LIBRARY DESTINATION ${python_destination} COMPONENT python)
    install(FILES ${python_folder}/_${module}.pyi DESTINATION ${python_destination} COMPONENT python)
  endforeach()
  # Where the module of the program is that reads the rarer image formats.
  set_target_properties(stillpoint_python_datasets PROPERTIES INSTALL_RPATH /usr/${STILLPOINT_MODULE_FOLDER})
  install(FILES ${PROJECT_SOURCE_DIR}/scripts/package/python.lintian RENAME python3-stillpoint
          DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides COMPONENT python)
  file(GLOB python_examples ${PROJECT_SOURCE_DIR}/core/examples/python/*.py)
  install(FILES ${python_examples} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-stillpoint/examples COMPONENT python)
  # Modules are for one version of Python.
  string(REGEX MATCH "[0-9]+$" next_minor ${stillpoint_python_version})
  math(EXPR next_minor "${next_minor} + 1")
  string(CONCAT python_depends "stillpoint (= ${PROJECT_VERSION}), python3 (>= ${stillpoint_python_version}~), "
         "python3 (<< 3.${next_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-stillpoint)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${python_depends}")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas, python3-matplotlib")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "RGB-D inertial odometry for dynamic scenes (Python package)
Trajectory evaluation, stores of results, readers of datasets, rendered
sequences and the odometry for Python, with numpy arrays.")
endif()
include(CPack)
