// SPDX-License-Identifier: GPL-3.0-or-later
// UTF-8 text as text of Qt.
#pragma once

#include <QString>
#include <string_view>

namespace todbench {

[[nodiscard]] inline QString text_of(std::string_view text) {
  return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}

}  // namespace todbench
