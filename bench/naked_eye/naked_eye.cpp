// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/naked_eye/naked_eye.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "bench/plan/descriptions.h"
#include "hvs/eye/display_levels.h"
#include "hvs/shape/polygon_coverage.h"

namespace todbench {
namespace {

/// Edges of larger samples are visible themselves.
constexpr double largest_sample_arcmin = 3;

}  // namespace

Result<void> validate(const NakedEyeTask& task) {
  const auto refuse = [](std::string why) { return fail(ErrorCode::invalid_input, std::move(why)); };
  TODBENCH_TRY_VOID(require_eye(task.model, task.model.name));
  if (!task.model.display) return refuse("the plan has no section [display]");
  TODBENCH_TRY_VOID(validate(*task.model.display));
  if (const double arcmin = arcmin_per_sample(*task.model.display); arcmin > largest_sample_arcmin) {
    return refuse(
        fmt::format("a displayed sample is {:.3g} arcmin, so that the display limits the acuity: choose a smaller "
                    "zoom or a longer viewing distance, for at most {:g} arcmin",
                    arcmin, largest_sample_arcmin));
  }
  const double most = largest_contrast(*task.model.display);
  if (!(task.noise >= 0 && task.noise <= 1))
    return refuse(fmt::format("noise: expected 0 to 1, found {:g}", task.noise));
  if (task.contrasts.empty()) return refuse("no contrast is stated");
  for (const double contrast : task.contrasts) {
    if (!(contrast >= 0.005)) return refuse(fmt::format("contrast: expected at least 0.005, found {:g}", contrast));
    // Three standard deviations: what is cut off then changes the noise by less than 0.3 %.
    if (contrast + 3 * task.noise > most) {
      return refuse(
          fmt::format("the display cannot show a contrast of {:g} with a noise of {:g}: between black, white "
                      "and veil the largest contrast is {:.3g}",
                      contrast, task.noise, most));
    }
  }
  return {};
}

ViewedDisplay linear_display(const ViewedDisplay& display) {
  ViewedDisplay out = display;
  out.luminance_black_cd_m2 = luminance_cd_m2(display, 0);
  out.luminance_white_cd_m2 = luminance_cd_m2(display, 1);
  out.luminance_table.clear();
  out.gamma = 1;
  out.span_k = (out.luminance_white_cd_m2 - out.luminance_black_cd_m2) / adaptation_luminance_cd_m2(display);
  return out;
}

TemplateObserverSpec model_at_linear_display(const NakedEyeTask& task) {
  TemplateObserverSpec model = task.model;
  model.display = linear_display(*task.model.display);
  return model;
}

double mrad_per_sample(const ViewedDisplay& display) {
  return arcmin_per_sample(display) / 60 * std::numbers::pi / 180 * 1000;
}

NakedEyePicture naked_eye_picture(const NakedEyeTask& task, const NakedEyeTrial& trial, int window_samples) {
  const auto contrasts = level_contrasts(*task.model.display);
  const RandomStream numbers = RandomStream(task.seed, "naked-eye.picture").sub(trial.number);
  const cv::Point2d middle(window_samples / 2.0, window_samples / 2.0);
  const cv::Mat1d covered = pixel_coverage(triangle(trial.size_samples, trial.truth, middle + trial.centroid),
                                           {window_samples, window_samples});
  NakedEyePicture out{.levels = cv::Mat1b(covered.size()), .contrast = cv::Mat1f(covered.size())};
  double rounding = 0;
  std::uint64_t index = 0;
  for (int i = 0; i < covered.rows; ++i) {
    for (int j = 0; j < covered.cols; ++j, ++index) {
      const double wanted = trial.contrast * covered(i, j) + task.noise * static_cast<double>(numbers.normal(index));
      const BetweenLevels at = between_levels(contrasts, wanted);
      const int level = at.below + (numbers.sub(1).uniform(index) < at.share ? 1 : 0);
      out.levels(i, j) = static_cast<unsigned char>(level);
      out.contrast(i, j) = static_cast<float>(contrasts[static_cast<std::size_t>(level)]);
      rounding += at.share * (1 - at.share) * at.step * at.step;
    }
  }
  out.noise = std::sqrt(task.noise * task.noise + rounding / static_cast<double>(covered.total()));
  return out;
}

std::vector<NakedEyeTrial> naked_eye_trials(const NakedEyeTask& task,
                                            const std::vector<std::vector<double>>& sizes_samples) {
  std::vector<NakedEyeTrial> out;
  const RandomStream numbers(task.seed, "naked-eye.trials");
  for (std::size_t c = 0; c < task.contrasts.size(); ++c) {
    for (const double size : sizes_samples[c]) {
      const std::size_t first = numbers.sub(2).below(all_apexes.size(), out.size());
      for (int k = 0; k < task.per_size; ++k) {
        const auto number = static_cast<std::uint64_t>(out.size());
        out.push_back({.contrast = task.contrasts[c],
                       .size_samples = size,
                       .truth = all_apexes[(first + static_cast<std::size_t>(k)) % all_apexes.size()],
                       .centroid = {numbers.uniform(2 * number) - 0.5, numbers.uniform(2 * number + 1) - 0.5},
                       .number = number});
      }
    }
  }
  const RandomStream order = numbers.sub(1);
  for (std::size_t i = out.size(); i > 1; --i) std::swap(out[i - 1], out[order.below(i, i)]);
  return out;
}

}  // namespace todbench
