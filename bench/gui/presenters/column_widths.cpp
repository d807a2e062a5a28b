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

/// Width of the padding of a cell, with a little slack.
constexpr double padding_px = 2 * (cell_padding + 1) + 2;

/// Widths of a column: all of its texts on one line, and its longest word.
struct Need {
  double line_px = 0, word_px = 0;
};

std::string cell_text(const std::vector<RichText>& row, std::size_t column) {
  std::string text;
  if (column < row.size())
    for (const Phrase& phrase : row[column].phrases) text += phrase.text;
  return text;
}

Need need_of(const Table& table, std::size_t column, const QFontMetricsF& metrics) {
  static const QRegularExpression blanks("[ \\n\\t]+");
  constexpr double longest_px = 400;
  Need need;
  const auto count = [&](const QString& text) {
    need.line_px = std::max(need.line_px, metrics.horizontalAdvance(text));
    for (const QString& word : text.split(blanks))
      need.word_px = std::max(need.word_px, metrics.horizontalAdvance(word));
  };
  count(shown_text(table.header[column]));
  for (const auto& row : table.rows) count(shown_text(cell_text(row, column)));
  return {std::min(std::ceil(need.line_px) + padding_px, longest_px),
          std::min(std::ceil(need.word_px) + padding_px, longest_px)};
}

QFontMetricsF table_metrics() {
  QFont font("DejaVu Sans");
  font.setPixelSize(table_text_px);
  font.setBold(true);
  return QFontMetricsF(font);
}

std::vector<Need> needs_of(const Table& table) {
  const QFontMetricsF metrics = table_metrics();
  std::vector<Need> needs;
  for (std::size_t column = 0; column < table.header.size(); ++column) needs.push_back(need_of(table, column, metrics));
  return needs;
}

/// Widths of the texts of every row on one line, the header first.
std::vector<std::vector<double>> texts_px(const Table& table) {
  const QFontMetricsF metrics = table_metrics();
  std::vector<std::vector<double>> rows(1);
  for (const std::string& text : table.header) rows[0].push_back(metrics.horizontalAdvance(shown_text(text)));
  for (const auto& row : table.rows) {
    std::vector<double>& texts = rows.emplace_back();
    for (std::size_t column = 0; column < table.header.size(); ++column)
      texts.push_back(metrics.horizontalAdvance(shown_text(cell_text(row, column))));
  }
  return rows;
}

/// Lines of all rows. A wrapped line is filled to 90 % on average.
double lines_of(const std::vector<std::vector<double>>& rows, const std::vector<double>& widths_px) {
  double lines = 0;
  for (const std::vector<double>& row : rows) {
    double most = 1;
    for (std::size_t column = 0; column < row.size(); ++column) {
      const double room_px = widths_px[column] - padding_px;
      if (row[column] > room_px) most = std::max(most, std::max(2.0, std::ceil(row[column] / (0.9 * room_px))));
    }
    lines += most;
  }
  return lines;
}

/// Gives room from column to column while the table gets shorter. No column gets narrower than its longest word.
void make_shorter(const Table& table, const std::vector<Need>& needs, std::vector<double>& widths_px) {
  const auto rows = texts_px(table);
  double lines = lines_of(rows, widths_px);
  for (const double step_px : {48.0, 24.0, 12.0, 6.0}) {
    for (bool shorter = true; shorter;) {
      shorter = false;
      for (std::size_t from = 0; from < widths_px.size(); ++from) {
        for (std::size_t to = 0; to < widths_px.size(); ++to) {
          if (from == to || widths_px[from] - step_px < needs[from].word_px) continue;
          std::vector<double> tried = widths_px;
          tried[from] -= step_px;
          tried[to] += step_px;
          const double then = lines_of(rows, tried);
          if (then >= lines) continue;
          lines = then;
          widths_px = std::move(tried);
          shorter = true;
        }
      }
    }
  }
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
  make_shorter(table, needs, widths);
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
