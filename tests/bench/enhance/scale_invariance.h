// SPDX-License-Identifier: GPL-3.0-or-later
// Stages that must change no answer (x -> gain x + offset; a filter and its inverse), and how far packages move answers
// and acuities.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/plan/descriptions.h"
#include "bench/plan/resources.h"
#include "sim_devices/module/picture_stage.h"
#include "tests/bench/enhance/enhancement_support.h"

namespace todbench::testing_support {

inline StagePlan kernel_of(const std::array<double, 9>& kernel) {
  return {.kind = StagePlan::Kind::kernel, .kernel = kernel};
}

/// x -> gain x.
inline EnhancementPackage gain_of(double gain) {
  return package_of({kernel_of({0, 0, 0, 0, gain, 0, 0, 0, 0})}, "gain");
}

/// A shift by a pixel with a gain of a half.
inline constexpr std::array<double, 9> shift_right{0, 0, 0, 0.5, 0, 0, 0, 0, 0};
/// Its inverse: back, with a gain of 2.
inline constexpr std::array<double, 9> shift_left{0, 0, 0, 0, 0, 2, 0, 0, 0};

/// x -> gain x + offset, a stage that no package needs.
class AffineStage final : public ChainStage {
 public:
  AffineStage(double gain, double offset_counts) : gain_(gain), offset_counts_(offset_counts) {}
  [[nodiscard]] Result<cv::Mat1f> process(const cv::Mat1f& picture) override {
    return cv::Mat1f(gain_ * picture + offset_counts_);
  }

 private:
  double gain_, offset_counts_;
};

using StageMaker = std::function<std::vector<std::unique_ptr<ChainStage>>()>;
inline StageMaker affine(double gain, double offset_counts) {
  return [=] {
    std::vector<std::unique_ptr<ChainStage>> stages;
    stages.push_back(std::make_unique<AffineStage>(gain, offset_counts));
    return stages;
  };
}
/// Nothing is rounded between the filter and its inverse.
inline StageMaker filter_and_inverse() {
  return [] {
    std::vector<std::unique_ptr<ChainStage>> stages;
    stages.push_back(kernel_filter(shift_right));
    stages.push_back(kernel_filter(shift_left));
    return stages;
  };
}

/// The display of the plans here, for observers with an eye: the operator sets the gain, so that every target appears
/// with the same luminance contrast.
inline const ViewedDisplay& operators_display() {
  static const ViewedDisplay display{
      .pixel_pitch_mm = 0.27, .viewing_distance_m = 0.5, .luminance_white_cd_m2 = 200, .zoom = 3};
  return display;
}
inline const std::string operators_display_section =
    "[display]\npixel_pitch_mm = 0.27\nviewing_distance_m = 0.5\nzoom = 3\nluminance_white_cd_m2 = 200\n";

/// The shipped observers: with an eye at that display, and once more at one of fixed gain.
inline std::vector<TemplateObserverSpec> shipped_observers() {
  std::vector<TemplateObserverSpec> out;
  for (const std::string& name : resource_names(ResourceKind::observer)) {
    if (const auto plain = load_observer(name)) {
      out.push_back(*plain);
      continue;
    }
    ViewedDisplay fixed = operators_display();
    fixed.span_k = 20;
    out.push_back(load_observer_at(name, operators_display()).value());
    out.push_back(load_observer_at(name, fixed).value());
  }
  return out;
}

/// A small plan at 4 K with a shipped observer, and a sensor of 16 bits whose counts are this large.
inline LoadedPlan plan_of_counts(const std::string& observer, int phases, std::uint64_t seed, double kelvin_per_count) {
  const LoadedPlan loaded =
      small_plan("4", phases, "[observer]\nname = \"" + observer + "\"\n" + operators_display_section);
  PlanParts parts = loaded.parts();
  parts.sensor.bits = 16;
  parts.sensor.kelvin_per_count = kelvin_per_count;
  parts.sensor.offset_k = parts.sensor.scene_temperature_k - 10;
  Plan plan = loaded.plan();
  plan.seed = seed;
  return LoadedPlan::of(plan, parts).value();
}

/// How far a package moves the answers, and the acuity at the first contrast.
struct Moved {
  double answers = 0;  ///< share of the trials that are answered otherwise
  double ln_ratio = 0;
  std::optional<double> half_width{};  ///< of the 95 % interval of ln ratio
};

inline Moved moved_by(const PackageResult& with, const PackageResult& without) {
  Moved out;
  EXPECT_EQ(with.trials.size(), without.trials.size());
  for (std::size_t i = 0; i < std::min(with.trials.size(), without.trials.size()); ++i)
    out.answers += with.trials[i].answer != without.trials[i].answer ? 1 : 0;
  out.answers /= static_cast<double>(std::max<std::size_t>(1, with.trials.size()));
  const PairedRatio& ratio = with.ratios.at(0);
  EXPECT_TRUE(ratio.ratio) << ratio.withheld;
  if (ratio.ratio) out.ln_ratio = std::log(*ratio.ratio);
  if (ratio.ci95.low && ratio.ci95.high) out.half_width = std::log(*ratio.ci95.high / *ratio.ci95.low) / 2;
  return out;
}

}  // namespace todbench::testing_support
