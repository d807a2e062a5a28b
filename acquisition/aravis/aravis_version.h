// SPDX-License-Identifier: GPL-3.0-or-later
// Version of the loaded Aravis library, which may differ from the version at build time, and its known faults.
#pragma once

#include <string>
#include <vector>

namespace todbench {

/// A version of Aravis, ordered.
struct AravisVersion {
  unsigned major = 0, minor = 0, micro = 0;
  auto operator<=>(const AravisVersion&) const = default;  // NOLINT(modernize-use-nullptr): in generated code
};
[[nodiscard]] std::string to_string(const AravisVersion& version);

/// Returns the version of the loaded library.
[[nodiscard]] AravisVersion running_aravis();

/// Returns the faults of a version that concern thermal cameras, one sentence each. Source: release notes of Aravis.
[[nodiscard]] std::vector<std::string> aravis_faults(const AravisVersion& version);

}  // namespace todbench
