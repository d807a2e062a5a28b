// SPDX-License-Identifier: GPL-3.0-or-later
// Version of the program.
#pragma once

#include <string_view>

namespace todbench {

/// Version, commit and compiler of the program.
struct BuildInfo {
  std::string_view version;  ///< version of the project, e.g. "0.1.0"
  /// Commit of the sources, with "-modified" if the tree differed from the commit; "unknown" outside a repository.
  std::string_view commit;
  std::string_view compiler;
};

/// Returns the values that the build generated.
[[nodiscard]] BuildInfo build_info();

}  // namespace todbench
