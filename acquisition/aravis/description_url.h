// Where a GigE Vision camera says that its GenICam description is.
#pragma once

#include <cstdint>
#include <string_view>

#include "acquisition/core/result.h"

namespace todbench {

/// Largest description that is read from a camera. Those of real cameras have 20 kB ... 3 MB; the client reserves as
/// much as the camera states before it has read a byte.
inline constexpr std::uint64_t most_description_bytes = 16U << 20U;

/// Refuses a URL ("Local:camera.xml;5C000;8A3", numbers hexadecimal) that states more than that, states nothing that
/// can be read, or would have this host fetch the description from somewhere else than the camera or a file.
/// `not_found` with the reason.
[[nodiscard]] Result<void> check_description_url(std::string_view url);

}  // namespace todbench
