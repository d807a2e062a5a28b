// SPDX-License-Identifier: GPL-3.0-or-later
// Table of the target: set-points, read-back and effective contrast.
#include <algorithm>
#include <cmath>
#include <map>

#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

/// Mean of the reported values, and the largest deviation from the set-point.
class Said {
 public:
  void add(const std::optional<double>& value, double set) {
    if (!value || !std::isfinite(*value)) return;
    sum_ += *value;
    ++count_;
    if (std::abs(*value - set) > std::abs(farthest_)) farthest_ = *value - set;
  }
  [[nodiscard]] std::optional<double> mean() const { return count_ > 0 ? std::optional(sum_ / count_) : std::nullopt; }
  [[nodiscard]] std::optional<double> farthest() const { return count_ > 0 ? std::optional(farthest_) : std::nullopt; }

 private:
  double sum_ = 0, farthest_ = 0;
  int count_ = 0;
};

struct ContrastRow {
  Said read_back, sensors, seen, expected;
  double longest_s = 0;
  int presentations = 0;
};

std::map<double, ContrastRow, std::greater<>> rows_by_contrast(const std::vector<Presentation>& presentations) {
  std::map<double, ContrastRow, std::greater<>> rows;
  for (const Presentation& shown : presentations) {
    const double set_k = shown.set.point_delta_t_k.value_or(shown.set.delta_t_k);
    ContrastRow& row = rows[set_k];
    row.read_back.add(shown.said.state.delta_t_k, set_k);
    if (shown.said.black_body_temperature_k && shown.said.plate_temperature_k)
      row.sensors.add(*shown.said.black_body_temperature_k - *shown.said.plate_temperature_k, set_k);
    row.seen.add(shown.delta_t_k, set_k);
    if (shown.air_transmittance) row.expected.add(*shown.air_transmittance * shown.said.state.delta_t_k, set_k);
    if (std::isfinite(shown.said.settling_s)) row.longest_s = std::max(row.longest_s, shown.said.settling_s);
    ++row.presentations;
  }
  return rows;
}

/// Kelvin to a tenth of a millikelvin, a tenth of the resolution of black bodies of this class.
RichText kelvin(const std::optional<double>& value, std::string_view reason) {
  return value ? plain(shown(*value, 4)) : missing(reason);
}

std::optional<double> difference(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b ? std::optional(*a - *b) : std::nullopt;
}

}  // namespace

std::optional<Table> target_table(const ReportData& data) {
  if (data.presentations.empty()) return {};
  constexpr std::string_view silent = "not reported by the target", unseen = "not observed";
  Table rows;
  rows.caption =
      "Set contrast, read-back of the target and contrast observed by the camera, means over the presentations; "
      "brackets: largest deviation of a read-back";
  rows.header = {"Set (K)",
                 "Read back (K)",
                 "Observed (K)",
                 "Read back − set (K)",
                 "Observed − set (K)",
                 "Observed − read back (K)",
                 "Black body − plate (K)",
                 "Longest settling (s)",
                 "Presentations"};
  const auto air = data.presentations.front().air_transmittance;
  if (air) {
    rows.caption +=
        ". " + std::string(data.collimated ? "Collimator and air transmit " : "The air transmits ") +
        shown(100 * *air, 2) +
        " % of the contrast, so the observed contrast is compared with the read-back times this transmittance";
    rows.header[5] = "Observed − read back × transmittance (K)";
    rows.header.insert(rows.header.begin() + 2, "Read back × transmittance (K)");
  }
  for (const auto& [set_k, row] : rows_by_contrast(data.presentations)) {
    const auto read_back = row.read_back.mean(), seen = row.seen.mean();
    const auto arriving = air ? row.expected.mean() : read_back;
    const RichText deviation =
        read_back ? unbroken(shown(*read_back - set_k, 4) + " (" + shown(*row.read_back.farthest(), 4) + ")")
                  : missing(silent);
    rows.rows.push_back({plain(stated(set_k)), kelvin(read_back, silent), kelvin(seen, unseen), deviation,
                         kelvin(difference(seen, set_k), unseen), kelvin(difference(seen, arriving), unseen),
                         kelvin(row.sensors.mean(), "no sensor"), plain(shown(row.longest_s, 1)),
                         plain(std::to_string(row.presentations))});
    if (air) rows.rows.back().insert(rows.rows.back().begin() + 2, kelvin(row.expected.mean(), silent));
  }
  return rows;
}

}  // namespace todbench
