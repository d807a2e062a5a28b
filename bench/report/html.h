// SPDX-License-Identifier: GPL-3.0-or-later
// Document as a page: HTML 5 that is also well-formed XML, with inline style and figures, without scripts and external
// resources.
#pragma once

#include <string>

#include "bench/report/document.h"

namespace todbench {

/// Returns the page. Every text is escaped; invalid UTF-8 becomes U+FFFD. A pure function.
[[nodiscard]] std::string render_html(const Document& document);

}  // namespace todbench
