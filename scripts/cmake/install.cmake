# SPDX-License-Identifier: BSD-3-Clause
# The installable library: one static library per component, headers, package config, examples; and the program.
# scripts/cmake/stillpointConfig.cmake.in finds the libraries that the components link.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
# Set to e.g. lib/stillpoint where the folder of libraries is for libraries with versions only, as
# in Debian packages. Modules then belong to the program, on which the package of the libraries depends.
set(STILLPOINT_MODULE_FOLDER "" CACHE STRING "folder of the modules; \"\" = the folder of libraries")
set(stillpoint_module_folder ${CMAKE_INSTALL_LIBDIR})
if(STILLPOINT_MODULE_FOLDER)
  set(stillpoint_module_folder ${STILLPOINT_MODULE_FOLDER})
endif()
set(stillpoint_package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/stillpoint)

# stillpoint_component(NAME MODULES targets... [PUBLIC libs...] [PRIVATE libs...]): joins the objects of internal libraries
# to libstillpoint_NAME.a, which is stillpoint::NAME, in this build as in an installation. Compiler flags of this build are
# not exported, but what the layout of types depends on is.
function(stillpoint_component name)
  cmake_parse_arguments(ARG "" "" "MODULES;PUBLIC;PRIVATE" ${ARGN})
  list(TRANSFORM ARG_MODULES REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE objects)
  set(target stillpoint_component_${name})
  add_library(${target} STATIC ${objects})
  add_library(stillpoint::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX OUTPUT_NAME stillpoint_${name} EXPORT_NAME ${name}
                        ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE}
                        INTERFACE $<BUILD_INTERFACE:stillpoint_options>)
  target_compile_features(${target} INTERFACE cxx_std_20)
  # Eigen aligns and allocates by -march unless told: poses and matrices that cross the border must have one layout, and
  # one way to be freed, on both sides.
  target_compile_definitions(${target} INTERFACE
                             $<INSTALL_INTERFACE:EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=0>)
  install(TARGETS ${target} EXPORT stillpoint_${name} COMPONENT library
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT stillpoint_${name} NAMESPACE stillpoint:: DESTINATION ${stillpoint_package_folder} COMPONENT library)
endfunction()

# stillpoint_module(NAME SOURCE source LIBRARIES libs... COMPONENTS components...): lib/libstillpoint_NAME.so, which is
# loaded when it is first used (datasets/io/shared_module.h), and belongs to these components of the installation.
function(stillpoint_module name)
  cmake_parse_arguments(ARG "" "SOURCE" "LIBRARIES;COMPONENTS" ${ARGN})
  set(target stillpoint_module_${name})
  add_library(${target} MODULE ${ARG_SOURCE})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME stillpoint_${name} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
  target_link_libraries(${target} PRIVATE stillpoint_options stillpoint_warnings ${ARG_LIBRARIES})
  if(STILLPOINT_MODULE_FOLDER)
    set(ARG_COMPONENTS program)
  endif()
  foreach(component IN LISTS ARG_COMPONENTS)
    install(TARGETS ${target} LIBRARY DESTINATION ${stillpoint_module_folder} COMPONENT ${component})
  endforeach()
endfunction()

# stillpoint_install_package(): headers, examples and the package config; called once, after all components.
function(stillpoint_install_package)
  # The list is made when installing, so a header added since configuring is not forgotten.
  set(common "
    include(\"${PROJECT_SOURCE_DIR}/scripts/cmake/public_headers.cmake\")
    set(ROOT \"${PROJECT_SOURCE_DIR}\")")
  install(CODE "${common}
    stillpoint_public_headers(\"\${ROOT}\" FILES)
    set(STAGE \"${PROJECT_BINARY_DIR}/installed_headers\")
    set(DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/stillpoint\")
    include(\"\${ROOT}/scripts/cmake/install_sources.cmake\")" COMPONENT library)
  install(CODE "${common}
    file(GLOB FILES RELATIVE \"\${ROOT}/core/examples\" \"\${ROOT}/core/examples/*.cpp\")
    string(APPEND ROOT /core/examples)
    set(STAGE \"${PROJECT_BINARY_DIR}/installed_examples\")
    set(DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/stillpoint/examples\")
    include(\"${PROJECT_SOURCE_DIR}/scripts/cmake/install_sources.cmake\")" COMPONENT library)

  set(generated ${PROJECT_BINARY_DIR}/package)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/scripts/cmake/stillpointConfig.cmake.in
                                ${generated}/stillpointConfig.cmake INSTALL_DESTINATION ${stillpoint_package_folder})
  # Before 1.0 a minor version may change the interface.
  write_basic_package_version_file(${generated}/stillpointConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${generated}/stillpointConfig.cmake ${generated}/stillpointConfigVersion.cmake
          DESTINATION ${stillpoint_package_folder} COMPONENT library)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/stillpoint COMPONENT library)
  install(FILES ${PROJECT_SOURCE_DIR}/core/examples/installed/CMakeLists.txt
          DESTINATION ${CMAKE_INSTALL_DATADIR}/stillpoint/examples COMPONENT library)
  install(TARGETS stillpoint RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  install(FILES ${PROJECT_SOURCE_DIR}/scripts/package/completion.bash RENAME stillpoint
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
  if(STILLPOINT_PACKAGES) # which have a license file of their own, and a man page that scripts/package.sh makes
    return()
  endif()
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/stillpoint COMPONENT program)
  if(NOT CMAKE_CROSSCOMPILING)
    set(page ${PROJECT_BINARY_DIR}/man/stillpoint.1.gz)
    install(CODE "
      execute_process(COMMAND \"${PROJECT_SOURCE_DIR}/scripts/package/man_page.sh\" \"$<TARGET_FILE:stillpoint>\" \"${page}\"
                      COMMAND_ERROR_IS_FATAL ANY)
      file(INSTALL \"${page}\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\")" COMPONENT program)
  endif()
endfunction()
