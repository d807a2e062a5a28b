// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/operator_terminal.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <ostream>
#include <system_error>
#include <utility>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/safe_text.h"

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
      if (count == 0) return fail(ErrorCode::disconnected, "the operator's input has ended");
      if (count < 0) {
        if (errno == EINTR || errno == EAGAIN) continue;
        return fail(ErrorCode::disconnected, "reading the operator's input: " + std::generic_category().message(errno));
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

/// Meaning of a line; empty if it is not understood and the operator is asked again.
std::optional<OperatorAnswer> answer_of(std::string_view line) {
  const auto first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos) return OperatorAnswer::done;
  const auto word = line.substr(first, line.find_last_not_of(" \t") - first + 1);
  if (word == "q" || word == "Q") return OperatorAnswer::stop;
  return std::nullopt;
}

}  // namespace

std::unique_ptr<LineSource> descriptor_lines(int fd) {
  return std::make_unique<DescriptorLines>(fd);
}

AskOperator operator_at_terminal(std::ostream& out, std::shared_ptr<LineSource> answers) {
  return [&out, answers = std::move(answers)](const OperatorRequest& request,
                                              const std::stop_token& stop) -> Result<OperatorAnswer> {
    out << "Please:\n";
    for (const auto& step : request.steps) out << "  - " << one_line(sentence(step)) << "\n";
    for (;;) {
      out << "Press Enter when done, or type q to stop: " << std::flush;
      const auto line = answers->next_line(stop);
      if (!line) {
        out << "\n" << std::flush;
        return tl::unexpected(line.error());
      }
      if (const auto answer = answer_of(*line)) return *answer;
    }
  };
}

}  // namespace todbench
