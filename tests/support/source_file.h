// SPDX-License-Identifier: GPL-3.0-or-later
// Files of the checkout that tests read.
#pragma once

#include <string>
#include <string_view>

namespace todbench {

/// Absolute path of a file of this checkout: "tests/golden/compilers.json". Only one source knows the folder, so that
/// compiled tests are the same in every folder and a compiler cache serves them all.
[[nodiscard]] std::string source_file(std::string_view relative);

}  // namespace todbench
