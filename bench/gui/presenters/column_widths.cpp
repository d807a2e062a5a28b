// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/column_widths.h"

#include <QFont>
#include <QFontMetricsF>
#include <QRegularExpression>
#include <QString>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "acquisition/base/safe_text.h"

namespace todbench {
namespace {

QString shown_text(const std::string& text) {
  return QString::fromStdString(valid_text(text));
}

/// Widths of a column: all of its texts on one line, and its longest word.
struct Need {
  double line_px = 0, word_px = 0;
};

Need need_of(const Table& table, std::size_t column, const QFontMetricsF& metrics) {
  static const QRegularExpression blanks("[ \\n\\t]+");
  constexpr double longest_px = 400, slack_px = 2, padding_px = 2 * (cell_padding + 1) + slack_px;
  Need need;
  const auto count = [&](const QString& text) {
    need.line_px = std::max(need.line_px, metrics.horizontalAdvance(text));
    for (const QString& word : text.split(blanks))
      need.word_px = std::max(need.word_px, metrics.horizontalAdvance(word));
  };
  count(shown_text(table.header[column]));
  for (const auto& row : table.rows) {
    QString text;
    if (column < row.size())
      for (const Phrase& phrase : row[column].phrases) text += shown_text(phrase.text);
    count(text);
  }
  return {std::min(std::ceil(need.line_px) + padding_px, longest_px),
          std::min(std::ceil(need.word_px) + padding_px, longest_px)};
}

std::vector<Need> needs_of(const Table& table) {
  QFont font("DejaVu Sans");
  font.setPixelSize(table_text_px);
  font.setBold(true);
  const QFontMetricsF metrics(font);
  std::vector<Need> needs;
  for (std::size_t column = 0; column < table.header.size(); ++column) needs.push_back(need_of(table, column, metrics));
  return needs;
}

}  // namespace

std::vector<double> widths_of(const Table& table) {
  const std::vector<Need> needs = needs_of(table);
  std::vector<std::size_t> order(needs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t x, std::size_t y) { return needs[x].line_px < needs[y].line_px; });
  std::vector<double> widths(needs.size(), 0);
  double left_px = text_width_px;
  while (!order.empty() && needs[order.front()].line_px <= left_px / static_cast<double>(order.size())) {
    left_px -= widths[order.front()] = needs[order.front()].line_px;
    order.erase(order.begin());
  }
  if (order.empty()) return {};
  while (true) {
    double roots = 0;
    for (const std::size_t i : order) roots += std::sqrt(needs[i].line_px);
    for (const std::size_t i : order) widths[i] = left_px * std::sqrt(needs[i].line_px) / roots;
    const auto tight = std::find_if(order.begin(), order.end(), [&](std::size_t i) {
      return order.size() > 1 && widths[i] < needs[i].word_px && needs[i].word_px < left_px;
    });
    if (tight == order.end()) break;
    left_px -= widths[*tight] = needs[*tight].word_px;
    order.erase(tight);
  }
  for (double& width : widths) width *= 100 / text_width_px;
  return widths;
}

std::vector<double> narrowest_px(const Table& table) {
  Table wrapped = table;
  // Only the longest word of a header needs room.
  const std::vector<Need> words = needs_of({"", table.header, {}});
  for (std::string& text : wrapped.header) text.clear();
  const std::vector<Need> needs = needs_of(wrapped);
  std::vector<double> widths;
  for (std::size_t i = 0; i < needs.size(); ++i) widths.push_back(std::max(needs[i].line_px, words[i].word_px));
  return widths;
}

}  // namespace todbench
