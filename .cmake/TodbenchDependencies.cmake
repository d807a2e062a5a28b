# Every third-party package, found once. Debian 12 names; nothing is downloaded at configure time.

find_package(PkgConfig REQUIRED)

# Debian splits OpenCV and puts OpenCVConfig.cmake only into the large package: link the three parts by name.
find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(part core imgproc imgcodecs calib3d)
  find_library(OPENCV_${part}_LIBRARY opencv_${part} REQUIRED)
  add_library(opencv_${part} INTERFACE)
  target_include_directories(opencv_${part} SYSTEM INTERFACE "${OPENCV_INCLUDE_DIR}")
  target_link_libraries(opencv_${part} INTERFACE "${OPENCV_${part}_LIBRARY}")
endforeach()

pkg_check_modules(FFTW3 REQUIRED IMPORTED_TARGET fftw3)
find_package(Eigen3 3.4 REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(tl-expected REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(GTest REQUIRED)
find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)

if(TODBENCH_WITH_ARAVIS)
  pkg_check_modules(ARAVIS REQUIRED IMPORTED_TARGET aravis-0.8)
endif()
if(TODBENCH_WITH_V4L2)
  pkg_check_modules(LIBUDEV REQUIRED IMPORTED_TARGET libudev)
endif()
if(TODBENCH_WITH_USB)
  pkg_check_modules(LIBUSB REQUIRED IMPORTED_TARGET libusb-1.0)
endif()
# Emulated USB and video devices; tests of them are left out without it.
pkg_check_modules(UMOCKDEV IMPORTED_TARGET umockdev-1.0)
if(TODBENCH_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
