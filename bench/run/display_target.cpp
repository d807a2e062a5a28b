#include "bench/run/display_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "sim_devices/module/module_process.h"

namespace todbench {
namespace {

constexpr double screen_levels = 255;
constexpr double least_levels = 16;

struct DisplayLevels {
  double ground = 0, pattern = 0;
};

/// Whole levels round the middle of the screen.
DisplayLevels display_levels_of(double steps) {
  const double ground = std::round((screen_levels - steps) / 2);
  return {ground / screen_levels, (ground + steps) / screen_levels};
}

class DisplayTarget final : public Target {
 public:
  DisplayTarget(DisplayTargetOptions options, ShowLevels show) : options_(std::move(options)), show_(std::move(show)) {
    capabilities_.description = options_.description;
    capabilities_.sets_shift = true;
  }

  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }

  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the display was changed");
    const auto plate = std::find_if(options_.plates.begin(), options_.plates.end(),
                                    [&](const TargetPlate& known) { return known.name == state.plate; });
    if (plate == options_.plates.end())
      return fail(ErrorCode::invalid_input, "the display knows no plate '" + state.plate + "'");
    const double steps = std::round(screen_levels * state.delta_t_k / options_.span_k);
    if (!(std::abs(steps) >= least_levels && std::abs(steps) <= screen_levels)) {
      return fail(
          ErrorCode::invalid_input,
          fmt::format("a contrast of {:g} K is {:g} of the {:g} levels of a display that spans {:g} K: from {:g} "
                      "levels on edges can be drawn",
                      state.delta_t_k, steps, screen_levels, options_.span_k, least_levels));
    }
    const auto [ground, pattern] = display_levels_of(steps);
    const auto drawn =
        plate_picture(mounted(*plate, state.mounting), state.shift_mm, options_.display, ground, pattern);
    if (!drawn) return tl::unexpected(drawn.error());
    cv::Mat1f levels;
    drawn->convertTo(levels, CV_32F);
    const auto shown = show_(levels);
    if (!shown) return fail("the display", shown.error());
    if (auto same = is_shown(levels, *shown); !same) return tl::unexpected(same.error());
    wait(stop);
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped while the display changed");
    PresentedTarget presented;
    presented.state = state;
    presented.state.delta_t_k = steps / screen_levels * options_.span_k;
    presented.settling_s = std::chrono::duration<double>(options_.settle).count();
    return presented;
  }

 private:
  static Result<void> is_shown(const cv::Mat1f& levels, const cv::Mat1f& shown) {
    if (shown.size() != levels.size()) {
      return fail(ErrorCode::integrity, fmt::format("the display shows {} x {} pixels in place of {} x {}", shown.cols,
                                                    shown.rows, levels.cols, levels.rows));
    }
    // Half a level, and rounding of single precision.
    const double largest = cv::norm(levels, shown, cv::NORM_INF);
    if (largest <= 0.5 / screen_levels + 1e-6) return {};
    return fail(ErrorCode::integrity,
                fmt::format("the display does not show what was drawn: a pixel is {:.1f} levels off; is the picture "
                            "scaled, covered or corrected in colour?",
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
  return ShowLevels([shared](const cv::Mat1f& levels) { return shared->exchange(levels); });
}

}  // namespace todbench
