// SPDX-License-Identifier: GPL-3.0-or-later
// Zipped descriptions.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "acquisition/base/result.h"

namespace todbench {

/// Unpacks the only file of a ZIP archive in the same way as the client: stored or deflated, located by the central
/// directory. Returns at most `most_bytes` regardless of the stated size. Error: `not_found` if the archive is damaged,
/// has more than one file, differs from its stated size, or is larger.
[[nodiscard]] Result<std::string> unzip_description(std::span<const std::uint8_t> archive, std::size_t most_bytes);

}  // namespace todbench
