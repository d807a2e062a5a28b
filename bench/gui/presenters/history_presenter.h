// The history of units without widgets: which series there are, and the chart of one.
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

/// A chart as the window shows it.
struct HistoryChart {
  Plot values;  ///< over days since the first, with 95 % intervals and the reference
  /// In standard deviations; nothing where there are too few values.
  std::optional<Plot> ewma, cusum;
  QString remark;  ///< what the charts say, in a sentence
};

/// The chart of a series.
[[nodiscard]] HistoryChart history_chart(const HistorySeries& series);
/// "acuity dT=2K", "A655sc, serial number 48000123".
[[nodiscard]] QString title_of(const HistorySeries& series);
[[nodiscard]] QString unit_of(const HistorySeries& series);

/// Reads the index when it is asked to; the GUI's thread.
class HistoryPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit HistoryPresenter(std::filesystem::path index, QObject* parent = nullptr);

  /// Adds the sessions at or below a folder and reads again. What is no session with a camera is not added.
  void add_sessions(const std::filesystem::path& folder);
  void refresh();
  [[nodiscard]] const std::vector<HistorySeries>& series() const { return series_; }
  /// Why there is nothing to show; empty where there is.
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
