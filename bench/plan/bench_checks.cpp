// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/bench_checks.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include "acquisition/core/camera_id.h"
#include "acquisition/core/control_text.h"
#include "bench/plan/collimator.h"
#include "bench/text/text.h"
#include "bench/text/unit_hint.h"
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

ValueMistakes check_distance(const Plan& plan, std::size_t /*row*/) {
  const CollimatorPlan& collimator = plan.target.collimator;
  constexpr double rounding = 1e-9;
  const double focal_length_m = 1e-3 * collimator.focal_length_mm;
  if (!collimator.stated() || collimator.focal_length_mm < least_focal_length_mm ||
      std::abs(plan.target.distance_m / focal_length_m - 1) < rounding)
    return {};
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
  constexpr NumberRange possible = NumberRange::between(least_focal_length_mm, 1e5);
  if (!possible.contains(collimator.focal_length_mm))
    return {{std::nullopt, "expected " + possible.describe() + ", found " + number_text(collimator.focal_length_mm) +
                               unit_hint("focal_length_mm", collimator.focal_length_mm, possible)}};
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
