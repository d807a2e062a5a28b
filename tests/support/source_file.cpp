// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/source_file.h"

namespace todbench {

std::string source_file(std::string_view relative) {
  return std::string(TODBENCH_SOURCE_DIR "/").append(relative);
}

}  // namespace todbench
