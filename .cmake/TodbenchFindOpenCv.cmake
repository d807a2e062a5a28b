# SPDX-License-Identifier: GPL-3.0-or-later
# Of this build and of the installed CMake package: the targets opencv_PART. Debian splits OpenCV and puts OpenCVConfig.cmake only into the
# large package, so the parts are linked by name.
function(todbench_find_opencv)
  find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
  foreach(part ${ARGN})
    if(TARGET opencv_${part})
      continue()
    endif()
    find_library(OPENCV_${part}_LIBRARY opencv_${part} REQUIRED)
    add_library(opencv_${part} INTERFACE IMPORTED GLOBAL)
    target_include_directories(opencv_${part} SYSTEM INTERFACE "${OPENCV_INCLUDE_DIR}")
    target_link_libraries(opencv_${part} INTERFACE "${OPENCV_${part}_LIBRARY}")
  endforeach()
endfunction()
