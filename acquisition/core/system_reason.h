// What the system says about a call that failed.
#pragma once

#include <cerrno>
#include <string>
#include <system_error>

namespace todbench {

/// The text of errno. The first thing after the call: whatever comes between may change errno.
[[nodiscard]] inline std::string system_reason() {
  return std::generic_category().message(errno);
}

}  // namespace todbench
