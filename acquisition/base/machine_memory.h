// SPDX-License-Identifier: GPL-3.0-or-later
// Memory of this machine.
#pragma once

#include <unistd.h>

namespace todbench {

/// Returns the size of the physical memory in bytes.
[[nodiscard]] inline double machine_memory_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace todbench
