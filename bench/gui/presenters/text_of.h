// SPDX-License-Identifier: GPL-3.0-or-later
// Converts UTF-8 text to QString.
#pragma once

#include <QString>
#include <string_view>

namespace todbench {

[[nodiscard]] inline QString text_of(std::string_view text) {
  return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}

}  // namespace todbench
