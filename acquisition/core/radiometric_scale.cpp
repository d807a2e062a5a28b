// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/radiometric_scale.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

template <typename... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
// Clang 14 does not deduce template arguments of aggregates by itself.
template <typename... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

bool increasing(const std::vector<double>& values) {
  return std::adjacent_find(values.begin(), values.end(), [](double a, double b) { return !(a < b); }) == values.end();
}

bool finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// Piecewise linear y(x) with its slope; empty outside the points.
std::optional<std::pair<double, double>> interpolated(const std::vector<double>& xs, const std::vector<double>& ys,
                                                      double x) {
  if (!(x >= xs.front() && x <= xs.back())) return std::nullopt;
  const auto upper = std::upper_bound(xs.begin() + 1, xs.end() - 1, x);
  const auto i = static_cast<std::size_t>(upper - xs.begin());
  const double slope = (ys[i] - ys[i - 1]) / (xs[i] - xs[i - 1]);
  return std::pair(ys[i - 1] + slope * (x - xs[i - 1]), slope);
}

std::optional<double> planck_kelvin(const PlanckScale& p, double counts) {
  const double argument = p.r / (counts - p.o) + p.f;
  if (!(counts > p.o) || !(argument > 1)) return std::nullopt;
  return p.b / std::log(argument);
}

}  // namespace

Result<RadiometricScale> RadiometricScale::linear(LinearScale scale) {
  if (!std::isfinite(scale.kelvin_per_count) || scale.kelvin_per_count == 0 || !std::isfinite(scale.offset_k)) {
    return fail(ErrorCode::calibration,
                "a linear temperature scale needs a finite slope that is not zero and a finite offset");
  }
  return RadiometricScale(scale);
}

Result<RadiometricScale> RadiometricScale::table(TableScale scale) {
  if (scale.counts.size() < 2 || scale.counts.size() != scale.temperature_k.size() || !finite(scale.counts) ||
      !finite(scale.temperature_k) || !increasing(scale.counts) || !increasing(scale.temperature_k)) {
    return fail(ErrorCode::calibration,
                "a temperature table needs two or more points with counts and temperatures both increasing");
  }
  return RadiometricScale(std::move(scale));
}

Result<RadiometricScale> RadiometricScale::planck(PlanckScale scale) {
  if (!(scale.r > 0) || !(scale.b > 0) || !std::isfinite(scale.r) || !std::isfinite(scale.b) ||
      !std::isfinite(scale.f) || !std::isfinite(scale.o)) {
    return fail(ErrorCode::calibration,
                "the camera formula T = B / ln(R / (S - O) + F) needs positive finite R and B and finite F and O");
  }
  return RadiometricScale(scale);
}

std::optional<double> RadiometricScale::kelvin(double counts) const {
  return std::visit(Overloaded{[](const Uncalibrated&) -> std::optional<double> { return std::nullopt; },
                               [&](const LinearScale& s) -> std::optional<double> {
                                 return s.offset_k + s.kelvin_per_count * counts;
                               },
                               [&](const TableScale& s) -> std::optional<double> {
                                 const auto value = interpolated(s.counts, s.temperature_k, counts);
                                 return value ? std::optional(value->first) : std::nullopt;
                               },
                               [&](const PlanckScale& s) { return planck_kelvin(s, counts); }},
                    scale_);
}

std::optional<double> RadiometricScale::counts(double temperature_k) const {
  return std::visit(Overloaded{[](const Uncalibrated&) -> std::optional<double> { return std::nullopt; },
                               [&](const LinearScale& s) -> std::optional<double> {
                                 return (temperature_k - s.offset_k) / s.kelvin_per_count;
                               },
                               [&](const TableScale& s) -> std::optional<double> {
                                 const auto value = interpolated(s.temperature_k, s.counts, temperature_k);
                                 return value ? std::optional(value->first) : std::nullopt;
                               },
                               [&](const PlanckScale& s) -> std::optional<double> {
                                 const double denominator = std::exp(s.b / temperature_k) - s.f;
                                 if (!(temperature_k > 0) || !(denominator > 0)) return std::nullopt;
                                 return s.r / denominator + s.o;
                               }},
                    scale_);
}

std::optional<double> RadiometricScale::kelvin_per_count(double counts) const {
  return std::visit(Overloaded{[](const Uncalibrated&) -> std::optional<double> { return std::nullopt; },
                               [&](const LinearScale& s) -> std::optional<double> { return s.kelvin_per_count; },
                               [&](const TableScale& s) -> std::optional<double> {
                                 const auto value = interpolated(s.counts, s.temperature_k, counts);
                                 return value ? std::optional(value->second) : std::nullopt;
                               },
                               [&](const PlanckScale& s) -> std::optional<double> {
                                 const auto t = planck_kelvin(s, counts);
                                 if (!t) return std::nullopt;
                                 // dT/dS = T^2/B * R / ((S - O)^2 (R/(S - O) + F))
                                 const double d = counts - s.o;
                                 return *t * *t / s.b * s.r / (d * d * (s.r / d + s.f));
                               }},
                    scale_);
}

std::string RadiometricScale::describe() const {
  return std::visit(
      Overloaded{[](const Uncalibrated&) -> std::string { return "uncalibrated"; },
                 [&](const LinearScale& s) -> std::string {
                   return fmt::format("{:.6g} K/count, {:.6g} K at 0 counts", s.kelvin_per_count, s.offset_k);
                 },
                 [&](const TableScale& s) -> std::string {
                   return fmt::format("table of {} points, {:.2f} to {:.2f} K", s.counts.size(),
                                      s.temperature_k.front(), s.temperature_k.back());
                 },
                 [&](const PlanckScale& s) -> std::string {
                   return fmt::format("T = B/ln(R/(S-O)+F), R={:.8g} B={:.8g} F={:.8g} O={:.8g}", s.r, s.b, s.f, s.o);
                 }},
      scale_);
}

}  // namespace todbench
