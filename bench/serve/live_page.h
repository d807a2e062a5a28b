// The files of the live page. They ask for nothing from elsewhere.
#pragma once

#include <string_view>

namespace todbench {

/// The page; it names live.css, live.js, curve.svg, picture.png and state.json beside it.
[[nodiscard]] std::string_view live_html();
[[nodiscard]] std::string_view live_css();
[[nodiscard]] std::string_view live_js();

}  // namespace todbench
