// SPDX-License-Identifier: GPL-3.0-or-later
// The same bits from two threads, and the published threshold of the first case of the reference set.
#include <array>
#include <bit>
#include <cmath>
#include <future>

#include "acquisition/base/try.h"
#include "bench/reference_set/reference_case.h"
#include "bench/selftest/selftest_cases.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

PlateScene one_triangle() {
  PlateScene scene;
  scene.plate.triangles = {{.name = "only", .position_mm = {10, -20}, .size_mm = 12, .apex = Apex::right}};
  scene.delta_t_k = 1.93;
  return scene;
}

/// Frames of one sensor have one size.
double different_pixels(const cv::Mat1w& a, const cv::Mat1w& b) {
  return cv::countNonZero(a != b);
}

bool same_bits(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || std::bit_cast<std::uint64_t>(*a) == std::bit_cast<std::uint64_t>(*b));
}

}  // namespace

void add_same_bits(SelftestCases& cases) {
  const SensorSpec spec;
  const SensorModel model(spec, full_plan(spec, {}, {}), Accuracy::normal(), 1);
  const auto frame = [&](std::uint64_t index) { return model.expose(one_triangle(), index); };
  const cv::Mat1w third = frame(3), fourth = frame(4);
  auto other = std::async(std::launch::async, frame, 4);
  const cv::Mat1w again = frame(3), at_the_same_time = other.get();
  cases.push_back({"same bits", "pixels that differ in a frame made again", different_pixels(third, again), 0, 0});
  cases.push_back({"same bits", "pixels that differ in a frame of a second thread",
                   different_pixels(fourth, at_the_same_time), 0, 0});
  const std::vector<HardFit> fits = hard_fits();
  const auto fitted = [&] {
    std::vector<PsychometricFit> out;
    for (const HardFit& hard : fits) {
      if (auto fit = fit_psychometric(hard.levels, {.fixed_lapse = hard.lapse})) out.push_back(*std::move(fit));
    }
    return out;
  };
  auto elsewhere = std::async(std::launch::async, fitted);
  const std::vector<PsychometricFit> here = fitted(), there = elsewhere.get();
  int different = here.size() == there.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(here.size(), there.size()); ++i) {
    const bool same = same_bits(here[i].threshold, there[i].threshold) && same_bits(here[i].slope, there[i].slope) &&
                      same_bits(here[i].ci95.low, there[i].ci95.low) &&
                      same_bits(here[i].ci95.high, there[i].ci95.high);
    different += same ? 0 : 1;
  }
  cases.push_back({"same bits", "fits that differ on a second thread", static_cast<double>(different), 0, 0});
}

Result<void> add_reference_case(SelftestCases& cases, std::stop_token stop) {
  // Of the first case of the set, with its stated standard error.
  constexpr double s75_mrad = 2.0848059071130209, standard_error_mrad = 0.0037587537320949859;
  const std::vector<ReferenceCase> all = reference_cases();
  TODBENCH_TRY(const auto truth, reference_truths({all.front()}, std::move(stop)));
  cases.push_back({"reference set", "S75 of case-1 [mrad]", truth.front().s75_mrad, s75_mrad, 1e-12 * s75_mrad});
  cases.push_back({"reference set", "standard error of case-1 [mrad]", truth.front().standard_error_mrad,
                   standard_error_mrad, 1e-12 * s75_mrad});
  return {};
}

}  // namespace todbench
