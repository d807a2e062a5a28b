// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/contrast_error.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace todbench {
namespace {

/// Contribution of a triangle to the error of the mean.
struct Share {
  std::size_t set_up = 0, place = 0;
  double value = 0;
};

struct OneWay {
  double variance = 0;
  double clusters = 0;
};

OneWay one_way(const std::vector<Share>& shares, std::size_t Share::*cluster) {
  std::map<std::size_t, double> sums;
  for (const Share& share : shares) sums[share.*cluster] += share.value;
  OneWay out{.clusters = static_cast<double>(sums.size())};
  for (const auto& [key, sum] : sums) out.variance += sum * sum;
  if (out.clusters > 1) out.variance *= out.clusters / (out.clusters - 1);
  return out;
}

}  // namespace

std::size_t place_of(const ReferenceTriangle& triangle, std::vector<ReferenceTriangle>& known) {
  const auto near = std::ranges::find_if(known, [&](const ReferenceTriangle& other) {
    return cv::norm(triangle.place_px - other.place_px) < 0.5 * std::min(triangle.size_px, other.size_px);
  });
  if (near != known.end()) return static_cast<std::size_t>(near - known.begin());
  known.push_back(triangle);
  return known.size() - 1;
}

std::optional<ContrastError> contrast_error(std::span<const ContrastMeasurement> measurements) {
  double mean = 0;
  for (const ContrastMeasurement& one : measurements) mean += one.delta_t_k / static_cast<double>(measurements.size());
  std::vector<Share> shares;
  std::vector<ReferenceTriangle> places;
  double alone = 0, noise = 0;
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    const auto weight = 1 / static_cast<double>(measurements[i].references.size() * measurements.size());
    for (const ReferenceTriangle& triangle : measurements[i].references) {
      shares.push_back({.set_up = i, .place = place_of(triangle, places), .value = weight * (triangle.value - mean)});
      alone += shares.back().value * shares.back().value;
      noise += std::pow(weight * triangle.noise, 2);
    }
  }
  const OneWay set_ups = one_way(shares, &Share::set_up), at_places = one_way(shares, &Share::place);
  if (set_ups.clusters < 2 && at_places.clusters < 2) return std::nullopt;
  const double seen = set_ups.clusters < 2 ? 0 : set_ups.variance;
  const auto error = [&](double variance, double clusters) {
    return ContrastError{std::sqrt(variance), std::sqrt(std::max(0.0, variance - seen)), clusters - 1,
                         std::sqrt(noise)};
  };
  // With one set-up or one place, no deviation from the overall mean can be estimated.
  if (set_ups.clusters < 2) return error(at_places.variance, at_places.clusters);
  if (at_places.clusters < 2) return error(set_ups.variance, set_ups.clusters);
  const auto n = static_cast<double>(shares.size());
  const double both = set_ups.variance + at_places.variance - alone * n / (n - 1);
  const OneWay& larger = set_ups.variance > at_places.variance ? set_ups : at_places;
  if (both > larger.variance) return error(both, std::min(set_ups.clusters, at_places.clusters));
  return error(larger.variance, larger.clusters);
}

std::map<double, ContrastError> contrast_errors(std::span<const ContrastMeasurement> measurements) {
  std::map<double, std::vector<ContrastMeasurement>> by_contrast;
  for (const ContrastMeasurement& one : measurements)
    if (!one.references.empty()) by_contrast[one.set_delta_t_k].push_back(one);
  std::map<double, ContrastError> errors;
  for (const auto& [set_delta_t_k, own] : by_contrast) {
    if (const auto error = contrast_error(own); error && error->standard_error_k > 0)
      errors[set_delta_t_k] = at_least_the_noise(*error);
  }
  return errors;
}

void add_contrast_errors(TodCurve& curve, std::span<const ContrastMeasurement> measurements) {
  set_contrast_errors(curve, contrast_errors(measurements));
}

}  // namespace todbench
