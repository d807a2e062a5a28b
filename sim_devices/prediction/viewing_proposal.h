// SPDX-License-Identifier: GPL-3.0-or-later
// Zoom and viewing distance at which display and eye reduce the acuity only slightly.
#pragma once

#include <stop_token>
#include <string>

#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Largest accepted loss of acuity due to the size of the picture at the eye, in percent.
inline constexpr double viewing_cost_percent = 1;

/// Proposed zoom and distance.
struct ViewingProposal {
  double stated_arcmin = 0;        ///< angle of a displayed sample at the stated display
  double stated_cost_percent = 0;  ///< excess of S75 at the stated display over S75 of a large picture
  double least_arcmin = 0;         ///< smallest angle at which the cost is below viewing_cost_percent
  double zoom = 1;                 ///< smallest whole zoom at the stated distance
  double viewing_distance_m = 0;   ///< largest distance at the stated zoom
};

/// Compares S75, the size with 75 % correct answers, at angles of 1 to 8 arcmin per displayed sample with S75 of a
/// large picture, which is the mean of ln S75 at 6 and 8 arcmin. All values are direct estimates at the contrast
/// `delta_t_k`. Between angles, ln S75 is interpolated linearly in the logarithm of the angle. Different angles are
/// different viewing distances at constant luminance. Small eye movements, accommodation and field of view are not
/// modelled. Precondition: an eye with a display. Errors: those of direct_estimate().
[[nodiscard]] Result<ViewingProposal> propose_viewing(const SensorSpec& sensor, const SensorPlan& effects,
                                                      const TemplateObserverSpec& observer, double delta_t_k,
                                                      std::stop_token stop);

/// Returns "from 4.1 arcmin per displayed sample on, a larger picture would gain less than 1 % of acuity: zoom 5 at 0.6
/// m, or at most 0.3 m at zoom 2 (stated: 2.0 arcmin, which costs 9 %)".
[[nodiscard]] std::string in_words(const ViewingProposal& proposal, const ViewedDisplay& stated);

}  // namespace todbench
