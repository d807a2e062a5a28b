# What "cmake --install" puts where, by component: program (todbench), window (todbench-gui), development (the libraries), documentation.
# The files that belong to a desktop, a shell or a package are in bench/package.

# Installing asks for what a component has, not for the test programs.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)

set(todbench_data "${CMAKE_INSTALL_DATADIR}/todbench")
install(TARGETS todbench COMPONENT program)
foreach(entry "plates:tod/plate" "sensors:sim_devices/sensors" "observers:hvs/observers" "plans:bench/plans" "sweeps:bench/sweeps"
        "scenes:sim_devices/scenes" "targets:sim_devices/targets" "target_sets:sim_devices/target_sets"
        "instruments/black_bodies:tod/instruments/black_bodies" "instruments/stages:tod/instruments/stages")
  string(REPLACE ":" ";" entry "${entry}")
  list(GET entry 0 kind)
  list(GET entry 1 folder)
  install(DIRECTORY "${folder}/" DESTINATION "${todbench_data}/${kind}" COMPONENT program FILES_MATCHING PATTERN "*.toml")
endforeach()
install(FILES docs/examples/todbench_session.py DESTINATION "${todbench_data}/python" COMPONENT program)
if(TODBENCH_WITH_GUI)
  install(TARGETS todbench-gui COMPONENT window)
endif()

# The libraries below the bench, without cameras and without Qt, each after those that use it: a linker that reads once wants that order.
function(todbench_add_with_dependencies library)
  if(NOT library MATCHES "^todbench_" OR library STREQUAL "todbench_options" OR library IN_LIST todbench_installed_libraries)
    return()
  endif()
  get_target_property(uses ${library} INTERFACE_LINK_LIBRARIES)
  foreach(used ${uses})
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" used "${used}")
    todbench_add_with_dependencies("${used}")
  endforeach()
  list(PREPEND todbench_installed_libraries ${library})
  set(todbench_installed_libraries "${todbench_installed_libraries}" PARENT_SCOPE)
endfunction()
set(todbench_installed_libraries "")
foreach(folder hvs tod sim_devices)
  get_property(libraries DIRECTORY "${folder}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(library ${libraries})
    todbench_add_with_dependencies(${library})
  endforeach()
endforeach()

# Their warnings and their sanitizers are those of this build; a program that uses them has its own.
foreach(property INTERFACE_COMPILE_OPTIONS INTERFACE_LINK_OPTIONS INTERFACE_COMPILE_DEFINITIONS)
  get_target_property(of_this_build todbench_options ${property})
  if(of_this_build)
    set_target_properties(todbench_options PROPERTIES ${property} "$<BUILD_INTERFACE:${of_this_build}>")
  endif()
endforeach()
set_target_properties(todbench_options PROPERTIES INTERFACE_INCLUDE_DIRECTORIES
  "$<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>;$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/todbench>")
target_compile_features(todbench_options INTERFACE "$<INSTALL_INTERFACE:cxx_std_20>")
add_library(todbench_all INTERFACE)
target_link_libraries(todbench_all INTERFACE ${todbench_installed_libraries})
set_target_properties(todbench_all PROPERTIES EXPORT_NAME todbench)
set_target_properties(todbench_acquisition_core PROPERTIES EXPORT_NAME core)
foreach(library ${todbench_installed_libraries} todbench_options)
  get_target_property(named ${library} EXPORT_NAME)
  if(NOT named)
    string(REPLACE "todbench_" "" name ${library})
    set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
  endif()
endforeach()

set(todbench_package "${CMAKE_INSTALL_LIBDIR}/cmake/todbench")
install(TARGETS ${todbench_installed_libraries} todbench_options todbench_all EXPORT todbench COMPONENT development)
install(EXPORT todbench NAMESPACE todbench:: FILE todbench-targets.cmake DESTINATION "${todbench_package}" COMPONENT development)
foreach(folder acquisition/core hvs tod sim_devices)
  install(DIRECTORY "${folder}/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/todbench/${folder}" COMPONENT development
    FILES_MATCHING PATTERN "*.h" PATTERN lab EXCLUDE PATTERN observers EXCLUDE PATTERN sensors EXCLUDE)
endforeach()

add_custom_target(package_libraries DEPENDS ${todbench_installed_libraries})

include(CMakePackageConfigHelpers)
set(generated "${CMAKE_BINARY_DIR}/package")
write_basic_package_version_file("${generated}/todbench-config-version.cmake" COMPATIBILITY SameMinorVersion)
configure_file(.cmake/todbench-config.cmake.in "${generated}/todbench-config.cmake" @ONLY)
install(FILES "${generated}/todbench-config.cmake" "${generated}/todbench-config-version.cmake" .cmake/TodbenchFindOpenCv.cmake
  DESTINATION "${todbench_package}" COMPONENT development)

# pkg-config knows where its file lies, so the folder may be moved.
set(TODBENCH_PC_LIBRARIES "")
foreach(library ${todbench_installed_libraries})
  get_target_property(type ${library} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    string(APPEND TODBENCH_PC_LIBRARIES " -l${library}")
  endif()
endforeach()
string(STRIP "${TODBENCH_PC_LIBRARIES}" TODBENCH_PC_LIBRARIES)
file(RELATIVE_PATH TODBENCH_PC_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
set(TODBENCH_PC_PREFIX "\${pcfiledir}/${TODBENCH_PC_PREFIX}")
configure_file(.cmake/todbench.pc.in "${generated}/todbench.pc" @ONLY)
install(FILES "${generated}/todbench.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT development)
