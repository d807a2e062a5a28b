// SPDX-License-Identifier: GPL-3.0-or-later
// Object parameters of radiometric cameras (emissivity, distance, ...): the parameters change the temperatures that the
// counts represent. Data and pure functions; no camera library.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

namespace todbench {

/// Features that contain a camera's assumptions about object, atmosphere, window and optics, for all families. Sources:
/// FLIR_A35.xml of areaDetector/ADGenICam, FLIR's node lists of A3xx ... A700; the other names follow the style of SFNC
/// and come from camera makers. docs/reference/cameras.md lists the features of each family.
[[nodiscard]] std::span<const char* const> object_parameters();

/// Returns a warning that names the settings under which the camera does not assume a black body that it views
/// directly. The contrast that the camera reports is then larger than the observed contrast. Empty if all settings are
/// neutral or absent.
[[nodiscard]] std::vector<std::string> object_parameter_notes(const std::map<std::string, std::string>& settings);

}  // namespace todbench
