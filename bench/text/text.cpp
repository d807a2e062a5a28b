// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/text.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <system_error>

#include "acquisition/base/safe_file.h"

namespace todbench {

namespace {

/// Limit for files that never end: devices, or a pipe from a program that does not stop.
constexpr std::size_t largest_text = std::size_t{512} << 20U;

/// Returns the number of insertions, deletions, substitutions and swaps of neighbours (optimal string alignment) that
/// turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::vector<std::size_t> row(b.size() + 1, i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = std::move(last);
    last = std::move(row);
  }
  return last.back();
}

}  // namespace

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  const auto [end, problem] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return problem == std::errc() ? std::string(buffer.data(), end) : std::string();
}

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known) {
  std::optional<std::string> best;
  std::size_t best_distance = std::max<std::size_t>(1, name.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  if (best || name.empty()) return best;
  // One word of a longer name.
  const auto is_word_of = [&](const std::string& candidate) {
    return candidate.ends_with("_" + std::string(name)) || candidate.starts_with(std::string(name) + "_");
  };
  const auto longer = std::ranges::find_if(known, is_word_of);
  return longer == known.end() ? std::nullopt : std::optional(*longer);
}

std::string nearest_name_hint(std::string_view name, std::span<const std::string> known) {
  const std::optional<std::string> nearest = nearest_name(name, known);
  return nearest ? ", did you mean '" + *nearest + "'?" : "";
}

std::string quoted_list(std::span<const std::string> words) {
  std::string list;
  for (const std::string& word : words) {
    if (!list.empty()) list += ", ";
    list += "'" + word + "'";
  }
  return list;
}

std::string one_of(std::span<const std::string> words) {
  return (words.size() == 1 ? "" : "one of ") + quoted_list(words);
}

Result<std::string> read_text_file(const std::filesystem::path& file) {
  std::error_code problem;
  const auto status = std::filesystem::status(file, problem);
  if (!std::filesystem::exists(status)) return fail(ErrorCode::invalid_input, file.string() + ": no such file");
  if (std::filesystem::is_directory(status)) {
    return fail(ErrorCode::invalid_input, file.string() + ": is a folder, expected a file");
  }
  const auto opened = open_to_read(file);
  if (!opened) return fail(ErrorCode::invalid_input, opened.error().message);
  std::string content;
  std::vector<char> piece(std::size_t{1} << 20U);
  ssize_t taken = 0;
  while (content.size() <= largest_text &&
         ((taken = ::read(*opened, piece.data(), piece.size())) > 0 || (taken < 0 && errno == EINTR))) {
    if (taken > 0) content.append(piece.data(), static_cast<std::size_t>(taken));
  }
  ::close(*opened);
  if (content.size() > largest_text) return fail(ErrorCode::invalid_input, file.string() + ": larger than 512 MiB");
  if (taken < 0) return fail(ErrorCode::invalid_input, file.string() + ": cannot be read");
  return content;
}

Result<std::vector<std::string>> split_csv(std::string_view line) {
  std::vector<std::string> fields;
  std::size_t position = 0;
  while (true) {
    std::string field;
    if (position < line.size() && line[position] == '"') {
      ++position;
      while (true) {
        const std::size_t quote = line.find('"', position);
        if (quote == std::string_view::npos)
          return fail(ErrorCode::invalid_input, "a quoted field has no closing quote");
        field += line.substr(position, quote - position);
        position = quote + 1;
        if (position >= line.size() || line[position] != '"') break;
        field += '"';
        ++position;
      }
      if (position < line.size() && line[position] != ',') {
        return fail(ErrorCode::invalid_input, "unexpected text after the closing quote of a field");
      }
    } else {
      const std::size_t comma = std::min(line.find(',', position), line.size());
      field = line.substr(position, comma - position);
      if (field.find('"') != std::string::npos)
        return fail(ErrorCode::invalid_input, "a quote inside a field without quotes");
      position = comma;
    }
    fields.push_back(std::move(field));
    if (position >= line.size()) return fields;
    ++position;
  }
}

std::string csv_field(std::string_view text) {
  const std::string safe = one_line(text);
  const bool blank_ends = !safe.empty() && (safe.front() == ' ' || safe.back() == ' ');
  if (!blank_ends && safe.find_first_of(",\"") == std::string::npos) return safe;
  std::string field = "\"";
  for (const char c : safe) {
    if (c == '"') field += '"';
    field += c;
  }
  return field + "\"";
}

}  // namespace todbench
