# SPDX-License-Identifier: GPL-3.0-or-later
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
  # GCC looks for what it no longer needs once it has that much, in KiB: a unit of the report takes 12.2 s instead of 13.8 with 1 GiB.
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1048576>
  # GCC 12 takes appending to a std::string for overlapping memory (its bug 105651, mended in 13).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<CXX_COMPILER_ID:Clang>:-ffp-exception-behavior=maytrap;-Wno-overriding-t-option> $<$<BOOL:${TODBENCH_WERROR}>:-Werror>)
# The undefined-behaviour checks are of the product's own sources: in those of the tests (property TODBENCH_TESTS) they would take as long to
# compile as everything else together.
define_property(TARGET PROPERTY TODBENCH_TESTS)
set(of_product "$<NOT:$<BOOL:$<TARGET_PROPERTY:TODBENCH_TESTS>>>")
string(REPLACE "," ";" sanitizers "${TODBENCH_SANITIZE}")
foreach(sanitizer ${sanitizers})
  target_link_options(todbench_options INTERFACE -fsanitize=${sanitizer})
  if(sanitizer STREQUAL "undefined")
    # A null pointer and the end of an object are found by the address sanitizer; asked at every access they take a third of the compilation.
    target_compile_options(todbench_options INTERFACE
      "$<${of_product}:-fsanitize=undefined;-fno-sanitize=null;-fno-sanitize=object-size>")
  else()
    target_compile_options(todbench_options INTERFACE -fsanitize=${sanitizer})
  endif()
endforeach()
if(TODBENCH_SANITIZE)
  target_compile_options(todbench_options INTERFACE -fno-omit-frame-pointer -fno-sanitize-recover=all
    # GCC: "the sanitizers may cause false positives of -Wmaybe-uninitialized".
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_compile_definitions(todbench_options INTERFACE TODBENCH_SANITIZED)
endif()

# Headers of other projects that most sources include are compiled once for each set of flags. Every header of this project still says
# what it needs: tests/layering compiles them alone. Clang wants the same macros everywhere, which targets here do not have.
option(TODBENCH_PRECOMPILE "Compile the headers of other projects once" ON)
if(TODBENCH_PRECOMPILE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 warns about the inside of std::string when its header comes precompiled.
  target_compile_options(todbench_options INTERFACE -fpch-preprocess -Wno-array-bounds -Wno-stringop-overflow
    -Wno-stringop-overread)
else()
  set(TODBENCH_PRECOMPILE OFF)
endif()
set(todbench_standard_headers
  <algorithm> <array> <atomic> <chrono> <cmath> <complex> <condition_variable> <cstdint> <deque> <filesystem> <fstream> <functional>
  <map> <memory> <mutex> <numeric> <optional> <random> <set> <span> <sstream> <stop_token> <string> <string_view> <thread> <variant>
  <vector> <opencv2/core.hpp> <tl/expected.hpp>)

# todbench_precompiled_headers(KIND [TESTS] [HEADERS ...] [DEPENDS ...] [OPTIONS ...]): a set of headers that targets of one kind share, with
# the options that all of them are compiled with. TESTS: the targets are test programs.
function(todbench_precompiled_headers kind)
  cmake_parse_arguments(ARG "TESTS" "" "HEADERS;DEPENDS;OPTIONS" ${ARGN})
  set_property(GLOBAL PROPERTY todbench_options_of_${kind} "${ARG_OPTIONS}")
  set_property(GLOBAL PROPERTY todbench_tests_${kind} "${ARG_TESTS}")
  if(NOT TODBENCH_PRECOMPILE)
    return()
  endif()
  set(source "${CMAKE_BINARY_DIR}/precompiled_${kind}.cpp")
  file(CONFIGURE OUTPUT "${source}" CONTENT "" @ONLY)
  add_library(todbench_precompiled_${kind} OBJECT "${source}")
  target_link_libraries(todbench_precompiled_${kind} PRIVATE todbench_options opencv_core tl::expected Threads::Threads ${ARG_DEPENDS})
  target_compile_options(todbench_precompiled_${kind} PRIVATE ${ARG_OPTIONS})
  set_target_properties(todbench_precompiled_${kind} PROPERTIES TODBENCH_TESTS "${ARG_TESTS}")
  target_precompile_headers(todbench_precompiled_${kind} PRIVATE ${todbench_standard_headers} ${ARG_HEADERS})
endfunction()

function(todbench_precompile target kind)
  get_property(options GLOBAL PROPERTY todbench_options_of_${kind})
  target_compile_options(${target} PRIVATE ${options})
  get_property(tests GLOBAL PROPERTY todbench_tests_${kind})
  set_target_properties(${target} PROPERTIES TODBENCH_TESTS "${tests}")
  if(TARGET todbench_precompiled_${kind})
    target_precompile_headers(${target} REUSE_FROM todbench_precompiled_${kind})
  endif()
endfunction()

# Sources of a library compiled together share what their headers cost. Two functions of one name in such a library do not compile; a source
# that must keep its names is named APART.
option(TODBENCH_UNITY "Compile the sources of every library together" ON)
set(TODBENCH_UNITY_BATCH 40 CACHE STRING "So many sources at a time: more are cheaper altogether, and dearer when one of them changes")
option(TODBENCH_UNITY_TESTS "Compile the sources of every test program together" ON)
# A local name is not to be compared with those of another source, a source is not a header because another includes it, and GCC 12 takes
# the inside of an empty std::optional for a value.
set(together "$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>")
target_compile_options(todbench_options INTERFACE "$<${together}:-Wno-shadow>"
  "$<$<AND:${together},$<CXX_COMPILER_ID:GNU>>:-Wshadow=local;-Wno-subobject-linkage;-Wno-maybe-uninitialized>")

# What libraries and programs of the product have in common.
function(todbench_product target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${TODBENCH_UNITY} UNITY_BUILD_BATCH_SIZE ${TODBENCH_UNITY_BATCH})
  # Bytes from outside are read as numbers in acquisition/ and sim_devices/; in tod/ and bench/ the check of alignment is left out.
  if(TODBENCH_SANITIZE MATCHES "undefined" AND CMAKE_CURRENT_SOURCE_DIR MATCHES "^${CMAKE_SOURCE_DIR}/(tod|bench)(/|$)")
    target_compile_options(${target} PRIVATE -fno-sanitize=alignment)
  endif()
endfunction()

# todbench_library(NAME SOURCES ... DEPENDS ... [APART ...] [PRECOMPILED KIND]): a static library whose headers are included from the
# repository root.
function(todbench_library name)
  cmake_parse_arguments(ARG "" "PRECOMPILED" "SOURCES;DEPENDS;PRIVATE_DEPENDS;APART" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC todbench_options ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS})
  if(NOT ARG_PRECOMPILED)
    set(ARG_PRECOMPILED core)
  endif()
  todbench_precompile(${name} ${ARG_PRECOMPILED})
  todbench_product(${name})
  set(generated ${ARG_SOURCES})
  list(FILTER generated INCLUDE REGEX "^${CMAKE_BINARY_DIR}/")
  foreach(source ${ARG_APART} ${generated})
    set_source_files_properties("${source}" PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endforeach()
endfunction()

# Patience of a test whose program is a process of ctest: a hang ends it, a busy machine does not.
set(todbench_hang_s 1800)

# todbench_test(NAME SOURCES ... DEPENDS ... [LABELS ...] [SANITIZERS address thread [UNSANITIZED ...]] [SHARDS n | EACH_CASE] [COST s]
# [TIMED] [APART ...] [PRECOMPILED KIND]): one GoogleTest program.
#   LABELS      of its tests for ctest (science: no camera library; foreign: reads bytes from outside; threads: threads of cameras and
#               instruments; study: a long form). The target todbench_tests_LABEL builds the programs with that label
#   SANITIZERS  a build with a sanitizer has only the programs that name it
#   UNSANITIZED cases, as --gtest_filter names them, that such a build leaves out: long loops over numbers whose code shorter cases of the
#               same program run through as well
#   SHARDS      ctest runs the program as so many processes with a part of the cases each; one when nothing is said: starting a process
#               costs more than most cases do
#   EACH_CASE   ctest runs every case in a process of its own: for programs whose cases take seconds
#   COST        seconds of the whole program; ctest begins with the longest, so that none runs alone at the end
#   TIMED       its cases run against real time: ctest runs at most one other program beside it
function(todbench_test name)
  cmake_parse_arguments(ARG "EACH_CASE;TIMED" "COST;SHARDS;PRECOMPILED" "SOURCES;DEPENDS;LABELS;SANITIZERS;UNSANITIZED;APART" ${ARGN})
  foreach(sanitizer address thread)
    if(TODBENCH_SANITIZE MATCHES "${sanitizer}" AND NOT "${sanitizer}" IN_LIST ARG_SANITIZERS)
      return()
    endif()
  endforeach()
  add_executable(${name} ${ARG_SOURCES})
  # A library of test support (todbench_..._test_support) brings a main() of its own; beside another, the linker would take either.
  set(main GTest::gmock_main)
  if(ARG_DEPENDS MATCHES "_test_support")
    set(main GTest::gmock)
  endif()
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} todbench_patience todbench_source_file ${main})
  if(NOT ARG_PRECOMPILED)
    set(ARG_PRECOMPILED tests)
  endif()
  todbench_precompile(${name} ${ARG_PRECOMPILED})
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${TODBENCH_UNITY_TESTS} UNITY_BUILD_BATCH_SIZE 12)
  set_source_files_properties(${ARG_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  # The target "all" does not contain the long forms. "./run study" builds them.
  if("study" IN_LIST ARG_LABELS)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
  else()
    add_dependencies(todbench_tests ${name})
  endif()
  foreach(label ${ARG_LABELS})
    if(NOT TARGET todbench_tests_${label})
      add_custom_target(todbench_tests_${label})
    endif()
    add_dependencies(todbench_tests_${label} ${name})
  endforeach()
  set(environment GTEST_BRIEF=1)
  if(TODBENCH_SANITIZE MATCHES "thread")
    list(APPEND environment "TSAN_OPTIONS=suppressions=${CMAKE_SOURCE_DIR}/tests/tsan_suppressions.txt")
  endif()
  if(TODBENCH_SANITIZE AND ARG_UNSANITIZED)
    list(JOIN ARG_UNSANITIZED ":" left_out)
    list(APPEND environment "GTEST_FILTER=-${left_out}")
  endif()
  if(NOT ARG_COST)
    set(ARG_COST 1)
  endif()
  if(NOT ARG_SHARDS)
    set(ARG_SHARDS 1)
  endif()
  if(ARG_EACH_CASE)
    include(GoogleTest)
    gtest_discover_tests(${name} DISCOVERY_TIMEOUT 600
      PROPERTIES TIMEOUT ${todbench_hang_s} COST ${ARG_COST} ENVIRONMENT "${environment}" LABELS "${ARG_LABELS}")
    return()
  endif()
  math(EXPR last "${ARG_SHARDS} - 1")
  math(EXPR cost "${ARG_COST} / ${ARG_SHARDS}")
  foreach(shard RANGE ${last})
    set(test ${name})
    if(ARG_SHARDS GREATER 1)
      set(test ${name}.${shard})
    endif()
    add_test(NAME ${test} COMMAND ${name})
    set_tests_properties(${test} PROPERTIES TIMEOUT ${todbench_hang_s} COST ${cost} LABELS "${ARG_LABELS}"
      ENVIRONMENT "${environment};GTEST_TOTAL_SHARDS=${ARG_SHARDS};GTEST_SHARD_INDEX=${shard}")
    if(ARG_TIMED)
      # Three of the four programs that the presets run at a time.
      set_tests_properties(${test} PROPERTIES PROCESSORS 3)
    endif()
  endforeach()
endfunction()
