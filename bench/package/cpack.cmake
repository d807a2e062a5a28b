# The Debian packages: names, what they need, what they say of themselves.
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
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "test bench for thermal cameras, judged by a model observer
Measures how well a thermal camera lets an observer see: the TOD
(triangle orientation discrimination) curve, the 75 % acuity over
thermal contrast, with intervals. It does the same with a simulated
sensor, compares the two and writes the acceptance report. GigE Vision,
USB3 Vision, V4L2 and Seek cameras, recordings, and an emulated
laboratory that needs no hardware.")

set(CPACK_DEBIAN_WINDOW_PACKAGE_NAME todbench-gui)
set(CPACK_DEBIAN_WINDOW_PACKAGE_SECTION science)
set(CPACK_DEBIAN_WINDOW_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_WINDOW_PACKAGE_DEPENDS "todbench ${same_version}")
set(CPACK_DEBIAN_WINDOW_PACKAGE_RECOMMENDS fonts-dejavu-core)
set(CPACK_DEBIAN_WINDOW_DESCRIPTION "test bench for thermal cameras, as a window
The bench of todbench as a window: the camera's live picture, alignment
of the plate, the plan as a form, curves that grow while a camera is
measured, a human observer beside the model, and the report of every
session.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtodbench-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libopencv-core-dev, libopencv-imgproc-dev, libfftw3-dev, libeigen3-dev, libboost-math-dev, libexpected-dev, libfmt-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "cmake, pkg-config")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS todbench-doc)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "observer, TOD and simulated sensors of todbench as libraries
Headers and static libraries of todbench below the bench: frame sources,
the model observer, plates, registration, psychometric fits, TOD curves,
comparison, and simulated sensors. With a package for CMake and one for
pkg-config. Needs neither Qt nor a library of cameras.")

set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_NAME todbench-doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCUMENTATION_DESCRIPTION "method, formats and examples of todbench
The pages of todbench: how it measures, its models of observer and
sensor, its uncertainties, the files of a session, cameras and
troubleshooting; programs and plans as examples.")

include(CPack)
