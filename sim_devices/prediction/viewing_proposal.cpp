// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/viewing_proposal.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr std::array viewing_angles_arcmin{1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0};

/// Length that an angle covers at a distance of 1.
double covered(double arcmin) {
  return 2 * std::tan(arcmin / 60 * std::numbers::pi / 360);
}

/// ln S75 between the angles of the table, constant beyond them.
double between_angles(const std::array<double, viewing_angles_arcmin.size()>& logs, double arcmin) {
  if (arcmin <= viewing_angles_arcmin.front()) return logs.front();
  for (std::size_t i = 0; i + 1 < logs.size(); ++i) {
    const double low = viewing_angles_arcmin[i], high = viewing_angles_arcmin[i + 1];
    if (arcmin <= high) return logs[i] + (logs[i + 1] - logs[i]) * std::log(arcmin / low) / std::log(high / low);
  }
  return logs.back();
}

}  // namespace

Result<ViewingProposal> propose_viewing(const SensorSpec& sensor, const SensorPlan& effects,
                                        const TemplateObserverSpec& observer, double delta_t_k, std::stop_token stop) {
  const ViewedDisplay& stated = *observer.display;
  const double side_m = pixel_pitch_mm(stated) * stated.zoom / 1000;
  std::array<double, viewing_angles_arcmin.size()> logs{};
  const auto ln_s75 = [&](double viewing_distance_m) -> Result<double> {
    TemplateObserverSpec spec = observer;
    spec.display->viewing_distance_m = viewing_distance_m;
    TemplateObserver at_distance(spec, triangle_alternatives());
    const auto found = direct_estimate(sensor, effects, at_distance, {delta_t_k},
                                       {.motion = {}, .accuracy = Accuracy::draft(), .stop = stop});
    if (!found) return tl::unexpected(found.error());
    return std::log(found->front().s75_pitch);
  };
  for (std::size_t i = 0; i < logs.size(); ++i) {
    TODBENCH_TRY(const auto found, ln_s75(side_m / covered(viewing_angles_arcmin[i])));
    logs[i] = found;
  }
  // Two angles, because one draft estimate scatters by about the limit itself.
  const double best = (logs[logs.size() - 1] + logs[logs.size() - 2]) / 2;
  const double limit = best + std::log1p(viewing_cost_percent / 100);
  ViewingProposal out;
  out.stated_arcmin = arcmin_per_sample(stated);
  TODBENCH_TRY(const auto own, ln_s75(stated.viewing_distance_m));
  out.stated_cost_percent = 100 * std::expm1(own - best);
  double high = viewing_angles_arcmin[viewing_angles_arcmin.size() - 2], low = viewing_angles_arcmin.front();
  while (high / low > 1.001) {
    const double middle = std::sqrt(low * high);
    (between_angles(logs, middle) > limit ? low : high) = middle;
  }
  out.least_arcmin = high;
  out.viewing_distance_m = side_m / covered(high);
  out.zoom = std::ceil(covered(high) * stated.viewing_distance_m * 1000 / pixel_pitch_mm(stated) - 1e-9);
  return out;
}

std::string in_words(const ViewingProposal& proposal, const ViewedDisplay& stated) {
  return fmt::format(
      "from {:.1f} arcmin per displayed sample on, a larger picture would gain less than {:g} % of acuity: zoom {:g} "
      "at "
      "{:g} m, or at most {:.2g} m at zoom {:g} (stated: {:.1f} arcmin, which costs {:.0f} %)",
      proposal.least_arcmin, viewing_cost_percent, proposal.zoom, stated.viewing_distance_m,
      proposal.viewing_distance_m, stated.zoom, proposal.stated_arcmin, std::max(0.0, proposal.stated_cost_percent));
}

}  // namespace todbench
