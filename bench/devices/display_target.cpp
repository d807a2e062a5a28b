// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/display_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "acquisition/base/try.h"
#include "sim_devices/module/module_process.h"

namespace todbench {
namespace {

constexpr double screen_levels = 255;
constexpr int least_levels = 16;

/// Converts shares of the pattern to levels whose light is proportional to them.
cv::Mat1f drawn_levels(const cv::Mat1d& shares, const DisplayLevels& ends, const DisplayTone& tone) {
  const double ground = tone.light_of(ends.ground / screen_levels);
  cv::Mat1f levels(shares.size());
  for (int row = 0; row < shares.rows; ++row) {
    for (int column = 0; column < shares.cols; ++column) {
      const double share = shares(row, column);
      // Fast path: most pixels are background and need no power function.
      const double level =
          share == 0 ? ends.ground / screen_levels : tone.level_of(ground + ends.light_difference * share);
      levels(row, column) = static_cast<float>(level);
    }
  }
  return levels;
}

Result<DisplayLevels> levels_of_contrast(double delta_t_k, const DisplayTargetOptions& options) {
  const double contrast = delta_t_k / options.span_k;
  const DisplayLevels ends = display_levels(std::clamp(contrast, -1.0, 1.0), options.tone);
  const int steps = ends.pattern - ends.ground;
  if (std::abs(contrast) <= 1 && std::abs(steps) >= least_levels) return ends;
  return fail(
      ErrorCode::invalid_input,
      fmt::format(
          "a contrast of {:g} K is {:.3g} of the display's span of {:g} K, {} of its {:g} levels: edges need at "
          "least {} levels and a contrast within the span",
          delta_t_k, contrast, options.span_k, steps, screen_levels, least_levels));
}

class DisplayTarget final : public Target {
 public:
  DisplayTarget(DisplayTargetOptions options, ShowLevels show) : options_(std::move(options)), show_(std::move(show)) {
    capabilities_.description = options_.description;
    capabilities_.sets_shift = true;
  }

  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }

  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the display changed");
    const auto plate = std::find_if(options_.plates.begin(), options_.plates.end(),
                                    [&](const TargetPlate& known) { return known.name == state.plate; });
    if (plate == options_.plates.end())
      return fail(ErrorCode::invalid_input, "the display has no plate '" + state.plate + "'");
    TODBENCH_TRY(const DisplayLevels ends, levels_of_contrast(state.delta_t_k, options_));
    TODBENCH_TRY(const auto shares,
                 plate_picture(mounted(*plate, state.mounting), state.shift_mm, options_.display, 0, 1));
    const cv::Mat1f levels = drawn_levels(shares, ends, options_.tone);
    const auto shown = show_(levels);
    if (!shown) return fail("the display", shown.error());
    TODBENCH_TRY_VOID(is_shown(levels, *shown));
    wait(stop);
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped while the display changed");
    PresentedTarget presented;
    presented.state = state;
    presented.state.delta_t_k = ends.light_difference * options_.span_k;
    presented.settling_s = std::chrono::duration<double>(options_.settle).count();
    return presented;
  }

 private:
  static Result<void> is_shown(const cv::Mat1f& levels, const cv::Mat1f& shown) {
    if (shown.size() != levels.size()) {
      return fail(ErrorCode::integrity, fmt::format("the display shows {} x {} pixels, expected {} x {}", shown.cols,
                                                    shown.rows, levels.cols, levels.rows));
    }
    // Half a level, plus rounding of single precision.
    const double largest = cv::norm(levels, shown, cv::NORM_INF);
    if (largest <= 0.5 / screen_levels + 1e-6) return {};
    return fail(
        ErrorCode::integrity,
        fmt::format("the display does not show the drawn picture: a pixel differs by {:.1f} levels. Check whether the "
                    "picture is scaled, covered or colour-corrected",
                    largest * screen_levels));
  }

  void wait(const std::stop_token& stop) const {
    std::mutex mutex;
    std::condition_variable_any changed;
    std::unique_lock lock(mutex);
    changed.wait_for(lock, stop, options_.settle, [] { return false; });
  }

  DisplayTargetOptions options_;
  ShowLevels show_;
  TargetCapabilities capabilities_;
};

}  // namespace

double DisplayTone::light_of(double level) const {
  if (luminance.size() < 3) return gamma == 1 ? level : std::pow(level, gamma);
  const double at = std::clamp(level, 0.0, 1.0) * static_cast<double>(luminance.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), luminance.size() - 2);
  const double seen = luminance[below] + (at - static_cast<double>(below)) * (luminance[below + 1] - luminance[below]);
  return (seen - luminance.front()) / (luminance.back() - luminance.front());
}

double DisplayTone::level_of(double light) const {
  if (luminance.size() < 3) return gamma == 1 ? light : std::pow(light, 1 / gamma);
  const double wanted = luminance.front() + light * (luminance.back() - luminance.front());
  const auto above = std::upper_bound(luminance.begin() + 1, luminance.end() - 1, wanted);
  const auto below = above - 1;
  const double at = static_cast<double>(below - luminance.begin()) + (wanted - *below) / (*above - *below);
  return std::clamp(at / static_cast<double>(luminance.size() - 1), 0.0, 1.0);
}

DisplayLevels display_levels(double contrast, const DisplayTone& tone) {
  const auto nearest = [&](double light) {
    return static_cast<int>(std::lround(screen_levels * tone.level_of(std::clamp(light, 0.0, 1.0))));
  };
  DisplayLevels out{.ground = nearest((1 - contrast) / 2)};
  const double ground_light = tone.light_of(out.ground / screen_levels);
  out.pattern = nearest(ground_light + contrast);
  out.light_difference = tone.in_proportion() ? (out.pattern - out.ground) / screen_levels
                                              : tone.light_of(out.pattern / screen_levels) - ground_light;
  return out;
}

std::unique_ptr<Target> display_target(DisplayTargetOptions options, ShowLevels show) {
  return std::make_unique<DisplayTarget>(std::move(options), std::move(show));
}

Result<ShowLevels> shown_by_program(const std::string& command) {
  auto process = ModuleProcess::start({.command = command,
                                       .header = R"({"protocol": "todbench-module", "version": 1, "place": "display"})",
                                       .limit = std::chrono::milliseconds(30000),
                                       .network = ModuleNetwork::ours});
  if (!process) return tl::unexpected(process.error());
  auto shared = std::make_shared<ModuleProcess>(*std::move(process));
  return ShowLevels([shared](const cv::Mat1f& levels) -> Result<cv::Mat1f> {
    auto shown = shared->exchange(levels);
    if (shown || shown.error().code != ErrorCode::disconnected) return shown;
    const int code = shared->exit_code().value_or(0);
    if (code == 2) return tl::unexpected(with_code(ErrorCode::invalid_input, shown.error()));
    if (code == 4 || code == 127) return tl::unexpected(with_code(ErrorCode::not_found, shown.error()));
    return shown;
  });
}

Result<std::unique_ptr<Target>> open_display_target(DisplayTargetOptions options, const std::string& command) {
  // Mountings rotate and mirror a plate about its centre: a plate that fits in one fits in all.
  for (const TargetPlate& plate : options.plates) {
    if (auto fits = plate_picture(plate, {0, 0}, options.display, 0, 1); !fits) return tl::unexpected(fits.error());
  }
  for (const double delta_t_k : options.delta_t_k) {
    TODBENCH_TRY_VOID(levels_of_contrast(delta_t_k, options));
  }
  TODBENCH_TRY(auto show, shown_by_program(command));
  const auto first = show(cv::Mat1f(options.display.size_px, static_cast<float>(options.tone.level_of(0.5))));
  if (!first) {
    // The program never showed a picture: a screen is missing, no device was lost.
    const ErrorCode code = first.error().code;
    return fail("the display", with_code(code == ErrorCode::disconnected ? ErrorCode::not_found : code, first.error()));
  }
  return display_target(std::move(options), std::move(show));
}

}  // namespace todbench
