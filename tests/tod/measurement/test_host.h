// A host of a measurement whose answers a test sets.
#pragma once

#include <functional>
#include <utility>

#include "tod/measurement/measurement_host.h"

namespace todbench::test {

/// Unattended, unless a test sets something else.
class TestHost final : public MeasurementHost {
 public:
  std::function<std::int64_t(Moment)> clock = [](Moment) { return monotonic_ns(); };
  std::function<Result<bool>()> rest = [] { return false; };
  FramesMeanwhile meanwhile = FramesMeanwhile::leave;
  std::function<Result<std::int64_t>(std::int64_t)> asked = [](std::int64_t calls) { return calls; };
  std::function<Result<void>(std::stop_token)> bring_back;  ///< empty: a lost camera ends the run
  std::function<void()> confirm = [] {};

  [[nodiscard]] Result<std::int64_t> now_ns(Moment why) override { return clock(why); }
  [[nodiscard]] Result<bool> rests(std::stop_token) override { return rest(); }
  [[nodiscard]] FramesMeanwhile frames_while_presenting() const override { return meanwhile; }
  [[nodiscard]] Result<std::int64_t> asked_while_presenting(std::int64_t calls) override { return asked(calls); }
  [[nodiscard]] bool recovers() const override { return bring_back != nullptr; }
  [[nodiscard]] Result<void> recover(std::stop_token stop) override { return bring_back(std::move(stop)); }
  void resumed() override { confirm(); }
};

}  // namespace todbench::test
