// SPDX-License-Identifier: GPL-3.0-or-later
// History of units, without widgets: the available series, and the chart of one series.
#pragma once

#include <QObject>
#include <QString>
#include <QStringList>
#include <filesystem>
#include <optional>
#include <vector>

#include "bench/history/history_series.h"
#include "bench/report/plot.h"

namespace todbench {

/// A chart as displayed in the window.
struct HistoryChart {
  Plot values;  ///< values over days since the first, with 95 % intervals and the reference
  /// Control charts in units of the standard deviation; empty if there are too few values.
  std::optional<Plot> ewma, cusum;
  QString remark;  ///< interpretation of the charts, one sentence
};

/// Returns the chart of a series.
[[nodiscard]] HistoryChart history_chart(const HistorySeries& series);
/// Returns "acuity dT=2K", "A655sc, serial number 48000123".
[[nodiscard]] QString title_of(const HistorySeries& series);
/// Returns the unit of the values of a series.
[[nodiscard]] QString unit_of(const HistorySeries& series);

/// Presenter that reads the index on request. Used in the window's thread.
class HistoryPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit HistoryPresenter(std::filesystem::path index, QObject* parent = nullptr);

  /// Searches a folder and its subfolders, adds the sessions of cameras, and reads the index again.
  void add_sessions(const std::filesystem::path& folder);
  /// Reads the index again; changed() follows.
  void refresh();
  /// Returns the series of the index.
  [[nodiscard]] const std::vector<HistorySeries>& series() const { return series_; }
  /// Returns the reason why there are no series; empty if there are any.
  [[nodiscard]] const QString& trouble() const { return trouble_; }
  [[nodiscard]] const std::filesystem::path& index() const { return index_; }

 signals:
  void changed();

 private:
  std::filesystem::path index_;
  std::vector<HistorySeries> series_;
  QString trouble_;
};

}  // namespace todbench
