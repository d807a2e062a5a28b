// SPDX-License-Identifier: GPL-3.0-or-later
// Drawings as SVG text; equal drawings give equal text.
#pragma once

#include <span>
#include <string>

#include "bench/report/drawing.h"
#include "bench/report/markup.h"

namespace todbench {

/// Returns one <svg> element for a page that contains drawing_style().
[[nodiscard]] Markup svg_element(const Drawing& drawing);

/// Returns the CSS of all drawings of a page: light or dark according to the preference of the reader, always light on
/// paper.
[[nodiscard]] std::string drawing_style();

/// Returns a stand-alone SVG file for any viewer: the drawings one below the other, in light shades.
[[nodiscard]] std::string svg_document(std::span<const Drawing> drawings);

}  // namespace todbench
