// SPDX-License-Identifier: GPL-3.0-or-later
// A host of a measurement whose answers a test sets.
#pragma once

#include <functional>
#include <utility>

#include "tod/measurement/run_controller.h"

namespace todbench::test {

/// Unattended, unless a test sets something else.
class TestHost final : public RunController {
 public:
  std::function<std::int64_t(Moment)> clock = [](Moment) { return monotonic_ns(); };
  std::function<Result<bool>()> rest = [] { return false; };
  FramesWhilePresenting meanwhile = FramesWhilePresenting::leave;
  std::function<Result<std::int64_t>(std::int64_t)> asked = [](std::int64_t calls) { return calls; };
  std::function<Result<void>(std::stop_token)> bring_back;  ///< empty: a lost camera ends the run
  std::function<void()> confirm = [] {};

  [[nodiscard]] Result<std::int64_t> now_ns(Moment why) override { return clock(why); }
  [[nodiscard]] Result<bool> rests(std::stop_token) override { return rest(); }
  [[nodiscard]] FramesWhilePresenting frames_while_presenting() const override { return meanwhile; }
  [[nodiscard]] Result<std::int64_t> asked_while_presenting(std::int64_t calls) override { return asked(calls); }
  [[nodiscard]] bool recovers() const override { return bring_back != nullptr; }
  [[nodiscard]] Result<void> recover(std::stop_token stop) override { return bring_back(std::move(stop)); }
  void resumed() override { confirm(); }
};

}  // namespace todbench::test
