// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a request to run control: method, path and body, each on a line. The queue runs nothing.
#include "bench/run_control/control_api.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  const std::string_view text = fuzz::text_of(data, size);
  static_cast<void>(parse_run_request(text));
  const auto method_end = text.find('\n');
  if (method_end == std::string_view::npos) return 0;
  const auto path_end = text.find('\n', method_end + 1);
  if (path_end == std::string_view::npos) return 0;
  static RunQueue queue("nowhere", [] {});
  static ControlApi api(queue, {.token = "secret"});
  ControlRequest request{std::string(text.substr(0, method_end)),
                         std::string(text.substr(method_end + 1, path_end - method_end - 1)), "secret",
                         std::string(text.substr(path_end + 1))};
  // A plan that is valid would run; whether one is valid is not a matter of this target, nor is what it names.
  if (request.path == "/api/v1/runs" || request.body.find("plan") != std::string::npos) return 0;
  const ControlAnswer answer = api.answer(request);
  fuzz::require(answer.status >= 200 && answer.status < 600);
  request.token = "Secret";
  const auto refused = api.refusal(request);
  fuzz::require(!answer.file && (refused || answer.status == 200));
  return 0;
}
