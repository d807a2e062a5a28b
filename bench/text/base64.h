// SPDX-License-Identifier: GPL-3.0-or-later
// Base64 (RFC 4648).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace todbench {

/// Encodes with padding.
[[nodiscard]] std::string base64(std::string_view bytes);
/// Returns whether the text can be a result of base64(): letters, digits, + and /, padding only at the end.
[[nodiscard]] bool is_base64(std::string_view text);
/// Decodes a result of base64(); empty for any other text.
[[nodiscard]] std::optional<std::string> from_base64(std::string_view text);

}  // namespace todbench
