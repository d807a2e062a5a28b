// Drawings as SVG text; the same drawing gives the same text.
#pragma once

#include <span>
#include <string>

#include "bench/report/drawing.h"
#include "bench/report/markup.h"

namespace todbench {

/// One <svg> element for a page that has drawing_style().
[[nodiscard]] Markup svg_element(const Drawing& drawing);

/// CSS of all drawings of a page: light, dark by the reader's preference, always light on paper.
[[nodiscard]] std::string drawing_style();

/// A file of its own with its style inside, for any viewer: the drawings one below the other, in light shades.
[[nodiscard]] std::string svg_document(std::span<const Drawing> drawings);

}  // namespace todbench
