// SPDX-License-Identifier: GPL-3.0-or-later
// Plan keys of the display that a person views.
#include "bench/plan/plan_sections.h"

#include <algorithm>
#include <string>

#include "bench/plan/key_places.h"

namespace todbench {

namespace {

/// The numbers are checked together, by sentences (validate() of a display).
constexpr NumberRange wide = NumberRange::between(0, 1e9);

/// Whether every number is in the range of its key. Otherwise that key has the mistake.
bool in_range(const ViewedDisplay& display) {
  const auto possible = [](double value) { return wide.contains(value); };
  const double numbers[] = {display.pixel_pitch_mm,
                            display.diagonal_in,
                            display.viewing_distance_m,
                            display.luminance_white_cd_m2,
                            display.luminance_black_cd_m2,
                            display.gamma,
                            display.veil_cd_m2,
                            display.zoom,
                            display.spot_mm,
                            display.contrast,
                            display.span_k};
  return std::ranges::all_of(numbers, possible) && std::ranges::all_of(display.pixels, possible) &&
         std::ranges::all_of(display.luminance_table, possible);
}

/// Returns the mistake of the display that belongs to this key.
std::function<std::vector<ValueMistake>(const Plan&, std::size_t)> check_of(std::string_view name) {
  return [name](const Plan& plan, std::size_t) -> std::vector<ValueMistake> {
    if (!has_display(plan) || !in_range(plan.display)) return {};
    Result<void> possible = validate(plan.display);
    for (const double delta_t_k : plan.target.delta_t_k) {
      if (!possible) break;
      if (const auto shown = luminance_contrast(plan.display, delta_t_k); !shown)
        possible = tl::unexpected(shown.error());
    }
    if (possible || !possible.error().key || possible.error().key->name != name) return {};
    return {{std::nullopt, possible.error().key->reason}};
  };
}

PlanKey key(std::string_view name, KeyType type, std::string_view unit, std::string_view sentence, KeyPlace place,
            FormLine form = {}) {
  return {.name = name,
          .type = std::move(type),
          .unit = unit,
          .sentence = sentence,
          .place = std::move(place),
          .form = form,
          .check = check_of(name),
          .written_at_default = false};
}

}  // namespace

PlanSection display_section() {
  const auto number = [](std::string_view name, std::string_view unit, std::string_view sentence,
                         double ViewedDisplay::*member, FormLine form = {}) {
    return key(name, NumberKey{wide}, unit, sentence, in(&Plan::display, member), form);
  };
  const auto numbers = [](std::string_view name, std::string_view unit, std::string_view sentence,
                          std::vector<double> ViewedDisplay::*member) {
    return key(name, NumbersKey{wide, "number", {}, MayBeEmpty::yes}, unit, sentence, in(&Plan::display, member));
  };
  return {
      .name = "display",
      .sentence = "The display of the operator and its viewing distance. Required by an observer with an eye (hvs-2).",
      .keys = {
          number("pixel_pitch_mm", "mm", "Distance of two display pixels", &ViewedDisplay::pixel_pitch_mm,
                 {"Pixel pitch", "planDisplayPitch"}),
          number("diagonal_in", "inch", "Diagonal of the picture area, with pixels in place of pixel_pitch_mm",
                 &ViewedDisplay::diagonal_in),
          numbers("pixels", "", "Columns and rows of the display", &ViewedDisplay::pixels),
          number("viewing_distance_m", "m", "Distance from the eye to the display", &ViewedDisplay::viewing_distance_m,
                 {"Viewing distance", "planDisplayDistance"}),
          number("luminance_white_cd_m2", "cd/m2", "Luminance of white without ambient light",
                 &ViewedDisplay::luminance_white_cd_m2, {"Luminance of white", "planDisplayWhite"}),
          number("luminance_black_cd_m2", "cd/m2", "Luminance of black without ambient light",
                 &ViewedDisplay::luminance_black_cd_m2, {"Luminance of black", "planDisplayBlack"}),
          number("gamma", "", "Exponent of luminance over level", &ViewedDisplay::gamma, {"Gamma", "planDisplayGamma"}),
          numbers("luminance_table", "cd/m2",
                  "Luminances at equal steps of the level, from black to white, in place of white, black and gamma",
                  &ViewedDisplay::luminance_table),
          number("veil_cd_m2", "cd/m2", "Ambient light that the display reflects", &ViewedDisplay::veil_cd_m2,
                 {"Reflected ambient light", "planDisplayVeil"}),
          number("zoom", "", "Display pixels per displayed sample, along an axis", &ViewedDisplay::zoom,
                 {"Zoom", "planDisplayZoom"}),
          key("interpolation", ChoiceKey{names_of(all_display_interpolations)}, "",
              "Filling of the pixels between samples: squares (hold), or bilinear (linear)",
              in(&Plan::display, &ViewedDisplay::interpolation), {"Between the samples", "planDisplayInterpolation"}),
          number("spot_mm", "mm", "Standard deviation of the spot of a CRT; 0: sharp pixels", &ViewedDisplay::spot_mm,
                 {"Spot of a CRT", "planDisplaySpot"}),
          number("contrast", "", "Luminance contrast at which the operator shows every target by setting the gain",
                 &ViewedDisplay::contrast, {"Luminance contrast", "planDisplayContrast"}),
          number("span_k", "K", "Temperature span from black to white at a fixed gain, in place of contrast; 0: none",
                 &ViewedDisplay::span_k, {"Span at a fixed gain", "planDisplaySpan"}),
          {.name = "as_operator",
           .type = FlagKey{},
           .sentence = "Whether the report states the thresholds of hvs-2 at this display beside those of the observer",
           .place = in_plan(&Plan::display_as_operator),
           .form = {"Thresholds of hvs-2 in the report", "planDisplayAsOperator"},
           .check = [](const Plan& plan, std::size_t) -> std::vector<ValueMistake> {
             if (!plan.display_as_operator || has_display(plan)) return {};
             return {{std::nullopt, "state the display: pixel pitch, viewing distance and luminance"}};
           },
           .written_at_default = false},
      }};
}

}  // namespace todbench
