// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/colour_map.h"

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

constexpr int entries = 256;

/// Nodes of a map at equal distances: red, green, blue.
using Nodes = std::vector<std::array<double, 3>>;

Nodes nodes_of(ColourMap map) {
  switch (map) {
    case ColourMap::white_hot:
      return {{0, 0, 0}, {255, 255, 255}};
    case ColourMap::black_hot:
      return {{255, 255, 255}, {0, 0, 0}};
    case ColourMap::iron:
      return {{0, 0, 12}, {70, 0, 120}, {170, 20, 130}, {230, 90, 40}, {255, 180, 30}, {255, 255, 230}};
    case ColourMap::viridis:
      return {{68, 1, 84},    {72, 40, 120},  {62, 74, 137},  {49, 104, 142}, {38, 130, 142},
              {31, 158, 137}, {53, 183, 121}, {109, 205, 89}, {180, 222, 44}, {253, 231, 37}};
  }
  return {{0, 0, 0}, {255, 255, 255}};
}

std::array<QRgb, entries> table_of(ColourMap map) {
  const Nodes nodes = nodes_of(map);
  std::array<QRgb, entries> table{};
  for (int i = 0; i < entries; ++i) {
    const double place = static_cast<double>(i) / (entries - 1) * static_cast<double>(nodes.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(place), nodes.size() - 2);
    const double t = place - static_cast<double>(k);
    std::array<int, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c)
      colour[c] = static_cast<int>(std::lround(nodes[k][c] * (1 - t) + nodes[k + 1][c] * t));
    table[static_cast<std::size_t>(i)] = qRgb(colour[0], colour[1], colour[2]);
  }
  return table;
}

std::size_t entry(double value, const LevelSpan& level) {
  const double place = (value - level.low) / level.span() * entries;
  return static_cast<std::size_t>(std::clamp(place, 0.0, entries - 1.0));
}

constexpr QRgb saturated_colour = qRgb(213, 94, 0);  // vermillion of Okabe and Ito
constexpr QRgb empty_colour = qRgb(0, 114, 178);     // blue of Okabe and Ito

}  // namespace

QString name_of(ColourMap map) {
  switch (map) {
    case ColourMap::white_hot:
      return "White hot";
    case ColourMap::black_hot:
      return "Black hot";
    case ColourMap::iron:
      return "Iron";
    case ColourMap::viridis:
      return "Viridis";
  }
  return {};
}

LevelSpan automatic_level(const cv::Mat1w& counts, double least_span) {
  std::vector<int> frequency(65536);
  for (const std::uint16_t value : counts) ++frequency[value];
  const double all = static_cast<double>(counts.total());
  const auto quantile = [&](double share) {
    double sum = 0;
    for (std::size_t i = 0; i < frequency.size(); ++i) {
      sum += frequency[i];
      if (sum >= share * all) return static_cast<double>(i);
    }
    return 65535.0;
  };
  LevelSpan level{quantile(0.0005), quantile(0.9995)};
  if (level.span() < least_span) {
    const double middle = level.level();
    level = {middle - least_span / 2, middle + least_span / 2};
  }
  return level;
}

QImage to_image(const cv::Mat1w& counts, const LevelSpan& level, ColourMap map, PictureMarks marks) {
  const auto table = table_of(map);
  QImage image(counts.cols, counts.rows, QImage::Format_RGB32);
  for (int row = 0; row < counts.rows; ++row) {
    const std::uint16_t* from = counts[row];
    auto* to = reinterpret_cast<QRgb*>(image.scanLine(row));
    for (int column = 0; column < counts.cols; ++column) {
      to[column] = table[entry(from[column], level)];
      if (marks.saturated_from < 0) continue;
      if (from[column] >= marks.saturated_from) to[column] = saturated_colour;
      if (from[column] == 0) to[column] = empty_colour;
    }
  }
  return image;
}

QImage to_image(const cv::Mat1d& values, const LevelSpan& level, ColourMap map) {
  const auto table = table_of(map);
  QImage image(values.cols, values.rows, QImage::Format_RGB32);
  for (int row = 0; row < values.rows; ++row) {
    auto* to = reinterpret_cast<QRgb*>(image.scanLine(row));
    for (int column = 0; column < values.cols; ++column) to[column] = table[entry(values(row, column), level)];
  }
  return image;
}

QImage grey_image(const cv::Mat1b& levels) {
  return QImage(levels.data, levels.cols, levels.rows, static_cast<qsizetype>(levels.step), QImage::Format_Grayscale8)
      .copy();
}

std::vector<int> histogram(const cv::Mat1w& counts, const LevelSpan& level, int bins) {
  std::vector<int> out(static_cast<std::size_t>(bins));
  const double factor = bins / level.span();
  for (const std::uint16_t value : counts)
    ++out[static_cast<std::size_t>(std::clamp((value - level.low) * factor, 0.0, bins - 1.0))];
  return out;
}

std::vector<cv::Point> dead_pixels(const cv::Mat1w& counts, double limit_counts) {
  std::vector<cv::Point> out;
  std::array<std::uint16_t, 8> around{};
  for (int row = 1; row + 1 < counts.rows; ++row) {
    for (int column = 1; column + 1 < counts.cols; ++column) {
      std::size_t n = 0;
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          if (x != 0 || y != 0) around[n++] = counts(row + y, column + x);
        }
      }
      std::nth_element(around.begin(), around.begin() + 4, around.end());
      const double middle = around[4];
      const double excess = std::abs(counts(row, column) - middle);
      const auto [low, high] = std::minmax_element(around.begin(), around.end());
      // The smallest triangle, blurred by optics and detector, changes a neighbour by more than this share; a stuck
      // pixel does not.
      const double spread = std::max(*high - middle, middle - *low);
      if (excess > limit_counts && spread < 0.05 * excess) out.emplace_back(column, row);
    }
  }
  return out;
}

}  // namespace todbench
