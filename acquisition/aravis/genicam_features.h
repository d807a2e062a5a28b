// Camera features by name, values as text. Private to the Aravis back end.
#pragma once

#include <string>
#include <vector>

#include "acquisition/aravis/glib_ptr.h"

namespace todbench {

/// True when the camera describes and implements `name`.
[[nodiscard]] bool has_feature(ArvDevice* device, const std::string& name);

/// The value of an integer, float, enumeration, boolean or string feature. Floats are written so that they read back
/// exactly. Errors: `invalid_input` (no such feature, a command, write-only), `disconnected`.
[[nodiscard]] Result<std::string> get_feature(ArvDevice* device, const std::string& name);

/// Writes a feature; a command is executed whatever the value. Checks number syntax, bounds and enumeration entries
/// before anything is sent. Errors: `invalid_input` with the permitted values named, `disconnected`.
[[nodiscard]] Result<void> set_feature(ArvDevice* device, const std::string& name, const std::string& value);

/// A numeric feature; `invalid_input` when it is not a number.
[[nodiscard]] Result<double> get_number(ArvDevice* device, const std::string& name);

/// Entries of an enumeration that can be chosen now; empty when there is no such enumeration.
[[nodiscard]] std::vector<std::string> enumeration_entries(ArvDevice* device, const std::string& name);

/// Names of all commands and of all enumerations in the camera's feature tree.
[[nodiscard]] std::vector<std::string> command_names(ArvDevice* device);
[[nodiscard]] std::vector<std::string> enumeration_names(ArvDevice* device);

}  // namespace todbench
