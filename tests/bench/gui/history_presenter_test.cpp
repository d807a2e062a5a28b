// SPDX-License-Identifier: GPL-3.0-or-later
// The history of units in the window: its charts are those of the history.
#include "bench/gui/presenters/history_presenter.h"

#include <gmock/gmock.h>

#include <QLabel>
#include <QPushButton>
#include <QTableWidget>

#include "bench/gui/views/history_view.h"
#include "bench/gui/views/plot_view.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

/// Checks a month apart: three of the reference, then so many at a shift in standard deviations.
HistorySession check(int month, double value) {
  HistorySession session;
  session.unit = {"Maker", "Model", "4711", "25 mm"};
  session.path = "/sessions/" + std::to_string(month);
  session.manifest_sha256 = std::string(63, 'a') + static_cast<char>('a' + month);
  session.started_utc = "2026-" + std::string(month < 9 ? "0" : "") + std::to_string(month + 1) + "-01T12:00:00Z";
  session.values = {{"netd", "", "K", "linear", value, 0.001}, {"acuity", "dT=2K", "1/mrad", "ln", 0.1, 0.02}};
  return session;
}

HistoryIndex index_with(const std::filesystem::path& file, const std::vector<double>& values) {
  auto index = HistoryIndex::open(file).value();
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_TRUE(index.add(check(static_cast<int>(i), values[i])));
  return index;
}

TEST(HistoryPresenter, DrawsTheChartsOfTheHistory) {
  const testing::TemporaryFolder folder;
  const auto index = index_with(folder.path() / "h.sqlite", {0.050, 0.051, 0.049, 0.060, 0.061, 0.062});
  const auto series = history_series(index, "4711", "netd").value();
  ASSERT_EQ(series.size(), 1U);
  const auto expected = control_chart(series[0].values, {}).value();

  const HistoryChart chart = history_chart(series[0]);

  ASSERT_TRUE(chart.ewma);
  ASSERT_TRUE(chart.cusum);
  ASSERT_EQ(chart.values.series.front().points.size(), 6U);
  for (std::size_t i = 0; i < expected.points.size(); ++i) {
    EXPECT_EQ(chart.values.series[0].points[i].y, expected.points[i].value);
    EXPECT_EQ(chart.ewma->series.back().points[i].y, expected.points[i].ewma);
    EXPECT_EQ(chart.cusum->series[1].points[i].y, expected.points[i].cusum_up);
  }
  EXPECT_EQ(chart.values.references.front().y, expected.reference);
  ASSERT_TRUE(expected.signalled()) << "ten standard deviations";
  EXPECT_TRUE(chart.remark.startsWith("✗"));
  for (const Plot* plot : {&chart.values, &*chart.ewma, &*chart.cusum}) EXPECT_TRUE(drawn(*plot)) << plot->title;
}

TEST(HistoryPresenter, ShowsALogarithmAsWhatItIsTheLogarithmOf) {
  const testing::TemporaryFolder folder;
  const auto index = index_with(folder.path() / "h.sqlite", {0.050});

  const HistoryChart chart = history_chart(history_series(index, "", "acuity").value().front());

  EXPECT_EQ(chart.values.series[0].points[0].y, std::exp(0.1));
  EXPECT_FALSE(chart.ewma) << "one value makes no chart";
  EXPECT_TRUE(drawn(chart.values));
}

TEST(HistoryView, ShowsTheSeriesThatIsChosen) {
  const testing::TemporaryFolder folder;
  { const auto index = index_with(folder.path() / "h.sqlite", {0.050, 0.051, 0.049, 0.050}); }
  HistoryPresenter presenter(folder.path() / "h.sqlite");
  HistoryView view(presenter, folder.path());
  view.show();
  auto* list = view.findChild<QTableWidget*>("historyTable");
  ASSERT_EQ(list->rowCount(), 2);

  list->selectRow(1);

  const auto* values = view.findChild<PlotView*>("historyValues");
  EXPECT_EQ(values->shown().title, title_of(presenter.series()[1]).toStdString());
  EXPECT_TRUE(values->isVisible());
  EXPECT_FALSE(view.findChild<QLabel*>("historyRemark")->text().isEmpty());
}

TEST(HistoryView, SaysWhyThereIsNothing) {
  const testing::TemporaryFolder folder;
  HistoryPresenter presenter(folder.path() / "none.sqlite");
  HistoryView view(presenter, folder.path() / "nowhere");

  view.show();
  const QString first = presenter.trouble();
  view.findChild<QPushButton*>("historyAdd")->click();

  EXPECT_FALSE(first.isEmpty());
  EXPECT_FALSE(presenter.trouble().isEmpty());
  EXPECT_EQ(view.findChild<QLabel*>("historyRemark")->text(), presenter.trouble());
}

}  // namespace
}  // namespace todbench
