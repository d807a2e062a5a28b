// Pages that show pictures of cameras beside what a document says.
#pragma once

#include <span>
#include <string>

#include "bench/report/document.h"

namespace todbench {

/// Drawn with its elements as squares, three in a row where there is room.
struct PagePicture {
  std::string title, caption;
  std::string png;  ///< the bytes of a PNG file
};

enum class PicturePlace { first, last };

/// render_html() of the document with a section of pictures before its other sections, or behind them. Nothing from
/// outside: the pictures are in the page.
[[nodiscard]] std::string page_with_pictures(const Document& document, std::string_view title,
                                             std::span<const PagePicture> pictures, PicturePlace place);

}  // namespace todbench
