// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of README.md against what the window shows now.
#include <gmock/gmock.h>

#include <QFontDatabase>
#include <QImage>
#include <QProcess>
#include <cmath>
#include <string>

#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench::testing {
namespace {

/// Means of squares of this many pixels: letters become grey; tables, plots and pictures stay where they are.
constexpr int square_px = 32;

QImage coarse(const QImage& image) {
  return image.convertToFormat(QImage::Format_Grayscale8)
      .scaled(image.width() / square_px, image.height() / square_px, Qt::IgnoreAspectRatio, Qt::SmoothTransformation);
}

/// Mean absolute difference of the squares, of 255.
double difference(const QImage& a, const QImage& b) {
  const QImage x = coarse(a), y = coarse(b);
  double sum = 0;
  for (int row = 0; row < x.height(); ++row)
    for (int column = 0; column < x.width(); ++column)
      sum += std::abs(qGray(x.pixel(column, row)) - qGray(y.pixel(column, row)));
  return sum / (x.width() * x.height());
}

TEST(ReadmePictures, AreWhatTheWindowShows) {
  if (!QFontDatabase::families().contains("DejaVu Sans")) GTEST_SKIP() << "the font DejaVu Sans is not installed";
  const TemporaryFolder folder;
  const std::filesystem::path made = folder.path() / "pictures";
  QProcess window;
  window.setProcessChannelMode(QProcess::MergedChannels);
  window.start(TODBENCH_GUI_PROGRAM, {"--sessions", QString::fromStdString(folder.path().string()), "--theme", "light",
                                      "--size", "1366x728", "--screenshots", QString::fromStdString(made.string())});
  ASSERT_TRUE(window.waitForFinished(-1));
  const std::string said = window.readAll().toStdString();
  EXPECT_EQ(window.exitCode(), 0) << said;

  // Curves, noise and progress of another run move a page by up to 2; two different pages are 13 and more apart.
  for (const std::string page : {"align", "measure", "chain", "report"}) {
    const QImage shown(QString::fromStdString((made / (page + ".png")).string()));
    const QImage committed(QString::fromStdString(source_file("docs/images/window-" + page + ".png")));
    ASSERT_FALSE(shown.isNull()) << page << said;
    ASSERT_EQ(shown.size(), committed.size()) << page;
    EXPECT_LT(difference(shown, committed), 5) << page << ": ./run screenshots writes the pictures anew";
  }
}

}  // namespace
}  // namespace todbench::testing
