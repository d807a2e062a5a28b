// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/answered_instruments.h"

#include <algorithm>
#include <cctype>

#include "acquisition/base/safe_text.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::string_view serial_mark = ", serial ";

}  // namespace

std::vector<AnsweredInstrument> answered_instruments(std::string_view target) {
  std::vector<AnsweredInstrument> found;
  while (!target.empty()) {
    const auto open = target.find(" (");
    const auto end = target.find(");", open == std::string_view::npos ? 0 : open);
    if (open == std::string_view::npos) break;
    std::string_view inside = target.substr(open + 2, end == std::string_view::npos ? end : end - open - 2);
    if (end == std::string_view::npos && inside.ends_with(')')) inside.remove_suffix(1);
    const auto serial = inside.rfind(serial_mark);
    found.push_back(
        {std::string(target.substr(0, open)),
         serial == std::string_view::npos ? std::string() : std::string(inside.substr(serial + serial_mark.size()))});
    target.remove_prefix(end == std::string_view::npos ? target.size() : end + 2);
    while (target.starts_with(' ')) target.remove_prefix(1);
  }
  return found;
}

std::vector<std::string> contradicted_instruments(std::span<const InstrumentPlan> rows, std::string_view target) {
  std::vector<std::string> sentences;
  for (const AnsweredInstrument& answered : answered_instruments(target)) {
    if (answered.serial.empty()) continue;
    const auto same = [&](const InstrumentPlan& row) { return row.serial == answered.serial; };
    if (std::any_of(rows.begin(), rows.end(), same)) continue;
    for (const InstrumentPlan& row : rows) {
      if (row.serial.empty() || lower_case(answered.role) != to_string(role_of(row))) continue;
      sentences.push_back("the " + answered.role + " that answered has the serial number " + one_line(answered.serial) +
                          ", but [[instrument]] '" + one_line(row.name) + "' states " + one_line(row.serial) +
                          (row.certificate.empty() ? "" : ", certificate " + one_line(row.certificate)) +
                          ": the stated calibration is that of another instrument");
    }
  }
  return sentences;
}

}  // namespace todbench
