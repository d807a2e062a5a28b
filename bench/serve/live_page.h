// SPDX-License-Identifier: GPL-3.0-or-later
// Files of the live page, without external resources.
#pragma once

#include <string_view>

namespace todbench {

/// Return the page, its style and its script. The page refers to live.css, live.js, curve.svg, picture.png and
/// state.json in the same folder.
[[nodiscard]] std::string_view live_html();
[[nodiscard]] std::string_view live_css();
[[nodiscard]] std::string_view live_js();

}  // namespace todbench
