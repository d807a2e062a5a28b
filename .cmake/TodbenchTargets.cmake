# One function for every library of the project, so that warnings, sanitizers and include roots are the same everywhere.

add_library(todbench_options INTERFACE)
target_include_directories(todbench_options INTERFACE "${CMAKE_SOURCE_DIR}")
# -ffp-contract=off: the same sums on every compiler and instruction set, so that results repeat bit for bit.
target_compile_options(todbench_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wunused
  -ffp-contract=off $<$<CXX_COMPILER_ID:Clang>:-ffp-exception-behavior=maytrap;-Wno-overriding-t-option> $<$<BOOL:${TODBENCH_WERROR}>:-Werror>)
if(TODBENCH_SANITIZE)
  target_compile_options(todbench_options INTERFACE -fsanitize=${TODBENCH_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all
    # GCC: "the sanitizers may cause false positives of -Wmaybe-uninitialized"; release builds have the warning.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(todbench_options INTERFACE -fsanitize=${TODBENCH_SANITIZE})
  target_compile_definitions(todbench_options INTERFACE TODBENCH_SANITIZED)
endif()

# todbench_library(NAME SOURCES ... DEPENDS ...): a static library whose headers are included from the repository root.
function(todbench_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC todbench_options ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS})
endfunction()

# todbench_test(NAME SOURCES ... DEPENDS ... [LABELS ...] [TIMEOUT s]): one GoogleTest program, its cases listed by ctest.
function(todbench_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;DEPENDS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} todbench_source_file GTest::gmock_main)
  # Compiling assertions costs more than running them.
  target_compile_options(${name} PRIVATE -O1)
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
