// What a page must not show: an error, a plot or picture without content, text that is cut off.
#pragma once

#include <QString>
#include <QStringList>

class QWidget;

namespace todbench {

/// A sentence for every fault of the visible parts below `page`, with the part's object name; empty: none. Only what is
/// on the page counts: what has to be scrolled to is not looked at.
[[nodiscard]] QStringList faults_of(const QWidget& page);

}  // namespace todbench
