// Bytes as text (RFC 4648).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace todbench {

/// With padding.
[[nodiscard]] std::string base64(std::string_view bytes);
/// Letters, digits, + and /, with padding at the end only: what base64() can have made.
[[nodiscard]] bool is_base64(std::string_view text);
/// The bytes of what base64() made; nothing for any other text.
[[nodiscard]] std::optional<std::string> from_base64(std::string_view text);

}  // namespace todbench
