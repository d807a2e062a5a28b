// Zipped descriptions.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "acquisition/core/result.h"

namespace todbench {

/// The first file of a ZIP archive, as the client unpacks it: stored or deflated, and stated by the central directory.
/// At most `most_bytes`, whatever the archive says. `not_found` where anything in it points outside, where it states
/// another size than it has, or where it is larger.
[[nodiscard]] Result<std::string> unzip_description(std::span<const std::uint8_t> archive, std::size_t most_bytes);

}  // namespace todbench
