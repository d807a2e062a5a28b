// SPDX-License-Identifier: GPL-3.0-or-later
// Style sheet of the pages.
#pragma once

#include <string>
#include <string_view>

namespace todbench {

/// Returns the CSS for everything except drawings; `page_label` and the page number are in the footer of every printed
/// page.
[[nodiscard]] std::string page_style(std::string_view page_label);

}  // namespace todbench
