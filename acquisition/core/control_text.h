// Numbers as the text of a camera's control.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace todbench {

/// The number that the whole text is; nothing for anything else, and for what is not finite.
[[nodiscard]] std::optional<double> control_number(std::string_view text);
/// The shortest text from which control_number() makes the same number again.
[[nodiscard]] std::string control_text(double value);

}  // namespace todbench
