// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/live_curve.h"

#include <chrono>
#include <utility>

#include "bench/run/running_fit.h"

namespace todbench {
namespace {

constexpr auto least_fit_period = std::chrono::seconds(1);

}  // namespace

LiveCurve::LiveCurve(const Plan& plan) : plan_(plan), worker_([this](const std::stop_token& stop) { work(stop); }) {}

void LiveCurve::add(SessionCurve curve, const Trial& trial) {
  {
    const std::lock_guard lock(mutex_);
    (curve == SessionCurve::main ? measured_ : twin_).push_back(trial);
    trials_changed_ = true;
  }
  changed_.notify_one();
}

std::shared_ptr<const FittedCurves> LiveCurve::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

void LiveCurve::work(const std::stop_token& stop) {
  RunningFit fit(plan_);
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return trials_changed_; })) {
    trials_changed_ = false;
    const std::vector<Trial> measured = measured_, twin = twin_;
    const std::uint64_t version = latest_ ? latest_->version + 1 : 1;
    lock.unlock();
    auto fitted = std::make_shared<const FittedCurves>(
        FittedCurves{.version = version, .measured = fit.curve_of(measured, stop), .twin = fit.curve_of(twin, stop)});
    lock.lock();
    latest_ = std::move(fitted);
    // Limits the rate of fits.
    changed_.wait_for(lock, stop, least_fit_period, [] { return false; });
  }
}

}  // namespace todbench
