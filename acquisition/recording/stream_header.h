// The header of a recording as JSON text.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/recording/frame_stream.h"

namespace todbench {

[[nodiscard]] std::string stream_header_text(const StreamHeader& header);
/// `invalid_input` naming the key. Numbers are exactly as they were written.
[[nodiscard]] Result<StreamHeader> parse_stream_header(std::string_view text);

}  // namespace todbench
