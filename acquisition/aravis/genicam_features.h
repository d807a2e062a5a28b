// SPDX-License-Identifier: GPL-3.0-or-later
// Camera features by name, values as text. Private to the Aravis back end.
#pragma once

#include <string>
#include <vector>

#include "acquisition/aravis/glib_ptr.h"

namespace todbench {

/// Returns whether the camera describes and implements `name`.
[[nodiscard]] bool has_feature(ArvDevice* device, const std::string& name);

/// Returns the value of an integer, float, enumeration, boolean or string feature. The text of a float reads back
/// exactly. Errors: `invalid_input` (no such feature, a command, write-only), `disconnected`.
[[nodiscard]] Result<std::string> get_feature(ArvDevice* device, const std::string& name);

/// Writes a feature; a command is executed regardless of the value. Number syntax, bounds and enumeration entries are
/// checked before anything is sent. Errors: `invalid_input` with the permitted values, `disconnected`.
[[nodiscard]] Result<void> set_feature(ArvDevice* device, const std::string& name, const std::string& value);

/// Returns the value of a numeric feature. Errors as get_feature(), and `invalid_input` if the value is not a number.
[[nodiscard]] Result<double> get_number(ArvDevice* device, const std::string& name);

/// Returns the entries of an enumeration that are available now; empty if there is no such enumeration.
[[nodiscard]] std::vector<std::string> enumeration_entries(ArvDevice* device, const std::string& name);

/// Return the names of all commands and of all enumerations in the camera's feature tree.
[[nodiscard]] std::vector<std::string> command_names(ArvDevice* device);
[[nodiscard]] std::vector<std::string> enumeration_names(ArvDevice* device);

}  // namespace todbench
