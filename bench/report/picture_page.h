// SPDX-License-Identifier: GPL-3.0-or-later
// Pages that combine a document with pictures of cameras.
#pragma once

#include <span>
#include <string>

#include "bench/report/document.h"

namespace todbench {

/// Picture with its pixels drawn as squares, three in a row if there is room.
struct PagePicture {
  std::string title, caption;
  std::string png;  ///< bytes of a PNG file
};

/// Position of the pictures relative to the other sections.
enum class PicturePlace { first, last };

/// Returns render_html() of the document with a section of pictures before or after its other sections. The pictures
/// are embedded; there are no external resources.
[[nodiscard]] std::string page_with_pictures(const Document& document, std::string_view title,
                                             std::span<const PagePicture> pictures, PicturePlace place);

}  // namespace todbench
