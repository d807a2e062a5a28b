// SPDX-License-Identifier: GPL-3.0-or-later
// Least-squares fit of a transfer between TOD and bars, and its error for imagers that it was not fitted to.
#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/distributions.h"
#include "tests/sim_devices/prediction/method_transfer.h"
#include "tod/range/tod_transfer.h"

namespace todbench::testing {

/// ln(frequency of the bars) minus that of the transfer.
inline double residual(const TodTransfer& transfer, const MethodPoint& point) {
  return std::log(point.factor() / transfer_factor(transfer, point.acuity_share));
}

/// Levels by linear least squares for every centre and width of a grid. Both levels are known only within the studied
/// range of acuities.
inline TodTransfer fitted_transfer(std::span<const MethodPoint> points) {
  TodTransfer best;
  double least = std::numeric_limits<double>::infinity();
  for (double centre = -2; centre <= 0.5; centre += 0.05) {
    for (double width = 0.04; width <= 1; width *= 1.15) {
      double n = 0, s = 0, ss = 0, y = 0, sy = 0;
      for (const MethodPoint& point : points) {
        const double share = 1 / (1 + std::exp(-(std::log(point.acuity_share) - centre) / width));
        const double value = std::log(point.factor());
        n += 1, s += share, ss += share * share, y += value, sy += share * value;
      }
      const double slope = (n * sy - s * y) / (n * ss - s * s);
      TodTransfer fitted;
      fitted.ln_low = (y - slope * s) / n;
      fitted.ln_high = fitted.ln_low + slope;
      fitted.ln_centre = centre;
      fitted.ln_width = width;
      double squares = 0;
      for (const MethodPoint& point : points) squares += std::pow(residual(fitted, point), 2);
      // Levels far outside of the data come from a transition whose other end has no data.
      if (std::abs(slope) < 2 && squares < least) least = squares, best = fitted;
    }
  }
  return best;
}

/// Residuals in the order of the points. Each transfer is fitted without the imager of its point.
inline std::vector<double> left_out_residuals(std::span<const MethodPoint> points) {
  std::map<std::string, TodTransfer> without;
  std::vector<double> residuals;
  for (const MethodPoint& point : points) {
    const auto [slot, is_new] = without.try_emplace(point.imager);
    if (is_new) {
      std::vector<MethodPoint> others;
      for (const MethodPoint& other : points)
        if (other.imager != point.imager) others.push_back(other);
      slot->second = fitted_transfer(others);
    }
    residuals.push_back(residual(slot->second, point));
  }
  return residuals;
}

inline double rms(std::span<const double> values) {
  double squares = 0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

/// The fitted transfer with its studied range and 95 % interval: Student's t of the imagers, which are the independent
/// units, times the rms of the left-out residuals.
inline TodTransfer studied_transfer(std::span<const MethodPoint> points) {
  TodTransfer transfer = fitted_transfer(points);
  std::set<std::string> imagers;
  transfer.asymptote_over_noise = 60;
  transfer.least = std::numeric_limits<double>::infinity();
  for (const MethodPoint& point : points) {
    imagers.insert(point.imager);
    transfer.least = std::min(transfer.least, point.acuity_share);
  }
  const double t = distribution::quantile_above(0.025, static_cast<double>(imagers.size() - 1));
  transfer.half_width_ln = t * rms(left_out_residuals(points));
  return transfer;
}

}  // namespace todbench::testing
