// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of a document of the report to the text of QTextDocument.
#pragma once

#include <QTextDocument>

#include "bench/gui/presenters/drawing_text_object.h"
#include "bench/report/document.h"

namespace todbench {

/// Writes `document` into `text`, which must be empty and whose layout paints figures with `drawings`. All are used
/// only during the call.
void write_text(QTextDocument& text, DrawingTextObject& drawings, const Document& document);

}  // namespace todbench
