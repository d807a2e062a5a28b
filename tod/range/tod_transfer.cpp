// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/range/tod_transfer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace todbench {
namespace {

/// Fitted by method_transfer_study (docs/validation/ranges.md, "TOD and four bars").
constexpr std::array transfers{
    TodTransfer{.name = "simulated-imagers-1",
                .observer = "hvs-1",
                .source = "ten simulated imagers, hvs-1: four bars or five at the best phase, as far as two bars are "
                          "separated (validation report, ranges)",
                .ln_low = 1.2390,
                .ln_high = -0.7385,
                .ln_centre = 0.15,
                .ln_width = 0.6547,
                .least = 0.30,
                .asymptote_over_noise = 60,
                .half_width_ln = 0.135}};

/// ln of the frequency of the bars.
double ln_frequency(const TodTransfer& transfer, double acuity, double asymptote) {
  return std::log(acuity * transfer_factor(transfer, acuity / asymptote));
}

/// 1 / f of a threshold with its interval. An open side of the threshold or of the asymptote is open.
TodThreshold moved(const TodTransfer& transfer, const TodThreshold& threshold, const TodThreshold& highest) {
  const double acuity = 1 / threshold.s75_mrad, asymptote = 1 / highest.s75_mrad;
  const double middle = ln_frequency(transfer, acuity, asymptote);
  const bool own = threshold.delta_t_k == highest.delta_t_k;
  const auto side = [&](const std::optional<double>& bound, const std::optional<double>& of_highest) {
    if (!bound || !(*bound > 0) || !of_highest || !(*of_highest > 0)) return std::optional<double>{};
    // The asymptote moves with its own point; that of another point is another error.
    const double by_own = ln_frequency(transfer, 1 / *bound, own ? 1 / *bound : asymptote) - middle;
    const double by_asymptote = own ? 0 : ln_frequency(transfer, acuity, 1 / *of_highest) - middle;
    return std::optional(std::exp(-middle - std::copysign(std::hypot(by_own, by_asymptote), by_own)));
  };
  TodThreshold out = threshold;
  out.s75_mrad = std::exp(-middle);
  out.s75_ci95_mrad = {side(threshold.s75_ci95_mrad.low, highest.s75_ci95_mrad.low),
                       side(threshold.s75_ci95_mrad.high, highest.s75_ci95_mrad.high)};
  return out;
}

}  // namespace

std::span<const TodTransfer> tod_transfers() {
  return transfers;
}

Result<TodTransfer> tod_transfer_named(std::string_view name) {
  std::string known;
  for (const TodTransfer& transfer : transfers) {
    if (transfer.name == name) return transfer;
    known += (known.empty() ? "" : ", ") + std::string(transfer.name);
  }
  return fail(ErrorCode::invalid_input, fmt::format("unknown transfer '{}' (known: {})", name, known));
}

double transfer_factor(const TodTransfer& transfer, double acuity_over_asymptote) {
  const double place = (std::log(acuity_over_asymptote) - transfer.ln_centre) / transfer.ln_width;
  return std::exp(transfer.ln_low + (transfer.ln_high - transfer.ln_low) / (1 + std::exp(-place)));
}

Result<TransferredCurve> transferred(std::span<const TodThreshold> thresholds, const TodTransfer& transfer,
                                     double noise_k) {
  if (thresholds.empty()) return fail(ErrorCode::invalid_input, "the TOD curve has no threshold");
  if (!(std::isfinite(noise_k) && noise_k > 0))
    return fail(ErrorCode::invalid_input, fmt::format("transfer {} needs the noise of the camera", transfer.name));
  const TodThreshold& highest = *std::max_element(
      thresholds.begin(), thresholds.end(), [](const auto& a, const auto& b) { return a.delta_t_k < b.delta_t_k; });
  if (highest.delta_t_k < transfer.asymptote_over_noise * noise_k) {
    return fail(ErrorCode::invalid_input,
                fmt::format("transfer {} needs the acuity at a contrast of {:g} times the noise of a sample, {:.3g} K; "
                            "the highest threshold is at {:g} K",
                            transfer.name, transfer.asymptote_over_noise, transfer.asymptote_over_noise * noise_k,
                            highest.delta_t_k));
  }
  TransferredCurve out;
  for (const TodThreshold& threshold : thresholds) {
    const double share = highest.s75_mrad / threshold.s75_mrad;
    if (share >= transfer.least) {
      out.points.push_back(moved(transfer, threshold, highest));
      continue;
    }
    out.notes.push_back(fmt::format(
        "at {:g} K the acuity is {:.3g} of that at {:g} K; transfer {} was studied from {:.3g}, so the curve begins at "
        "a higher contrast",
        threshold.delta_t_k, share, highest.delta_t_k, transfer.name, transfer.least));
  }
  return out;
}

}  // namespace todbench
