// SPDX-License-Identifier: GPL-3.0-or-later
// Header of a recording as JSON text.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/recording/frame_stream.h"

namespace todbench {

/// Writes a header.
[[nodiscard]] std::string stream_header_text(const StreamHeader& header);
/// Parses a header. Error: `invalid_input` with the key. Numbers read back exactly as written.
[[nodiscard]] Result<StreamHeader> parse_stream_header(std::string_view text);

}  // namespace todbench
