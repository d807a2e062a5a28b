// Which program this is.
#pragma once

#include <string_view>

namespace todbench {

struct BuildInfo {
  std::string_view version;  ///< of the project, e.g. "0.1.0"
  std::string_view
      commit;  ///< of the sources, with "-modified" where the tree differed from it; "unknown" outside a repository
  std::string_view compiler;
};

/// Written by the build.
[[nodiscard]] BuildInfo build_info();

}  // namespace todbench
