// SPDX-License-Identifier: GPL-3.0-or-later
// Text of the error of a failed system call.
#pragma once

#include <cerrno>
#include <string>
#include <system_error>

namespace todbench {

/// Returns the text of errno. Call it directly after the failed call: any call in between may change errno.
[[nodiscard]] inline std::string system_reason() {
  return std::generic_category().message(errno);
}

}  // namespace todbench
