# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -D SOURCE_DIR=... -D OUTPUT=... -P EmbedResources.cmake
# Writes the C++ source that holds every shipped plate, sensor, observer, plan and table of the air.

set(content "#include <array>\n\n#include \"bench/plan/resources.h\"\n\nnamespace todbench {\n\nnamespace {\n\n")
set(rows "")
set(count 0)
foreach(entry "plate:tod/plate" "sensor:sim_devices/sensors" "observer:hvs/observers" "plan:bench/plans"
        "atmosphere:sim_devices/atmosphere:json" "scene:sim_devices/scenes" "target:sim_devices/targets"
        "target_set:sim_devices/target_sets" "black_body:tod/instruments/black_bodies"
        "stage:tod/instruments/stages")
  string(REPLACE ":" ";" entry "${entry}")
  list(GET entry 0 kind)
  list(GET entry 1 folder)
  set(ending toml)
  list(LENGTH entry parts)
  if(parts GREATER 2)
    list(GET entry 2 ending)
  endif()
  file(GLOB files "${SOURCE_DIR}/${folder}/*.${ending}")
  list(SORT files)
  foreach(file IN LISTS files)
    get_filename_component(name "${file}" NAME_WLE)
    # Semicolons and brackets would be taken for list syntax of CMake: read as hexadecimal, write as an array of characters.
    file(READ "${file}" bytes HEX)
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
    string(APPEND content "constexpr char text_${count}[] = {${bytes}'\\0'};\n")
    string(APPEND rows "    EmbeddedResource{ResourceKind::${kind}, \"${name}\", {text_${count}, sizeof text_${count} - 1}},\n")
    math(EXPR count "${count} + 1")
  endforeach()
endforeach()
string(APPEND content "\nconstexpr std::array<EmbeddedResource, ${count}> resources{\n${rows}};\n\n}  // namespace\n\n"
  "std::span<const EmbeddedResource> embedded_resources() { return resources; }\n\n}  // namespace todbench\n")
file(WRITE "${OUTPUT}" "${content}")
