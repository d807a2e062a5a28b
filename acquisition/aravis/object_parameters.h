// What a radiometric camera believes of the scene, by feature: it changes the temperatures that its counts state. Data
// and pure functions; no camera library.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

namespace todbench {

/// Features that tell what a camera takes for granted of object, atmosphere, window and optics, whatever its family.
/// Sources: FLIR_A35.xml of areaDetector/ADGenICam, FLIR's node lists of A3xx ... A700; the others by the names of SFNC
/// style that makers use. docs/cameras.md says which family has which.
[[nodiscard]] std::span<const char* const> object_parameters();

/// A sentence where, by its settings, a camera computes temperatures for anything but a black body seen through
/// nothing: a contrast that it states is then larger than the one that it sees. Empty where all is neutral or nothing
/// is said.
[[nodiscard]] std::vector<std::string> object_parameter_notes(const std::map<std::string, std::string>& settings);

}  // namespace todbench
