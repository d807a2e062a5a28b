// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/eye/viewed_display.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "acquisition/base/try.h"
#include "hvs/eye/sinc.h"

namespace todbench {
namespace {

constexpr double inch_mm = 25.4;

double black(const ViewedDisplay& display) {
  return luminance_cd_m2(display, 0);
}

double white(const ViewedDisplay& display) {
  return luminance_cd_m2(display, 1);
}

/// The level of the background: luminance rises with the level, so that halving finds it.
double background_level(const ViewedDisplay& display) {
  const double middle = (black(display) + white(display)) / 2;
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double level = (low + high) / 2;
    (luminance_cd_m2(display, level) < middle ? low : high) = level;
  }
  return (low + high) / 2;
}

tl::unexpected<Error> refuse(std::string_view key, std::string reason) {
  return fail_at(ErrorCode::invalid_input, std::string(key), std::move(reason));
}

Result<void> check_pixels(const ViewedDisplay& display) {
  const bool by_size = display.diagonal_in > 0 || !display.pixels.empty();
  if (display.pixel_pitch_mm > 0 && by_size)
    return refuse("pixel_pitch_mm", "state either the pixel pitch, or diagonal_in and pixels");
  if (!(display.pixel_pitch_mm > 0) && !(display.diagonal_in > 0 && display.pixels.size() == 2)) {
    return refuse("pixel_pitch_mm",
                  "the size of a display pixel is unknown: state pixel_pitch_mm, or diagonal_in and pixels "
                  "(columns and rows)");
  }
  if (by_size && !(display.pixels[0] >= 1 && display.pixels[1] >= 1))
    return refuse("pixels", "expected columns and rows, at least 1 each");
  const double pitch_mm = pixel_pitch_mm(display);
  if (!(pitch_mm >= 1e-3 && pitch_mm <= 10))
    return refuse("pixel_pitch_mm",
                  fmt::format("a pixel pitch of {:g} mm is outside the range of 0.001 to 10 mm", pitch_mm));
  if (!(display.zoom >= 1 && display.zoom <= 64 && display.zoom == std::floor(display.zoom)))
    return refuse("zoom", fmt::format("expected a whole number from 1 to 64, found {:g}", display.zoom));
  if (!(display.spot_mm >= 0 && display.spot_mm <= 10 * pitch_mm * display.zoom))
    return refuse("spot_mm",
                  fmt::format("a spot of {:g} mm is outside the range of 0 to 10 displayed samples", display.spot_mm));
  return {};
}

Result<void> check_distance(const ViewedDisplay& display) {
  const double distance_m = display.viewing_distance_m;
  if (distance_m > 20) {
    return refuse("viewing_distance_m",
                  fmt::format("{:g} m is no distance at which a person views a display; it is in metres, so state "
                              "{:g} for {:g} mm",
                              distance_m, distance_m / 1000, distance_m));
  }
  if (!(distance_m >= 0.05))
    return refuse("viewing_distance_m",
                  fmt::format("expected metres from the eye to the display, at least 0.05, found {:g}", distance_m));
  const double arcmin = arcmin_per_sample(display);
  if (!(arcmin >= 0.05 && arcmin <= 120)) {
    return refuse("viewing_distance_m",
                  fmt::format("a displayed sample is {:.3g} arcmin at {:g} m, outside the range of 0.05 to 120 arcmin",
                              arcmin, distance_m));
  }
  return {};
}

Result<void> check_table(const ViewedDisplay& display) {
  const std::vector<double>& table = display.luminance_table;
  if (table.size() < 2) return refuse("luminance_table", "expected at least two luminances, from black to white");
  if (display.luminance_white_cd_m2 > 0 || display.luminance_black_cd_m2 > 0)
    return refuse("luminance_table",
                  "the table contains the luminances of white and black: leave out "
                  "luminance_white_cd_m2 and luminance_black_cd_m2");
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!(table[i] >= 0 && table[i] <= 1e5))
      return refuse("luminance_table",
                    fmt::format("value {}: expected 0 to 100000 cd/m2, found {:g}", i + 1, table[i]));
    if (i > 0 && table[i] < table[i - 1]) {
      return refuse("luminance_table", fmt::format("the luminance falls from {:g} to {:g} cd/m2 at value {}; it must "
                                                   "rise from black to white",
                                                   table[i - 1], table[i], i + 1));
    }
  }
  return {};
}

Result<void> check_luminance(const ViewedDisplay& display) {
  if (!display.luminance_table.empty()) {
    TODBENCH_TRY_VOID(check_table(display));
  } else {
    if (!(display.gamma >= 0.2 && display.gamma <= 5))
      return refuse("gamma", fmt::format("expected 0.2 to 5, found {:g}", display.gamma));
    if (!(display.luminance_black_cd_m2 >= 0)) return refuse("luminance_black_cd_m2", "a luminance is not negative");
  }
  const std::string_view key = display.luminance_table.empty() ? "luminance_white_cd_m2" : "luminance_table";
  if (!(white(display) >= 0.01 && white(display) <= 1e5)) {
    return refuse(key, fmt::format("a white of {:g} cd/m2 is outside the range of the model of the eye: expected "
                                   "0.01 to 100000 cd/m2",
                                   white(display)));
  }
  if (!(black(display) < white(display))) {
    return refuse(key, fmt::format("white ({:g} cd/m2) must be brighter than black ({:g} cd/m2)", white(display),
                                   black(display)));
  }
  if (!(display.veil_cd_m2 >= 0 && display.veil_cd_m2 <= 1e5))
    return refuse("veil_cd_m2", fmt::format("expected 0 to 100000 cd/m2, found {:g}", display.veil_cd_m2));
  return {};
}

}  // namespace

Result<void> validate(const ViewedDisplay& display) {
  for (const auto check : {check_pixels, check_distance, check_luminance}) {
    TODBENCH_TRY_VOID(check(display));
  }
  if (!(display.span_k >= 0 && display.span_k <= 1e6))
    return refuse("span_k", fmt::format("expected 0 to 1000000 K, found {:g}", display.span_k));
  if (!(display.contrast > 0))
    return refuse("contrast", fmt::format("expected a luminance contrast above 0, found {:g}", display.contrast));
  if (display.span_k == 0 && display.contrast > largest_contrast(display) * (1 + 1e-9)) {
    return refuse("contrast", fmt::format("the display cannot show a luminance contrast of {:g}: between black, white "
                                          "and veil the largest is {:.3g}",
                                          display.contrast, largest_contrast(display)));
  }
  return {};
}

double pixel_pitch_mm(const ViewedDisplay& display) {
  if (display.pixel_pitch_mm > 0) return display.pixel_pitch_mm;
  return display.diagonal_in * inch_mm / std::hypot(display.pixels[0], display.pixels[1]);
}

double luminance_cd_m2(const ViewedDisplay& display, double level) {
  const std::vector<double>& table = display.luminance_table;
  if (table.empty()) {
    return display.luminance_black_cd_m2 +
           (display.luminance_white_cd_m2 - display.luminance_black_cd_m2) * std::pow(level, display.gamma);
  }
  const double at = level * static_cast<double>(table.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), table.size() - 2);
  const double share = at - static_cast<double>(below);
  return table[below] + share * (table[below + 1] - table[below]);
}

double arcmin_per_sample(const ViewedDisplay& display) {
  const double half_m = pixel_pitch_mm(display) * display.zoom / 2000;
  return 2 * std::atan(half_m / display.viewing_distance_m) * 60 * 180 / std::numbers::pi;
}

double adaptation_luminance_cd_m2(const ViewedDisplay& display) {
  return (black(display) + white(display)) / 2 + display.veil_cd_m2;
}

double largest_contrast(const ViewedDisplay& display) {
  return (white(display) - black(display)) / 2 / adaptation_luminance_cd_m2(display);
}

Result<double> luminance_contrast(const ViewedDisplay& display, double delta_t_k) {
  if (display.span_k == 0) return display.contrast;
  const double level = background_level(display);
  const double step = std::abs(delta_t_k) / display.span_k;
  if (step > level || step > 1 - level) {
    return refuse("span_k", fmt::format("a contrast of {:g} K cannot be shown: a display that spans {:g} K from black "
                                        "to white shows at most {:.3g} K on a background in the middle of its "
                                        "luminances",
                                        delta_t_k, display.span_k, display.span_k * std::min(level, 1 - level)));
  }
  return shown_contrast(display, delta_t_k);
}

double shown_contrast(const ViewedDisplay& display, double delta_t_k) {
  if (display.span_k == 0) return display.contrast;
  const double level = background_level(display);
  const double step = std::min({std::abs(delta_t_k) / display.span_k, level, 1 - level});
  return (luminance_cd_m2(display, level + step) - luminance_cd_m2(display, level - step)) / 2 /
         adaptation_luminance_cd_m2(display);
}

double display_transfer(const ViewedDisplay& display, double u, double w) {
  const auto axis = [&](double f) {
    if (display.interpolation == DisplayInterpolation::hold || display.zoom == 1) return sinc(f);
    return sinc(f) * sinc(f) * sinc(f / display.zoom);  // triangle of two samples, drawn with square pixels
  };
  const double sigma = std::numbers::pi * display.spot_mm / (pixel_pitch_mm(display) * display.zoom);
  return axis(u) * axis(w) * std::exp(-2 * sigma * sigma * (u * u + w * w));
}

std::optional<std::string> small_sample_warning(const ViewedDisplay& display) {
  // At 2 arcmin the SC2000 loses about 15 % of its acuity to the eye, at 3 arcmin 5 %.
  constexpr double small_arcmin = 2;
  const double arcmin = arcmin_per_sample(display);
  if (arcmin >= small_arcmin) return std::nullopt;
  const double wanted = std::ceil(3 / arcmin * display.zoom);
  return fmt::format(
      "at {:g} m a displayed sample is {:.2g} arcmin: the eye, not the camera, will limit this test. With a zoom of "
      "{:g} it would be {:.2g} arcmin",
      display.viewing_distance_m, arcmin, wanted, arcmin * wanted / display.zoom);
}

}  // namespace todbench
