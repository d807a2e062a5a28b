// SPDX-License-Identifier: GPL-3.0-or-later
// Check of a page for faults: an error, a plot or picture without content, truncated text.
#pragma once

#include <QString>
#include <QStringList>

class QWidget;

namespace todbench {

/// Returns a sentence for every fault of the visible widgets below `page`, with the widget's object name; empty: none.
/// Widgets outside the visible part of a scroll area are ignored.
[[nodiscard]] QStringList faults_of(const QWidget& page);

}  // namespace todbench
