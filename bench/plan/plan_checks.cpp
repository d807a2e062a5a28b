// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/plan_checks.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "acquisition/core/camera_id.h"
#include "acquisition/core/control_text.h"
#include "bench/plan/collimator.h"
#include "bench/plan/quantity.h"
#include "bench/text/text.h"
#include "tod/instruments/instrument_line.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {
namespace {

constexpr std::string_view address_forms = "\"HOST:PORT\", \"serial:/dev/NAME\" or \"vxi11:HOST\"";

/// An address without a port is rejected: a plan must state the port.
bool is_address(const std::string& text) {
  const auto address = instrument_address(text, 0);
  return address && (address->kind != InstrumentAddress::Kind::tcp || address->port != 0);
}

ValueMistakes check_address(const Plan& plan, const std::string& address) {
  if (address.empty()) {
    if (plan.target.kind != TargetKind::scpi) return {};
    return {{std::nullopt, "needed for kind \"scpi\", expected " + std::string(address_forms)}};
  }
  if (is_address(address)) return {};
  return {{std::nullopt, "expected " + std::string(address_forms) + ", found \"" + one_line(address) + "\""}};
}

}  // namespace

ValueMistakes check_camera_id(const Plan& plan, std::size_t /*row*/) {
  const std::string& id = plan.camera.id;
  const auto colon = id.find(':');
  if (id.empty()) return {};
  if (colon != std::string::npos && colon > 0 && colon + 1 < id.size()) {
    const std::string scheme = id.substr(0, colon);
    const std::vector<std::string> known(camera_scheme::all.begin(), camera_scheme::all.end());
    if (std::find(known.begin(), known.end(), scheme) != known.end()) return {};
    return {{std::nullopt, "unknown scheme \"" + one_line(scheme) + "\", expected one of " + quoted_list(known) +
                               nearest_name_hint(scheme, known)}};
  }
  return {{std::nullopt, "expected SCHEME:NAME as listed by 'todbench devices', found \"" + one_line(id) + "\""}};
}

ValueMistakes check_frame_size(const Plan& plan, std::size_t /*row*/) {
  const std::string& size = plan.camera.frame_size;
  if (size.empty() || frame_size_of(size)) return {};
  return {{std::nullopt, "expected WIDTHxHEIGHT in pixels, as in 640x512, found \"" + one_line(size) + "\""}};
}

ValueMistakes check_black_body(const Plan& plan, std::size_t /*row*/) {
  return check_address(plan, plan.target.black_body);
}

ValueMistakes check_stage(const Plan& plan, std::size_t /*row*/) {
  return check_address(plan, plan.target.stage);
}

ValueMistakes check_display_pixel(const Plan& plan, std::size_t /*row*/) {
  if (plan.target.kind != TargetKind::display || plan.target.display_pixel_mm > 0) return {};
  return {{std::nullopt, "needed for kind \"display\", expected a number above 0"}};
}

ValueMistakes check_display_span(const Plan& plan, std::size_t /*row*/) {
  if (plan.target.kind != TargetKind::display) return {};
  if (!(plan.target.display_span_k > 0))
    return {{std::nullopt, "needed for kind \"display\", expected a number above 0"}};
  for (const double delta_t_k : plan.target.delta_t_k) {
    if (std::abs(delta_t_k) > plan.target.display_span_k)
      return {{std::nullopt, "the contrast " + number_text(delta_t_k) +
                                 " K of [target] is larger than display_span_k, " +
                                 number_text(plan.target.display_span_k) + " K"}};
  }
  return {};
}

ValueMistakes check_display_luminance(const Plan& plan, std::size_t /*row*/) {
  const std::vector<double>& luminance = plan.target.display_luminance;
  if (luminance.size() < 2) return {{std::nullopt, "expected at least two luminances, from black to white"}};
  for (std::size_t i = 1; i < luminance.size(); ++i) {
    if (!(luminance[i] > luminance[i - 1])) {
      return {{i, "luminances must rise: expected more than " + number_text(luminance[i - 1]) + ", found " +
                      number_text(luminance[i])}};
    }
  }
  if (luminance.size() > 2 && plan.target.display_gamma != 1)
    return {{std::nullopt, "state either a table of luminances or display_gamma, not both"}};
  return {};
}

ValueMistakes check_contrast_unit(const Plan& plan, std::size_t /*row*/) {
  if (plan.camera.contrast == ContrastUnit::kelvin) return {};
  ValueMistakes mistakes;
  MeasuresPlan in_kelvin = plan.measures;
  in_kelvin.gain_control = false;
  if (in_kelvin.any())
    mistakes.push_back(
        {std::nullopt, "physical measures need kelvin: remove them from [measures], or use contrast = \"kelvin\""});
  if (!plan.modules.empty())
    mistakes.push_back(
        {std::nullopt,
         "grey levels cannot be measured behind a [[module]]: remove the module, or use contrast = \"kelvin\""});
  return mistakes;
}

ValueMistakes check_contrasts(const Plan& plan, std::size_t /*row*/) {
  ValueMistakes mistakes;
  const std::vector<double>& contrasts = plan.target.delta_t_k;
  for (std::size_t i = 0; i < contrasts.size(); ++i) {
    if (contrasts[i] == 0) mistakes.push_back({i, "a contrast of 0 K makes the triangles invisible"});
    for (std::size_t j = 0; j < i; ++j) {
      if (!same_contrast(contrasts[i], contrasts[j])) continue;
      mistakes.push_back({i, number_text(contrasts[i]) + " K is listed twice (contrasts within 0.5 % count as equal)"});
    }
  }
  return mistakes;
}

namespace {

/// Reason why presentations cannot have a contrast of their own; empty: they can.
std::string lacks_own_contrasts(const Plan& plan) {
  if (plan.target.kind != TargetKind::scpi && plan.target.kind != TargetKind::scene)
    return "needs [target] kind \"scpi\" or \"scene\": the target has to change its contrast by itself";
  if (plan.camera.contrast == ContrastUnit::grey_levels)
    return "needs contrasts in kelvin, and [camera] contrast is \"grey-levels\"";
  if (plan.fit.estimator == EstimatorChoice::weibull || plan.schedule.answers == AnswersChoice::binary ||
      plan.fit.lapse != 0.0 || !plan.modules.empty())
    return "needs graded answers that are fitted with the function of the twin: no estimator \"weibull\", no answers "
           "\"binary\", no lapse, no [[module]]";
  return "";
}

bool is_ramp(const Plan& plan) {
  return plan.schedule.kind == ScheduleKind::ramp;
}

ValueMistakes needed_for_ramp(const Plan& plan, const std::optional<double>& value, std::string_view what) {
  if (!is_ramp(plan) || value) return {};
  return {{std::nullopt, "needed for [schedule] kind \"ramp\", expected " + std::string(what)}};
}

}  // namespace

ValueMistakes check_schedule_kind(const Plan& plan, std::size_t /*row*/) {
  if (!is_ramp(plan)) return {};
  if (const std::string lacks = lacks_own_contrasts(plan); !lacks.empty()) return {{std::nullopt, "a ramp " + lacks}};
  constexpr std::size_t least = 5;
  const std::size_t set_ups = set_ups_of(plan.target);
  if (set_ups >= least) return {};
  return {{std::nullopt, "a ramp needs at least five set-ups (plates in their mountings), found " +
                             std::to_string(set_ups) + ": its interval comes from the scatter over them"}};
}

ValueMistakes check_ramp_rate(const Plan& plan, std::size_t /*row*/) {
  const auto& rate = plan.schedule.ramp_k_per_s;
  if (!is_ramp(plan) || (rate && *rate > 0)) return needed_for_ramp(plan, rate, "a rate above 0 K/s");
  if (!rate) return needed_for_ramp(plan, rate, "a rate above 0 K/s");
  if (*rate == 0) return {{std::nullopt, "a rate of 0 K/s never leaves from_delta_t_k, expected a rate above 0 K/s"}};
  return {{std::nullopt, "a rate of " + number_text(*rate) +
                             " K/s has the wrong sign, expected one above 0 K/s: a ramp always falls from "
                             "from_delta_t_k to to_delta_t_k and rises again"}};
}

ValueMistakes check_ramp_from(const Plan& plan, std::size_t /*row*/) {
  return needed_for_ramp(plan, plan.schedule.from_delta_t_k, "the contrast at which a ramp begins");
}

ValueMistakes check_ramp_to(const Plan& plan, std::size_t /*row*/) {
  if (!is_ramp(plan) || !plan.schedule.to_delta_t_k || !plan.schedule.from_delta_t_k)
    return needed_for_ramp(plan, plan.schedule.to_delta_t_k, "the contrast at which a ramp turns");
  const double from = *plan.schedule.from_delta_t_k, to = *plan.schedule.to_delta_t_k;
  const std::string ramp = number_text(from) + " K to " + number_text(to) + " K";
  if (!(from * to > 0) || !(std::abs(from) > std::abs(to)))
    return {{std::nullopt, "a ramp falls towards 0 without reaching it, but the plan states " + ramp}};
  for (const double delta_t_k : plan.target.delta_t_k) {
    constexpr double rounding = 1e-6;
    const double share = delta_t_k / to;
    if (share >= 1 - rounding && share <= from / to * (1 + rounding)) continue;
    return {{std::nullopt,
             "the contrast " + number_text(delta_t_k) + " K of [target] delta_t_k is outside the ramp, " + ramp}};
  }
  return {};
}

ValueMistakes check_contrast_lag(const Plan& plan, std::size_t /*row*/) {
  return needed_for_ramp(plan, plan.target.max_contrast_lag_s,
                         "the longest lag between small and large triangles of the plate; measure it, it limits the "
                         "rate (method/measurement.md)");
}

ValueMistakes check_settling_band(const Plan& plan, std::size_t /*row*/) {
  if (!(plan.target.contrast_settling_band_percent > 0)) return {};
  std::string lacks = lacks_own_contrasts(plan);
  if (lacks.empty() && plan.schedule.kind == ScheduleKind::adaptive)
    lacks = "needs [schedule] kind \"constant\" or \"ramp\"";
  if (lacks.empty()) return {};
  return {{std::nullopt, "a contrast of each presentation " + lacks}};
}

ValueMistakes check_force(const Plan& plan, std::size_t /*row*/) {
  ValueMistakes mistakes;
  for (std::size_t i = 0; i < plan.simulation.force.size(); ++i) {
    for (const auto skipped : plan.simulation.skip) {
      if (skipped != plan.simulation.force[i]) continue;
      mistakes.push_back({i, "'" + std::string(to_string(skipped)) + "' is also in skip"});
    }
  }
  return mistakes;
}

ValueMistakes check_mountings_per_plate(const Plan& plan, std::size_t /*row*/) {
  const TargetPlan& target = plan.target;
  const std::vector<int>& counts = target.mountings_per_plate;
  if (counts.size() > 1 && counts.size() != target.plates.size()) {
    return {{std::nullopt, "expected one number, or one for each of the " + std::to_string(target.plates.size()) +
                               " plates, found " + std::to_string(counts.size())}};
  }
  ValueMistakes mistakes;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > static_cast<int>(target.mountings.size())) {
      mistakes.push_back({i, "expected at most " + std::to_string(target.mountings.size()) +
                                 ", the number of mountings, found " + std::to_string(counts[i])});
    }
  }
  return mistakes;
}

ValueMistakes check_frames_per_presentation(const Plan& plan, std::size_t /*row*/) {
  const std::vector<int>& frames = plan.schedule.frames_per_presentation;
  if (frames.size() > 1 && frames.size() != plan.target.delta_t_k.size()) {
    return {{std::nullopt, "expected one number, or one for each of the " +
                               std::to_string(plan.target.delta_t_k.size()) + " contrasts of delta_t_k, found " +
                               std::to_string(frames.size())}};
  }
  if (plan.schedule.answers != AnswersChoice::binary || std::ranges::all_of(frames, [](int n) { return n <= 1; }))
    return {};
  return {{std::nullopt, "more than one frame needs answers = \"graded\": a binary answer is made from one frame"}};
}

ValueMistakes check_estimator(const Plan& plan, std::size_t /*row*/) {
  if (plan.schedule.answers != AnswersChoice::graded) return {};
  if (plan.fit.estimator == EstimatorChoice::weibull) {
    return {{std::nullopt,
             "answers = \"graded\" needs \"twin-shape\": the error of a Weibull function is larger than the interval "
             "of graded answers"}};
  }
  if (plan.fit.lapse == 0.0) return {};
  return {{std::nullopt, "graded answers need lapse = 0, because their observer does not lapse"}};
}

ValueMistakes check_transfer_steps(const Plan& plan, std::size_t /*row*/) {
  std::vector<double> steps = plan.measures.transfer_steps_k;
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  if (steps.size() >= 3) return {};
  return {{std::nullopt, "expected at least three different steps, found " + std::to_string(steps.size())}};
}

ValueMistakes check_pixels(const Plan& plan, std::size_t /*row*/) {
  constexpr int least_frames = 48;
  if (!plan.measures.pixels) return {};
  if (!plan.measures.noise)
    return {{std::nullopt, "the pixel search needs noise = true, because it uses the noise cube"}};
  if (plan.measures.noise_frames >= least_frames) return {};
  return {{std::nullopt, "the pixel search needs noise_frames of at least " + std::to_string(least_frames) +
                             ", found " + std::to_string(plan.measures.noise_frames)}};
}

ValueMistakes check_zone_name(const Plan& plan, std::size_t row) {
  const std::string& name = plan.limits.zones[row].name;
  if (name.empty()) return {{std::nullopt, "a zone needs a name"}};
  for (std::size_t other = 0; other < row; ++other)
    if (plan.limits.zones[other].name == name) return {{std::nullopt, "zone '" + name + "' is listed twice"}};
  if (!plan.measures.pixels) return {{std::nullopt, "limits of a zone need pixels = true in [measures]"}};
  return {};
}

ValueMistakes check_zone_area(const Plan& plan, std::size_t row) {
  const ZoneLimit& zone = plan.limits.zones[row];
  if (zone.name == whole_frame_zone || zone.area.size() != 4) return {};
  const auto& a = zone.area;
  if (!(a[0] < a[2]) || !(a[1] < a[3]))
    return {{std::nullopt, "expected left < right and top < bottom, for example [0.25, 0.25, 0.75, 0.75]"}};
  for (std::size_t other = 0; other < row; ++other) {
    const ZoneLimit& before = plan.limits.zones[other];
    if (before.name == whole_frame_zone || before.area.size() != 4) continue;
    const auto& b = before.area;
    if (a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3])
      return {{std::nullopt, "zone '" + zone.name + "' overlaps zone '" + before.name + "'"}};
  }
  return {};
}

ValueMistakes check_zone_limits(const Plan& plan, std::size_t row) {
  const ZoneLimit& zone = plan.limits.zones[row];
  if (zone.bad_pixels || zone.substituted_pixels || zone.clusters || zone.largest_cluster) return {};
  return {{std::nullopt, "zone '" + zone.name + "' has no limit: state at least one, or remove the zone"}};
}

ValueMistakes check_mtf_contrast(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.mtf || plan.measures.mtf_delta_t_k != 0) return {};
  return {{std::nullopt, "the MTF needs a contrast other than 0"}};
}

ValueMistakes check_ctf_contrast(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.ctf || plan.measures.ctf_delta_t_k != 0) return {};
  return {{std::nullopt, "the CTF needs a contrast other than 0"}};
}

ValueMistakes check_source_size_contrast(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.source_size || plan.measures.source_size_delta_t_k != 0) return {};
  return {{std::nullopt, "the size-of-source effect needs a contrast other than 0"}};
}

ValueMistakes check_absolute_temperatures(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.absolute) return {};
  const std::vector<double>& temperatures = plan.measures.absolute_temperatures_k;
  ValueMistakes mistakes;
  constexpr std::size_t least = 3;
  if (temperatures.size() < least)
    mistakes.push_back({std::nullopt, "expected at least three temperatures, found " +
                                          number_text(static_cast<double>(temperatures.size()))});
  for (std::size_t i = 1; i < temperatures.size(); ++i) {
    if (!(temperatures[i] > temperatures[i - 1]))
      mistakes.push_back({i, "temperatures must rise: expected more than " + number_text(temperatures[i - 1]) +
                                 " K, found " + number_text(temperatures[i]) + " K"});
  }
  if (plan.target.kind != TargetKind::scpi)
    mistakes.push_back({std::nullopt,
                        "absolute temperatures need a black body with an absolute set-point: [target] kind must be "
                        "\"scpi\""});
  return mistakes;
}

ValueMistakes check_distance(const Plan& plan, std::size_t /*row*/) {
  const CollimatorPlan& collimator = plan.target.collimator;
  constexpr double rounding = 1e-9;
  const double focal_length_m = 1e-3 * collimator.focal_length_mm;
  if (!collimator.stated() || std::abs(plan.target.distance_m / focal_length_m - 1) < rounding) return {};
  return {{std::nullopt, "the plan states a distance of " + number_text(plan.target.distance_m) +
                             " m and a collimator of " + number_text(collimator.focal_length_mm) +
                             " mm: remove one of them"}};
}

ValueMistakes check_focal_length(const Plan& plan, std::size_t /*row*/) {
  const CollimatorPlan& collimator = plan.target.collimator;
  if (!collimator.stated()) {
    if (collimator == CollimatorPlan{}) return {};
    return {{std::nullopt, "missing: the angle of a triangle is its size over the focal length of the collimator"}};
  }
  if (plan.target.kind == TargetKind::display)
    return {{std::nullopt, "a monitor is not shown through a collimator: [target] kind must not be \"display\""}};
  return {};
}

ValueMistakes check_collimator_table(const Plan& plan, std::size_t /*row*/) {
  const CollimatorPlan& collimator = plan.target.collimator;
  const std::vector<double>& wavelengths = collimator.wavelengths_um;
  if (wavelengths.size() != collimator.transmissions.size())
    return {{std::nullopt, "expected one transmission for each of " +
                               number_text(static_cast<double>(wavelengths.size())) + " wavelengths, found " +
                               number_text(static_cast<double>(collimator.transmissions.size()))}};
  for (std::size_t i = 1; i < wavelengths.size(); ++i) {
    if (!(wavelengths[i] > wavelengths[i - 1]))
      return {{std::nullopt, "wavelengths must rise, found " + number_text(wavelengths[i]) + " um after " +
                                 number_text(wavelengths[i - 1]) + " um"}};
  }
  return {};
}

ValueMistakes check_mrtd(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.mrtd || plan.target.kind != TargetKind::display) return {};
  return {{std::nullopt, "the MRTD needs contrasts far below a grey level of a monitor: use a black body"}};
}

ValueMistakes check_mrtd_contrasts(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.mrtd) return {};
  std::vector<double> contrasts = plan.measures.mrtd_delta_t_k;
  std::sort(contrasts.begin(), contrasts.end());
  contrasts.erase(std::unique(contrasts.begin(), contrasts.end()), contrasts.end());
  if (contrasts.size() < 3 || contrasts.size() != plan.measures.mrtd_delta_t_k.size())
    return {{std::nullopt, "expected at least three contrasts, each stated once"}};
  return {};
}

ValueMistakes check_response(const Plan& plan, std::size_t /*row*/) {
  const bool settling = plan.measures.gain_control;
  if (!plan.measures.response && !settling) return {};
  ValueMistakes mistakes;
  if (plan.measures.response_delta_t_k == 0)
    mistakes.push_back({std::nullopt, "the response time needs a contrast other than 0"});
  if (settling && plan.target.kind != TargetKind::scene && !plan.measures.response_settling_ms)
    mistakes.push_back(
        {std::nullopt, "the settling of the gain needs response_settling_ms: a slow step of the target hides it"});
  if (plan.measures.response && plan.target.kind != TargetKind::scene && !plan.measures.response_settling_ms)
    mistakes.push_back(
        {std::nullopt,
         "the response time needs response_settling_ms: a slow step of the target hides the response of the camera"});
  return mistakes;
}

ValueMistakes check_limit_contrast(const Plan& plan, std::size_t row) {
  ValueMistakes mistakes;
  const double limit = plan.limits.acuity[row].delta_t_k;
  bool shown = false;
  for (const double contrast : plan.target.delta_t_k) shown = shown || same_contrast(limit, contrast);
  if (is_ramp(plan) && plan.schedule.from_delta_t_k && plan.schedule.to_delta_t_k) {
    const double to = *plan.schedule.to_delta_t_k;
    shown = shown || (limit / to >= 1 && limit / to <= *plan.schedule.from_delta_t_k / to);
  }
  if (!shown) mistakes.push_back({std::nullopt, number_text(limit) + " K is not among the contrasts of [target]"});
  for (std::size_t other = 0; other < row; ++other) {
    if (same_contrast(limit, plan.limits.acuity[other].delta_t_k))
      mistakes.push_back({std::nullopt, "a second limit at " + number_text(limit) + " K"});
  }
  return mistakes;
}

ValueMistakes check_margin(const Plan& plan, std::size_t /*row*/) {
  const auto& margin = plan.limits.equivalence_margin_percent;
  if (!margin || plan.limits.rule == ConformityRule::simple) return {};
  // Two one-sided tests at 5 %. Contrast rows are left out because the slope of the curve is not known yet.
  const double stated = known_u_of_acuity(plan, BudgetCommon::twin);
  if (1.645 * stated < std::log1p(*margin / 100)) return {};
  return {{std::nullopt, "no unit can pass: the budget alone gives a ratio of acuities an uncertainty of " +
                             number_text(std::round(16450 * stated) / 100) + " % (90 %), but the margin is " +
                             number_text(*margin) + " %"}};
}

ValueMistakes check_limited_measure(const Plan& plan, std::size_t row) {
  const std::string& name = plan.limits.measures[row].measure;
  const Quantity* quantity = find_limited_quantity(name);
  if (quantity == nullptr) return {};
  ValueMistakes mistakes;
  for (const std::string_view needed : {quantity->measure, quantity->second_measure}) {
    for (const MeasureKey& key : measure_keys) {
      if (key.name == needed && !(plan.measures.*key.requested))
        mistakes.push_back(
            {std::nullopt, "a limit on " + name + " needs " + std::string(needed) + " = true in [measures]"});
    }
  }
  for (std::size_t other = 0; other < row; ++other) {
    if (plan.limits.measures[other].measure == name) mistakes.push_back({std::nullopt, "a second row for " + name});
  }
  return mistakes;
}

ValueMistakes check_fleet_measure(const Plan& plan, std::size_t row) {
  const FleetRow& fleet = plan.limits.fleets[row];
  const bool acuity = fleet.measure == fleet_acuity;
  if (!acuity && find_limited_quantity(fleet.measure) == nullptr)
    return {
        {std::nullopt, "expected acuity or a measure that can have a limit, found '" + one_line(fleet.measure) + "'"}};
  if (acuity && !fleet.delta_t_k) return {{std::nullopt, "a fleet of acuities needs delta_t_k"}};
  for (std::size_t other = 0; other < row; ++other) {
    const FleetRow& earlier = plan.limits.fleets[other];
    if (earlier.measure != fleet.measure) continue;
    if (!acuity || (earlier.delta_t_k && same_contrast(*earlier.delta_t_k, *fleet.delta_t_k)))
      return {{std::nullopt, "a second row for " + fleet.measure}};
  }
  return {};
}

ValueMistakes check_measure_limits(const Plan& plan, std::size_t row) {
  const MeasureLimit& limits = plan.limits.measures[row];
  const std::string& name = limits.measure;
  const Quantity* quantity = find_limited_quantity(name);
  if (quantity == nullptr) return {};
  if (!limits.at_least && !limits.at_most) return {{std::nullopt, name + " has no limit: state at_least or at_most"}};
  if (limits.at_least && !quantity->at_least.possible())
    return {{std::nullopt, name + " has no lower limit, only an upper one"}};
  if (limits.at_most && !quantity->at_most.possible())
    return {{std::nullopt, name + " has no upper limit, only a lower one"}};
  if (!limits.at_least || !limits.at_most) return {};
  if (*limits.at_least >= *limits.at_most)
    return {{std::nullopt, "no unit can pass: the lower limit of " + name + " is not below the upper limit"}};
  if (plan.limits.rule == ConformityRule::simple) return {};
  const double expanded = 1.96 * relative_u(plan, quantity->stated) * 0.5 * (*limits.at_least + *limits.at_most);
  if (2 * expanded < *limits.at_most - *limits.at_least) return {};
  return {{std::nullopt, "no unit can pass: the budget alone gives " + name + " an expanded uncertainty of " +
                             number_text(std::round(1e6 * expanded) / 1e6) + ", but the tolerance is " +
                             number_text(std::round(1e6 * (*limits.at_most - *limits.at_least)) / 1e6)}};
}

ValueMistakes check_require(const Plan& plan, std::size_t /*row*/) {
  if (!plan.uncertainty.require) return {};
  std::string missing;
  for (const BudgetInput input : not_stated(budget_with_collimator(plan, {}))) {
    // The run adds this row itself.
    if (input == BudgetInput::air_path && plan.target.air_humidity_percent > 0 && plan.target.kind != TargetKind::scene)
      continue;
    missing += (missing.empty() ? "" : ", ") + std::string(to_string(input));
  }
  if (missing.empty()) return {};
  return {{std::nullopt, "the budget must be complete, but it does not state " + missing}};
}

ValueMistakes check_budget_name(const Plan& plan, std::size_t row) {
  const std::string& name = plan.uncertainty.rows[row].name;
  for (const std::string_view own : {finite_trials_row, seen_contrast_row, contrast_lag_row, read_back_row}) {
    if (name == own) return {{std::nullopt, "the run itself adds the row \"" + name + "\": use another name"}};
  }
  for (std::size_t other = 0; other < row; ++other) {
    if (plan.uncertainty.rows[other].name == name)
      return {{std::nullopt, "row '" + one_line(name) + "' is listed twice"}};
  }
  return {};
}

ValueMistakes check_budget_unit(const Plan& plan, std::size_t row) {
  const BudgetRow& stated = plan.uncertainty.rows[row];
  const BudgetInput input = input_of(stated);
  if (stated.sensitivity) return {};
  const std::string of = "row '" + one_line(stated.name) + "' enters " + std::string(to_string(input));
  const auto unit = budget_unit(kind_of(input), stated.unit);
  if (!unit) {
    return {{std::nullopt, of + ": expected " +
                               (kind_of(input) == InputKind::geometry   ? "\"mm\", \"%\" or \"1\""
                                : kind_of(input) == InputKind::contrast ? "\"K\", \"mK\", \"%\" or \"1\""
                                                                        : "\"%\" or \"1\"") +
                               ", or a sensitivity, found \"" + one_line(stated.unit) + "\""}};
  }
  if (!unit->relative && input == BudgetInput::ifov)
    return {{std::nullopt, of + ": expected \"%\" or \"1\", found \"" + one_line(stated.unit) + "\""}};
  return {};
}

ValueMistakes check_coverage_factor(const Plan& plan, std::size_t row) {
  const BudgetRow& stated = plan.uncertainty.rows[row];
  if (stated.coverage_factor == 1 || stated.distribution == BudgetDistribution::normal) return {};
  return {{std::nullopt, "row '" + one_line(stated.name) + "': only a normal distribution has a coverage factor"}};
}

ValueMistakes check_due_date(const Plan& plan, std::size_t row) {
  const std::string& date = plan.instruments[row].calibration_due;
  if (date.empty() || parse_date(date)) return {};
  return {{std::nullopt, "expected a date \"YYYY-MM-DD\", found \"" + one_line(date) + "\""}};
}

ValueMistakes check_module_command(const Plan& plan, std::size_t row) {
  if (!plan.modules[row].command.empty()) return {};
  return {{std::nullopt, "expected a command, found an empty text"}};
}

ValueMistakes check_module_place(const Plan& plan, std::size_t row) {
  if (plan.fit.estimator == EstimatorChoice::twin_shape)
    return {{std::nullopt,
             "with a module, [fit] estimator must be 'weibull' or 'automatic': the function of the sensor does not "
             "include the module"}};
  if (plan.modules[row].place != ModulePlace::observer) {
    if (plan.schedule.answers != AnswersChoice::graded) return {};
    return {{std::nullopt,
             "with a module, [schedule] answers must be 'binary' or 'automatic': graded answers need the function of "
             "the sensor, which does not include the module"}};
  }
  for (std::size_t i = 0; i < row; ++i) {
    if (plan.modules[i].place == ModulePlace::observer)
      return {{std::nullopt, "a second module with place = \"observer\": only one is possible"}};
  }
  if (plan.schedule.answers == AnswersChoice::graded)
    return {{std::nullopt,
             "an observer module gives no graded answers: [schedule] answers must be 'binary' or 'automatic'"}};
  return {};
}

std::optional<std::chrono::year_month_day> parse_date(std::string_view text) {
  const auto digits = [&](std::size_t first, std::size_t count) {
    int value = -1;
    const auto [end, problem] = std::from_chars(text.data() + first, text.data() + first + count, value);
    return problem == std::errc() && end == text.data() + first + count ? value : -1;
  };
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  const int year = digits(0, 4), month = digits(5, 2), day = digits(8, 2);
  if (year < 0 || month < 0 || day < 0) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  return date.ok() ? std::optional(date) : std::nullopt;
}

Result<void> check_calibration(const Plan& plan, std::chrono::year_month_day today) {
  std::string overdue;
  for (const InstrumentPlan& instrument : plan.instruments) {
    const std::optional<std::chrono::year_month_day> due = parse_date(instrument.calibration_due);
    if (!due || *due >= today) continue;
    overdue += (overdue.empty() ? "" : ", ") + instrument.name +
               (instrument.serial.empty() ? "" : " " + instrument.serial) + " (due " + instrument.calibration_due + ")";
  }
  if (!overdue.empty()) return fail(ErrorCode::calibration, "calibration overdue: " + overdue);
  return {};
}

}  // namespace todbench
