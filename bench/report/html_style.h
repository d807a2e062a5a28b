// The style sheet of the pages.
#pragma once

#include <string>
#include <string_view>

namespace todbench {

/// CSS for everything but the drawings; `page_label` and the page number stand at the foot of every printed page.
[[nodiscard]] std::string page_style(std::string_view page_label);

}  // namespace todbench
