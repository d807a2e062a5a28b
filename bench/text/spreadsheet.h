// SPDX-License-Identifier: GPL-3.0-or-later
// Tables for spreadsheets.
#pragma once

#include <string>
#include <string_view>

namespace todbench {

/// Returns csv_field() of a text. A leading apostrophe is added to a text that a spreadsheet would treat as a formula.
/// This is a text that begins with = + - @ or a control character (after optional blanks) and is not a number.
[[nodiscard]] std::string spreadsheet_field(std::string_view text);

}  // namespace todbench
