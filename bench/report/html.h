// A document as a page: HTML 5 that is also well-formed XML, style and figures inside, no script, nothing from outside.
#pragma once

#include <string>

#include "bench/report/document.h"

namespace todbench {

/// A pure function. Every text is escaped; bytes that are no UTF-8 become U+FFFD.
[[nodiscard]] std::string render_html(const Document& document);

}  // namespace todbench
