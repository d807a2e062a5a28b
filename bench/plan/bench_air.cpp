// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/bench_air.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "acquisition/base/try.h"
#include "bench/plan/atmospheres.h"

namespace todbench {
namespace {

/// Water vapour at the ground in the model atmospheres of the shipped table (Anderson et al. 1986, AFGL-TR-86-0110).
struct ModelHumidity {
  std::string_view name;
  double g_m3;
};
constexpr std::array model_humidities{ModelHumidity{"subarctic-winter", 1.2}, ModelHumidity{"midlatitude-winter", 3.5},
                                      ModelHumidity{"us-standard", 5.9}, ModelHumidity{"midlatitude-summer", 14.0},
                                      ModelHumidity{"tropical", 19.0}};
constexpr double most_g_m3 = 30;

}  // namespace

double absolute_humidity_g_m3(const BenchAir& air) {
  constexpr double gas_constant_j_kg_k = 461.5;  // of water vapour
  const double saturation_pa = 611.2 * std::exp(17.62 * air.temperature_c / (243.12 + air.temperature_c));
  return 1000 * air.humidity_percent / 100 * saturation_pa / (gas_constant_j_kg_k * (air.temperature_c + 273.15));
}

Result<double> bench_transmittance(const BenchAir& air, double length_m, const SpectralBand& band) {
  const double water = absolute_humidity_g_m3(air);
  if (!(water >= 0 && water <= most_g_m3)) {
    return fail(
        ErrorCode::invalid_input,
        fmt::format("air of {:g} °C and {:g} % humidity contains {:.3g} g/m3 of water, but the tables end at {:g} g/m3",
                    air.temperature_c, air.humidity_percent, water, most_g_m3));
  }
  if (!(std::isfinite(length_m) && length_m > 0))
    return fail(ErrorCode::invalid_input, "the path of air must be longer than 0 m");
  std::vector<double> depths;
  for (const ModelHumidity& model : model_humidities) {
    TODBENCH_TRY(const auto found, load_atmosphere(model.name, {.band = band, .haze = "none"}));
    const auto depth = found.air.optical_depth(length_m);
    if (!depth) {
      return fail(ErrorCode::invalid_input,
                  fmt::format("the tables of transmittance end at {:g} m, but the path of air is {:g} m long",
                              found.air.end_m(), length_m));
    }
    depths.push_back(*depth);
  }
  std::size_t above = 1;
  while (above + 1 < depths.size() && model_humidities[above].g_m3 < water) ++above;
  const auto &low = model_humidities[above - 1], &high = model_humidities[above];
  const double share = (water - low.g_m3) / (high.g_m3 - low.g_m3);
  // Extrapolation to dry air leaves the absorption of the other gases: the optical depth is at least 0.
  return std::exp(-std::max(0.0, depths[above - 1] + share * (depths[above] - depths[above - 1])));
}

}  // namespace todbench
