# One function for every library of the project, so that warnings, sanitizers and include roots are the same everywhere.

add_library(todbench_options INTERFACE)
target_include_directories(todbench_options INTERFACE "${CMAKE_SOURCE_DIR}")
# Everywhere, because the packages of some libraries want it and precompiled headers need the same macros.
target_compile_options(todbench_options INTERFACE -pthread)
# Numbers in text, in any library.
target_link_libraries(todbench_options INTERFACE PkgConfig::FMT)
# -ffp-contract=off: the same sums on every compiler and instruction set, so that results repeat bit for bit.
target_compile_options(todbench_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wunused
  -ffp-contract=off
  # GCC 12 takes appending to a std::string for overlapping memory (its bug 105651, mended in 13).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<CXX_COMPILER_ID:Clang>:-ffp-exception-behavior=maytrap;-Wno-overriding-t-option> $<$<BOOL:${TODBENCH_WERROR}>:-Werror>)
if(TODBENCH_SANITIZE)
  target_compile_options(todbench_options INTERFACE -fsanitize=${TODBENCH_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all
    # GCC: "the sanitizers may cause false positives of -Wmaybe-uninitialized"; release builds have the warning.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(todbench_options INTERFACE -fsanitize=${TODBENCH_SANITIZE})
  target_compile_definitions(todbench_options INTERFACE TODBENCH_SANITIZED)
endif()

# Headers of other projects that most sources include are compiled once for each set of flags. Every header of this project still says
# what it needs: tests/layering compiles them alone. Clang wants the same macros everywhere, which targets here do not have.
option(TODBENCH_PRECOMPILE "Compile the headers of other projects once" ON)
if(TODBENCH_PRECOMPILE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 warns about the inside of std::string when its header comes precompiled; "science" builds without and has the warnings.
  target_compile_options(todbench_options INTERFACE -fpch-preprocess -Wno-array-bounds -Wno-stringop-overflow
    -Wno-stringop-overread)
else()
  set(TODBENCH_PRECOMPILE OFF)
endif()
set(todbench_standard_headers
  <algorithm> <array> <atomic> <chrono> <cmath> <complex> <condition_variable> <cstdint> <deque> <filesystem> <fstream> <functional>
  <map> <memory> <mutex> <numeric> <optional> <random> <set> <span> <sstream> <stop_token> <string> <string_view> <thread> <variant>
  <vector> <opencv2/core.hpp> <tl/expected.hpp>)

# todbench_precompiled_headers(KIND [HEADERS ...] [DEPENDS ...] [OPTIONS ...]): a set of headers that targets of one kind share.
function(todbench_precompiled_headers kind)
  if(NOT TODBENCH_PRECOMPILE)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "HEADERS;DEPENDS;OPTIONS" ${ARGN})
  set(source "${CMAKE_BINARY_DIR}/precompiled_${kind}.cpp")
  file(CONFIGURE OUTPUT "${source}" CONTENT "" @ONLY)
  add_library(todbench_precompiled_${kind} OBJECT "${source}")
  target_link_libraries(todbench_precompiled_${kind} PRIVATE todbench_options opencv_core tl::expected Threads::Threads ${ARG_DEPENDS})
  target_compile_options(todbench_precompiled_${kind} PRIVATE ${ARG_OPTIONS})
  target_precompile_headers(todbench_precompiled_${kind} PRIVATE ${todbench_standard_headers} ${ARG_HEADERS})
endfunction()

function(todbench_precompile target kind)
  if(TARGET todbench_precompiled_${kind})
    target_precompile_headers(${target} REUSE_FROM todbench_precompiled_${kind})
  endif()
endfunction()

# todbench_library(NAME SOURCES ... DEPENDS ... [PRECOMPILED KIND]): a static library whose headers are included from the repository root.
function(todbench_library name)
  cmake_parse_arguments(ARG "" "PRECOMPILED" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC todbench_options ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS})
  if(NOT ARG_PRECOMPILED)
    set(ARG_PRECOMPILED core)
  endif()
  todbench_precompile(${name} ${ARG_PRECOMPILED})
endfunction()

# todbench_test(NAME SOURCES ... DEPENDS ... [LABELS ...] [SANITIZERS address thread] [TIMEOUT s] [PRECOMPILED KIND]): one GoogleTest
# program, its cases listed by ctest. A build with a sanitizer has only the programs that name it.
function(todbench_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT;PRECOMPILED" "SOURCES;DEPENDS;LABELS;SANITIZERS" ${ARGN})
  foreach(sanitizer address thread)
    if(TODBENCH_SANITIZE MATCHES "${sanitizer}" AND NOT "${sanitizer}" IN_LIST ARG_SANITIZERS)
      return()
    endif()
  endforeach()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} todbench_source_file GTest::gmock_main)
  # Compiling assertions costs more than running them.
  target_compile_options(${name} PRIVATE -O1)
  if(NOT ARG_PRECOMPILED)
    set(ARG_PRECOMPILED tests)
  endif()
  todbench_precompile(${name} ${ARG_PRECOMPILED})
  add_dependencies(todbench_tests ${name})
  include(GoogleTest)
  set(environment "")
  if(TODBENCH_SANITIZE MATCHES "thread")
    set(environment ENVIRONMENT "TSAN_OPTIONS=suppressions=${CMAKE_SOURCE_DIR}/tests/tsan_suppressions.txt")
  endif()
  # Long tests begin first, so that none runs alone at the end.
  set(cost 0)
  if("slow" IN_LIST ARG_LABELS)
    set(cost 100)
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
    PROPERTIES TIMEOUT ${ARG_TIMEOUT} COST ${cost} ${environment} LABELS "${ARG_LABELS}")
endfunction()
