// SPDX-License-Identifier: GPL-3.0-or-later
// Version of the loaded Aravis library, which may differ from that of the build, and its known faults.
#pragma once

#include <string>
#include <vector>

namespace todbench {

/// A version of Aravis, ordered.
struct AravisVersion {
  unsigned major = 0, minor = 0, micro = 0;
  auto operator<=>(const AravisVersion&) const = default;  // NOLINT(modernize-use-nullptr): of generated code
};
[[nodiscard]] std::string to_string(const AravisVersion& version);

/// The version of the library that is loaded.
[[nodiscard]] AravisVersion running_aravis();

/// Faults of a version that concern thermal cameras, one sentence each, from the release notes of Aravis.
[[nodiscard]] std::vector<std::string> aravis_faults(const AravisVersion& version);

}  // namespace todbench
