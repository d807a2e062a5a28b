#include "bench/run/operator_target.h"

#include <sstream>
#include <utility>

namespace todbench {
namespace {

/// The operator's answers; each one is asked for with what was written since the last.
class DialogueLines final : public LineSource {
 public:
  DialogueLines(OperatorDialogue ask, std::ostringstream& written) : ask_(std::move(ask)), written_(written) {}

  [[nodiscard]] Result<std::string> next_line(const std::stop_token& stop) override {
    const std::string request = written_.str();
    written_.str("");
    return ask_(request, stop);
  }

 private:
  OperatorDialogue ask_;
  std::ostringstream& written_;
};

/// Keeps the text alive that the target writes to.
class DialogueTarget final : public Target {
 public:
  DialogueTarget(OperatorDialogue ask, PromptTargetOptions options)
      : target_(
            prompt_target(written_, std::make_unique<DialogueLines>(std::move(ask), written_), std::move(options))) {}

  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    return target_->present(state, std::move(stop));
  }

 private:
  std::ostringstream written_;
  std::unique_ptr<Target> target_;
};

}  // namespace

std::unique_ptr<Target> dialogue_target(OperatorDialogue ask, PromptTargetOptions options) {
  return std::make_unique<DialogueTarget>(std::move(ask), std::move(options));
}

}  // namespace todbench
