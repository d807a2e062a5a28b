// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/chain_options.h"

#include <utility>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/plan/loaded_plan.h"
#include "bench/plan/resources.h"
#include "bench/text/text.h"

namespace todbench {

void add_display_option(CLI::App& command, std::string& display) {
  command.add_option("--display", display,
                     "plan, name or file, whose section [display] an observer with an eye (hvs-2) needs");
}

Result<TemplateObserverSpec> load_observer_at(const std::string& observer, const std::string& display) {
  TODBENCH_TRY(const Resource resource, find_resource(ResourceKind::observer, observer));
  TODBENCH_TRY(TemplateObserverSpec spec, parse_observer(resource));
  if (!spec.eye) return spec;
  if (display.empty())
    return fail_at(ErrorCode::invalid_input, observer,
                   "the observer has an eye and needs a display; state a plan with a section [display] with --display, "
                   "or use an observer without an eye (hvs-1)");
  const auto plan = load_plan(display);
  if (!plan) return tl::unexpected(with_context("--display", plan.error()));
  if (!has_display(*plan))
    return fail(ErrorCode::invalid_input, "--display: the plan " + one_line(display) + " has no section [display]");
  if (auto shown = validate(plan->display); !shown) return tl::unexpected(with_context("--display", shown.error()));
  spec.display = plan->display;
  return spec;
}

void ChainOptions::add_sensor_to(CLI::App& command) {
  command.add_option("--sensor", sensor, "sensor: name or file")->required();
}

void ChainOptions::add_to(CLI::App& command, const std::string& sentence_of_observer) {
  command
      .add_option("--atmosphere", atmosphere,
                  "atmosphere along the path: clear, us-standard, midlatitude-summer, midlatitude-winter, "
                  "subarctic-winter, tropical, beer-lambert (with --extinction-per-km), a CSV file or a MODTRAN tape7")
      ->capture_default_str();
  command.add_option("--haze", haze, "aerosol model of the shipped atmospheres")->capture_default_str();
  command
      .add_option("--extinction-per-km", extinction_per_km,
                  "extinction coefficient of the contrast in 1/km; with the atmosphere clear, a value above 0 selects "
                  "beer-lambert")
      ->check(number_in(0, 1e4))
      ->capture_default_str();
  command.add_option("--microscan", microscan, "samples per detector pitch and axis; default: the value of the sensor")
      ->check(whole_number(1, 4));
  command.add_option("--observer", observer, sentence_of_observer)->capture_default_str();
  add_display_option(command, display);
  command.add_option("--accuracy", accuracy, "accuracy of the simulation: draft, normal or reference")
      ->check(CLI::IsMember({"draft", "normal", "reference"}))
      ->capture_default_str();
}

Result<SeeingChain> ChainOptions::load() const {
  TODBENCH_TRY(auto spec, load_sensor(sensor));
  if (microscan > 0) spec.microscan = microscan;
  TODBENCH_TRY(auto seeing, load_observer_at(observer, display));
  TODBENCH_TRY(const auto level, Accuracy::named(accuracy));
  const bool beer = extinction_per_km > 0 && atmosphere == "clear";
  auto air =
      load_atmosphere(beer ? "beer-lambert" : atmosphere, {.band = {spec.wavelength_min_um, spec.wavelength_max_um},
                                                           .haze = haze,
                                                           .weight_temperature_k = spec.scene_temperature_k,
                                                           .extinction_per_km = extinction_per_km});
  if (!air) return tl::unexpected(air.error());
  return SeeingChain{std::move(spec), std::move(seeing), level, *std::move(air)};
}

}  // namespace todbench
