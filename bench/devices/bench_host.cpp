// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/bench_host.h"

#include <utility>

namespace todbench {
namespace {

class BenchHost final : public RunController {
 public:
  explicit BenchHost(const BenchHostOptions& options) : options_(options) {}

  [[nodiscard]] Result<std::int64_t> now_ns(Moment) override { return monotonic_ns(); }
  [[nodiscard]] Result<bool> rests(std::stop_token stop) override {
    return options_.pause != nullptr && options_.pause->rest(std::move(stop));
  }
  [[nodiscard]] FramesWhilePresenting frames_while_presenting() const override {
    return options_.frames_while_presenting;
  }
  [[nodiscard]] Result<std::int64_t> asked_while_presenting(std::int64_t calls) override { return calls; }
  [[nodiscard]] bool recovers() const override { return options_.camera != nullptr; }
  [[nodiscard]] Result<void> recover(std::stop_token stop) override {
    return options_.camera->recover(std::move(stop));
  }
  void resumed() override { options_.camera->confirm_registration(); }

 private:
  BenchHostOptions options_;
};

}  // namespace

std::unique_ptr<RunController> bench_host(const BenchHostOptions& options) {
  return std::make_unique<BenchHost>(options);
}

}  // namespace todbench
