// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/prompt_target.h"

#include <cmath>
#include <optional>
#include <utility>

namespace todbench {
namespace {

class PromptTarget final : public Target {
 public:
  PromptTarget(AskOperator ask, PromptTargetOptions options) : ask_(std::move(ask)), now_(std::move(options.now)) {
    capabilities_.description = options.description;
    capabilities_.sets_shift = false;
  }

  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }

  Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the operator was asked");
    if (state.plate.empty() || !std::isfinite(state.delta_t_k) || !std::isfinite(state.shift_mm.x) ||
        !std::isfinite(state.shift_mm.y))
      return fail(ErrorCode::invalid_input, "a target needs a plate, a finite contrast and a finite shift");
    const auto start = now_();
    OperatorRequest request = request_between(std::exchange(last_, std::nullopt), state);
    if (!doubt_.empty()) request.steps.insert(request.steps.begin(), CheckAgain{std::exchange(doubt_, {})});
    if (state != asked_for_) slips_ = 0;
    asked_for_ = state;
    if (!request.steps.empty()) {
      const auto answer = ask_(request, stop);
      if (!answer) return fail("asking the operator", answer.error());
      if (*answer == OperatorAnswer::stop)
        return fail(ErrorCode::interrupted, "asking the operator: stopped by the operator");
    }
    last_ = state;
    PresentedTarget presented;
    presented.state = state;
    presented.settling_s = std::chrono::duration<double>(now_() - start).count();
    return presented;
  }

  bool asks_again(const std::string& reason) override {
    if (++slips_ > most_slips) return false;
    last_.reset();
    doubt_ = reason;
    return true;
  }

 private:
  /// In a row for one state: a fault that the operator cannot mend ends the run.
  static constexpr int most_slips = 3;

  AskOperator ask_;
  std::function<std::chrono::steady_clock::time_point()> now_;
  TargetCapabilities capabilities_;
  std::optional<TargetState> last_;  // empty: unknown, request everything
  std::optional<TargetState> asked_for_;
  std::string doubt_;  // reason of the next request; empty: none
  int slips_ = 0;
};

}  // namespace

std::unique_ptr<Target> prompt_target(AskOperator ask, PromptTargetOptions options) {
  return std::make_unique<PromptTarget>(std::move(ask), std::move(options));
}

}  // namespace todbench
