# SPDX-License-Identifier: GPL-3.0-or-later
# Debian packages: names, dependencies and descriptions.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME todbench)
set(CPACK_PACKAGE_VENDOR todbench)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_BINARY_DIR}/packages")
set(CPACK_OUTPUT_FILE_PREFIX "${CMAKE_BINARY_DIR}/packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development documentation)
if(TODBENCH_WITH_GUI)
  list(APPEND CPACK_COMPONENTS_ALL window)
endif()
if(TODBENCH_WITH_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${TODBENCH_DEBIAN_REVISION})
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${TODBENCH_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(same_version "(= ${PROJECT_VERSION}-${TODBENCH_DEBIAN_REVISION})")

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME todbench)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS bash-completion)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "todbench-gui, todbench-doc, python3-numpy, openssl, minisign")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "test bench for thermal cameras with a model observer
Measures how well a thermal camera lets an observer see: the TOD
(triangle orientation discrimination) curve, that is the 75 % acuity
over thermal contrast, with 95 % intervals. The program takes the same
test with a simulated sensor, compares both curves and writes an
acceptance report. It supports GigE Vision, USB3 Vision, V4L2 and Seek
cameras, recordings, and an emulated laboratory without hardware.")

set(CPACK_DEBIAN_WINDOW_PACKAGE_NAME todbench-gui)
set(CPACK_DEBIAN_WINDOW_PACKAGE_SECTION science)
set(CPACK_DEBIAN_WINDOW_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_WINDOW_PACKAGE_DEPENDS "todbench ${same_version}")
set(CPACK_DEBIAN_WINDOW_PACKAGE_RECOMMENDS fonts-dejavu-core)
set(CPACK_DEBIAN_WINDOW_DESCRIPTION "test bench for thermal cameras, graphical interface
The graphical interface of todbench. It shows the live picture of the
camera, guides the alignment of the plate, edits the plan as a form,
draws the curves during the measurement, runs the test with a human
observer, and shows the report of each session.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtodbench-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libopencv-core-dev, libopencv-imgproc-dev, libfftw3-dev, libeigen3-dev, libboost-math-dev, libexpected-dev, libfmt-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "cmake, pkg-config")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS todbench-doc)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "observer, TOD and simulated sensors of todbench as libraries
Headers and static libraries of todbench: frame sources, model observer,
plates, registration, psychometric fits, TOD curves, comparison, and
simulated sensors. Files for CMake and pkg-config are included. The
libraries need neither Qt nor a camera library.")

set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_NAME todbench-doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCUMENTATION_DESCRIPTION "method, formats and examples of todbench
Documents of todbench: method of measurement, models of observer and
sensor, uncertainties, files of a session, cameras and troubleshooting.
Example programs and example plans are included.")

if(TODBENCH_WITH_PYTHON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-todbench)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  # The module is for one minor version of the interpreter.
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}~), python3 (<< ${Python_VERSION_MAJOR}.${next_minor}), python3-numpy")
  # Compiled files of the interpreter come and go with the package.
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${CMAKE_CURRENT_LIST_DIR}/python/postinst;${CMAKE_CURRENT_LIST_DIR}/python/prerm")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "todbench, todbench-doc, python3-matplotlib")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "test bench for thermal cameras, Python module
The Python module todbench: model observers, simulated sensors, plates,
registration, psychometric fits, comparison of curves, physical measures,
uncertainty budgets, plans, runs, sessions, and the frames of cameras and
recordings as numpy arrays. The numbers are those of the program.")
endif()

include(CPack)
