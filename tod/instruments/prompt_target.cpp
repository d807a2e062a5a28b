#include "tod/instruments/prompt_target.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <optional>
#include <ostream>
#include <system_error>
#include <utility>
#include <vector>

#include "tod/instruments/descriptor.h"

namespace todbench {
namespace {

constexpr std::size_t longest_line = 4096;

class DescriptorLines final : public LineSource {
 public:
  explicit DescriptorLines(int fd) : fd_(fd) {}

  Result<std::string> next_line(const std::stop_token& stop) override {
    for (;;) {
      if (const auto end = received_.find('\n'); end != std::string::npos) {
        std::string line = received_.substr(0, std::min(end, longest_line));
        received_.erase(0, end + 1);
        if (!line.empty() && line.back() == '\r') line.pop_back();
        return line;
      }
      if (wait_on(fd_, WaitFor::reading, std::nullopt, stop) == Waited::stopped)
        return fail(ErrorCode::interrupted, "stopped while waiting for the operator");
      std::array<char, 512> chunk{};
      const ssize_t count = ::read(fd_, chunk.data(), chunk.size());
      if (count == 0) return fail(ErrorCode::disconnected, "end of the operator's input");
      if (count < 0) {
        if (errno == EINTR || errno == EAGAIN) continue;
        return fail(ErrorCode::disconnected, "the operator's input: " + std::generic_category().message(errno));
      }
      received_.append(chunk.data(), static_cast<std::size_t>(count));
      // Without a line end this long, only its head is kept; a later line end still ends it.
      if (received_.find('\n') == std::string::npos && received_.size() > longest_line) received_.resize(longest_line);
    }
  }

 private:
  int fd_;
  std::string received_;
};

const char* instruction(Mounting mounting) {
  switch (mounting) {
    case Mounting::identity:
      return "as drawn, front to the camera";
    case Mounting::rotated_180:
      return "front to the camera, upside down (turned by 180 degrees)";
    case Mounting::mirrored_horizontally:
      return "back to the camera, turned about its vertical axis (left and right swapped)";
    case Mounting::mirrored_vertically:
      return "back to the camera, turned about its horizontal axis (top and bottom swapped)";
  }
  return "as drawn";
}

std::string kelvin(double value) {
  return fmt::format("{:+.3f} K", value);
}

std::string millimetres(cv::Point2d move) {
  return fmt::format("{:.1f} mm {} and {:.1f} mm {}", std::abs(move.x), move.x < 0 ? "left" : "right", std::abs(move.y),
                     move.y < 0 ? "up" : "down");
}

std::vector<std::string> what_to_do(const std::optional<TargetState>& last, const TargetState& next) {
  std::vector<std::string> steps;
  const bool other_plate = !last || last->plate != next.plate;
  if (other_plate) steps.push_back("put in plate '" + next.plate + "', " + instruction(next.mounting));
  if (!other_plate && last->mounting != next.mounting)
    steps.push_back("remount the plate: " + std::string(instruction(next.mounting)));
  if (!last || last->delta_t_k != next.delta_t_k)
    steps.push_back("set the black body to " + kelvin(next.delta_t_k) +
                    " against the plate and wait until it is stable");
  if (last && steps.empty() && last->shift_mm != next.shift_mm)
    steps.push_back("move the plate or the camera slightly, about " + millimetres(next.shift_mm - last->shift_mm) +
                    " as the camera sees the plate; the amount is measured, it need not be exact");
  return steps;
}

class PromptTarget final : public Target {
 public:
  PromptTarget(std::ostream& out, std::unique_ptr<LineSource> answers, PromptTargetOptions options)
      : out_(out), answers_(std::move(answers)), now_(std::move(options.now)), capabilities_(options.times) {
    capabilities_.description = options.description;
    capabilities_.sets_shift = false;
  }

  const TargetCapabilities& capabilities() const override { return capabilities_; }

  Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the operator was asked");
    if (state.plate.empty() || !std::isfinite(state.delta_t_k) || !std::isfinite(state.shift_mm.x) ||
        !std::isfinite(state.shift_mm.y))
      return fail(ErrorCode::invalid_input, "a target needs a plate, a finite contrast and a finite shift");
    const auto start = now_();
    const auto steps = what_to_do(std::exchange(last_, std::nullopt), state);
    if (!steps.empty())
      if (auto done = ask(steps, stop); !done) return fail("asking the operator", done.error());
    last_ = state;
    PresentedTarget presented;
    presented.state = state;
    presented.settling_s = std::chrono::duration<double>(now_() - start).count();
    return presented;
  }

 private:
  Result<void> ask(const std::vector<std::string>& steps, const std::stop_token& stop) {
    out_ << "Please:\n";
    for (const auto& step : steps) out_ << "  - " << step << "\n";
    for (;;) {
      out_ << "Enter when done, q to stop: " << std::flush;
      auto line = answers_->next_line(stop);
      if (!line) {
        out_ << "\n" << std::flush;
        return tl::unexpected(line.error());
      }
      const auto first = line->find_first_not_of(" \t");
      if (first == std::string::npos) return {};
      const std::string answer = line->substr(first, line->find_last_not_of(" \t") - first + 1);
      if (answer == "q" || answer == "Q") return fail(ErrorCode::interrupted, "stopped by the operator");
    }
  }

  std::ostream& out_;
  std::unique_ptr<LineSource> answers_;
  std::function<std::chrono::steady_clock::time_point()> now_;
  TargetCapabilities capabilities_;
  std::optional<TargetState> last_;  // none: unknown, say everything
};

}  // namespace

std::unique_ptr<LineSource> descriptor_lines(int fd) {
  return std::make_unique<DescriptorLines>(fd);
}

std::unique_ptr<Target> prompt_target(std::ostream& out, std::unique_ptr<LineSource> answers,
                                      PromptTargetOptions options) {
  return std::make_unique<PromptTarget>(out, std::move(answers), std::move(options));
}

}  // namespace todbench
