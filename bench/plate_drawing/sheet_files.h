// SPDX-License-Identifier: GPL-3.0-or-later
// Drawing of a plate as SVG, DXF and PDF. Equal drawings give equal bytes.
#pragma once

#include <string>

#include "bench/plate_drawing/plate_drawing.h"

namespace todbench {

/// Returns an SVG file. Its user unit is a millimetre, its origin is the origin of the drawing, and each layer is a
/// group.
[[nodiscard]] std::string sheet_svg(const PlateSheet& sheet);

/// Returns a DXF file of release 12 (AC1009) in ASCII, in millimetres, x right, y up: a POLYLINE for each line, on the
/// layers CUT and DIMENSION, and TEXT on the layer TEXT.
[[nodiscard]] std::string sheet_dxf(const PlateSheet& sheet);

/// Returns a PDF file (1.4) with one page of the size of the sheet, with lines as vectors and text in Helvetica.
[[nodiscard]] std::string sheet_pdf(const PlateSheet& sheet);

}  // namespace todbench
