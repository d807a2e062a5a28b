// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/terminal_lines.h"

#include <algorithm>
#include <numeric>

namespace todbench {
namespace {

using Lines = std::vector<std::string>;

constexpr std::size_t gap = 3;           // between two columns
constexpr std::size_t least_words = 24;  // least columns of a cell of words over several lines

std::string padded(std::string_view text, std::size_t columns, bool left) {
  const std::string blanks(columns > columns_of(text) ? columns - columns_of(text) : 0, ' ');
  return left ? std::string(text) + blanks : blanks + std::string(text);
}

/// Returns whether the cell is a number, an interval, or the dash of an absent value.
bool is_numeric(const std::string& cell) {
  return cell.empty() || cell.starts_with("–") || cell.find_first_of("0123456789") <= (cell.starts_with('-') ? 1U : 0U);
}

struct Layout {
  std::vector<std::size_t> widths;
  std::vector<bool> left;

  [[nodiscard]] std::size_t width() const {
    return std::accumulate(widths.begin(), widths.end(), gap * (widths.size() - 1));
  }
};

/// Adds the cells of a row, each over as many lines as its column requires.
void add_row(const Layout& layout, const Lines& row, bool from_below, Lines& out) {
  std::vector<Lines> cells;
  std::size_t height = 1;
  for (std::size_t i = 0; i < row.size(); ++i) {
    cells.push_back(broken_line(row[i], layout.widths[i]));
    height = std::max(height, cells.back().size());
  }
  for (std::size_t y = 0; y < height; ++y) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::size_t above = from_below ? height - cells[i].size() : 0;
      const std::string& text = y >= above && y - above < cells[i].size() ? cells[i][y - above] : std::string();
      line += std::string(i == 0 ? 0 : gap, ' ') + padded(text, layout.widths[i], layout.left[i]);
    }
    while (!line.empty() && line.back() == ' ') line.pop_back();
    out.push_back(std::move(line));
  }
}

std::size_t longest_word(std::string_view text) {
  std::size_t longest = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    longest = std::max(longest, columns_of(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return longest;
}

/// Returns the bytes of a line that continuation lines leave blank.
std::size_t hanging_part(std::string_view line, std::size_t columns) {
  std::size_t part = 0;
  for (std::size_t i = 0; i < line.size() && columns_of(line.substr(0, i)) < columns / 2; ++i) {
    const bool behind_a_gap = i == 0 || line[i - 1] == ' ';
    const bool wide = i < 2 || line[i - 2] == ' ';
    if (line[i] != ' ' && behind_a_gap && wide) part = i;
  }
  return part;
}

Lines as_records(const Lines& header, const std::vector<Lines>& rows, std::size_t columns) {
  Lines out;
  for (const Lines& row : rows) {
    if (!out.empty()) out.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) {
      Lines lines = broken_line(header[i] + (header[i].empty() ? "" : ": ") + row[i], columns);
      out.insert(out.end(), lines.begin(), lines.end());
    }
  }
  return out;
}

}  // namespace

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::vector<std::string> broken_line(std::string_view line, std::size_t columns) {
  if (columns_of(line) <= columns) return {std::string(line)};
  const std::string_view head = line.substr(0, hanging_part(line, columns));
  const std::string indent(columns_of(head), ' ');
  line.remove_prefix(head.size());
  Lines out;
  std::string current(head);
  bool empty = true;  // `current` has no word yet
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(std::min(end + 1, line.size()));
    if (word.empty()) continue;
    if (!empty && columns_of(current) + 1 + columns_of(word) > columns) {
      out.push_back(current);
      current = indent;
      empty = true;
    }
    current += (empty ? "" : " ") + std::string(word);
    empty = false;
  }
  out.push_back(current);
  return out;
}

std::vector<std::string> table_lines(const std::vector<std::string>& header,
                                     const std::vector<std::vector<std::string>>& rows,
                                     std::optional<std::size_t> columns) {
  Layout layout{{}, std::vector<bool>(header.size(), true)};
  std::vector<std::size_t> cells(header.size(), 0);
  for (std::size_t i = 0; i < header.size(); ++i) {
    for (const Lines& row : rows) cells[i] = std::max(cells[i], columns_of(row[i]));
    layout.widths.push_back(std::max(columns_of(header[i]), cells[i]));
    layout.left[i] =
        i == 0 || std::any_of(rows.begin(), rows.end(), [&](const Lines& row) { return !is_numeric(row[i]); });
  }
  if (columns && layout.width() > *columns) {
    for (std::size_t i = 0; i < header.size(); ++i) layout.widths[i] = std::max(longest_word(header[i]), cells[i]);
  }
  if (columns && layout.width() > *columns && layout.left.back()) {
    const std::size_t others = layout.width() - layout.widths.back();
    if (others + least_words <= *columns) layout.widths.back() = *columns - others;
  }
  if (columns && layout.width() > *columns) return as_records(header, rows, *columns);
  Lines out;
  add_row(layout, header, true, out);
  std::string rule;
  for (std::size_t i = 0; i < layout.widths.size(); ++i)
    rule += std::string(i == 0 ? 0 : gap, ' ') + std::string(layout.widths[i], '-');
  out.push_back(rule);
  for (const Lines& row : rows) add_row(layout, row, false, out);
  return out;
}

}  // namespace todbench
