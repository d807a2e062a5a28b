// SPDX-License-Identifier: GPL-3.0-or-later
// Files of the page that starts and shows runs, without external resources.
#pragma once

#include <string_view>

namespace todbench {

/// Return the page, its style and its script. The page refers to control.css and control.js in the same folder.
[[nodiscard]] std::string_view control_html();
[[nodiscard]] std::string_view control_css();
[[nodiscard]] std::string_view control_js();

}  // namespace todbench
