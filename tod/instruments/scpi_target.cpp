// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/scpi_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "acquisition/base/try.h"
#include "tod/instruments/instrument_device.h"
#include "tod/presentation/absolute_target.h"

namespace todbench {
namespace {

std::string decimal(double value, int decimals) {
  return fmt::format("{:.{}f}", value, decimals);
}

std::string position_text(cv::Point2d position) {
  return decimal(position.x, 3) + "," + decimal(position.y, 3);
}

/// Whether a condition has held for the required time; `since` stores its start.
bool has_stayed(bool so, double dwell_s, const std::function<std::chrono::steady_clock::time_point()>& now,
                std::optional<std::chrono::steady_clock::time_point>& since) {
  if (!so) since.reset();
  if (!so || dwell_s <= 0) return so;
  const auto time = now();
  if (!since) since = time;
  return std::chrono::duration<double>(time - *since).count() >= dwell_s;
}

class ScpiTarget final : public Target, public AbsoluteTarget, private MovingTarget {
 public:
  explicit ScpiTarget(ScpiTargetOptions options)
      : options_(std::move(options)),
        black_body_("black body", options_.black_body, options_.connection, options_.black_body_table),
        stage_("plate stage", options_.stage, options_.connection, options_.stage_table) {}

  Result<void> open(const std::stop_token& stop);

  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }
  Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override;
  Result<std::array<double, 2>> temperatures_k(std::stop_token stop) override;
  Result<PresentedTarget> present_temperature(const TargetState& state, double temperature_k,
                                              std::stop_token stop) override;
  MovingTarget* moving() override { return plates().position && plates().run ? this : nullptr; }

 private:
  Result<std::array<double, 2>> run_speeds_mm_s(std::stop_token stop) override { return stage_.run_speeds(stop); }
  Result<PlateRun> run_along_x(double to_mm, double speed_mm_s, std::stop_token stop) override;
  using TimePoint = std::chrono::steady_clock::time_point;
  struct Reading {
    PresentedTarget target;
    bool black_body_settled = false, stage_settled = false;
  };

  [[nodiscard]] const BlackBodyWords& heat() const { return options_.black_body_table.black_body; }
  [[nodiscard]] const StageWords& plates() const { return options_.stage_table.stage; }
  [[nodiscard]] Result<void> check_within_limits(const TargetState& state) const;
  Result<Reading> read(const TargetState& asked, const std::stop_token& stop);
  /// Within the settling band, and slower than the largest rate since the reading before.
  [[nodiscard]] bool near_and_slow(double reached_k, double asked_k);
  [[nodiscard]] std::optional<std::string> black_body_lacks(const Reading& reading, const TargetState& asked);
  [[nodiscard]] std::optional<std::string> stage_lacks(const Reading& reading, const TargetState& asked);
  Result<PresentedTarget> wait_until_reached(const TargetState& asked, const std::stop_token& stop);
  Result<PresentedTarget> poll_until_reached(const TargetState& asked, const std::stop_token& stop);

  ScpiTargetOptions options_;
  BlackBodyDevice black_body_;
  StageDevice stage_;
  std::array<double, 2> limits_k_{};
  StageLimits travel_;
  TargetCapabilities capabilities_;
  std::optional<TimePoint> black_body_there_, stage_there_;  ///< start of the time within the tolerance
  std::optional<std::pair<TimePoint, double>> earlier_;      ///< a reading of the contrast in this wait
  std::optional<double> slow_at_k_;                          ///< set contrast at which it was near and slow
  bool wait_reported_ = false;
  std::optional<double> asked_k_;  ///< absolute set-point of the present wait; empty: a difference
};

Result<void> ScpiTarget::open(const std::stop_token& stop) {
  TODBENCH_TRY_VOID(black_body_.ensure_connected(stop));
  TODBENCH_TRY_VOID(stage_.ensure_connected(stop));
  const auto failed = [](Error error) {
    if (error.code != ErrorCode::interrupted) error.code = ErrorCode::not_found;
    return fail("reading the limits of the instruments", error);
  };
  const auto limits = black_body_.limits(stop);
  if (!limits) return failed(limits.error());
  auto travel = stage_.limits(stop);
  if (!travel) return failed(travel.error());
  limits_k_ = *limits;
  travel_ = std::move(*travel);
  capabilities_.description = black_body_.name() + "; " + stage_.name();
  capabilities_.sets_shift = plates().position.has_value();
  for (const TargetState& state : options_.requested) {
    TODBENCH_TRY_VOID(check_within_limits(state));
  }
  if (options_.temperatures_k.empty()) return {};
  TODBENCH_TRY(const auto absolute, temperatures_k(stop));
  for (const double temperature : options_.temperatures_k) {
    if (!(temperature >= absolute[0] && temperature <= absolute[1]))
      return fail(ErrorCode::invalid_input, black_body_.name() + ": " + decimal(temperature, 3) + " K is outside " +
                                                decimal(absolute[0], 3) + " to " + decimal(absolute[1], 3) + " K");
  }
  return {};
}

Result<void> ScpiTarget::check_within_limits(const TargetState& state) const {
  // This form also rejects NaN.
  if (!(state.delta_t_k >= limits_k_[0] && state.delta_t_k <= limits_k_[1]))
    return fail(ErrorCode::invalid_input, black_body_.name() + ": " + decimal(state.delta_t_k, 3) + " K is outside " +
                                              decimal(limits_k_[0], 3) + " to " + decimal(limits_k_[1], 3) + " K");
  const auto& shift = state.shift_mm;
  const bool reachable = shift.x >= travel_.min_mm.x && shift.x <= travel_.max_mm.x && shift.y >= travel_.min_mm.y &&
                         shift.y <= travel_.max_mm.y;
  if (!std::isfinite(shift.x) || !std::isfinite(shift.y) || (plates().position && !reachable))
    return fail(ErrorCode::invalid_input, stage_.name() + ": shift " + position_text(shift) + " mm is outside " +
                                              position_text(travel_.min_mm) + " to " + position_text(travel_.max_mm) +
                                              " mm");
  if (std::find(travel_.plates.begin(), travel_.plates.end(), state.plate) == travel_.plates.end()) {
    std::string known;
    for (const auto& plate : travel_.plates) known += (known.empty() ? "" : ", ") + plate;
    return fail(ErrorCode::invalid_input, stage_.name() + ": has no plate '" + state.plate + "'; available: " + known);
  }
  if (!stage_.holds(state.mounting))
    return fail(ErrorCode::invalid_input,
                stage_.name() + ": cannot hold a plate " + std::string(mounting_in_words(state.mounting)));
  return {};
}

Result<ScpiTarget::Reading> ScpiTarget::read(const TargetState& asked, const std::stop_token& stop) {
  Reading reading;
  // Settled first, values after it: a value read before the flag could be older than the flag.
  TODBENCH_TRY(auto stage_settled, stage_.is_settled(stop));
  TODBENCH_TRY(auto black_body_settled, black_body_.is_settled(stop));
  reading.stage_settled = stage_settled;
  reading.black_body_settled = black_body_settled;

  TODBENCH_TRY(auto place, stage_.read(asked, stop));
  TODBENCH_TRY(auto temperatures, black_body_.read(stop));
  reading.target.state = std::move(place);
  reading.target.state.delta_t_k = temperatures.delta_t_k;
  reading.target.plate_temperature_k = temperatures.plate_k;
  reading.target.black_body_temperature_k = temperatures.radiator_k;
  return reading;
}

bool ScpiTarget::near_and_slow(double reached_k, double asked_k) {
  constexpr double least_interval_s = 0.2;  // the last digit of a reading is not a rate
  const auto time = options_.now();
  if (!earlier_) earlier_ = {time, reached_k};
  const double interval_s = std::chrono::duration<double>(time - earlier_->first).count();
  if (interval_s < least_interval_s) return false;
  const double rate_k_per_s = (reached_k - earlier_->second) / interval_s;
  earlier_ = {time, reached_k};
  return std::abs(reached_k - asked_k) <= options_.settling_band * std::abs(asked_k) &&
         std::abs(rate_k_per_s) <= options_.max_relative_rate_per_s * std::abs(asked_k);
}

std::optional<std::string> ScpiTarget::black_body_lacks(const Reading& reading, const TargetState& asked) {
  const double wanted = asked_k_.value_or(asked.delta_t_k);
  const double reached =
      asked_k_ ? reading.target.black_body_temperature_k.value_or(0) : reading.target.state.delta_t_k;
  if (!asked_k_ && asked.wait == ContrastWait::none) return {};
  // Once near and slow it stays so: it approaches the set-point.
  if (!asked_k_ && asked.wait == ContrastWait::within_band &&
      (slow_at_k_ == asked.delta_t_k || near_and_slow(reached, asked.delta_t_k))) {
    slow_at_k_ = asked.delta_t_k;
    return {};
  }
  const bool near = std::abs(reached - wanted) <= (asked_k_ ? heat().absolute->tolerance_k : heat().tolerance_k);
  const bool there = has_stayed(near, options_.black_body_table.settled.dwell_s, options_.now, black_body_there_);
  if (reading.black_body_settled && there) return {};
  return black_body_.name() + ": asked for " + decimal(wanted, 4) + " K, reached " + decimal(reached, 4) +
         (reading.black_body_settled && !(near && !there) ? " K, settled" : " K, still settling");
}

std::optional<std::string> ScpiTarget::stage_lacks(const Reading& reading, const TargetState& asked) {
  const auto& reached = reading.target.state;
  const cv::Point2d miss = reached.shift_mm - asked.shift_mm;
  const double tolerance_mm = plates().position ? plates().position->tolerance_mm : 0;
  const bool near = std::max(std::abs(miss.x), std::abs(miss.y)) <= tolerance_mm && reached.plate == asked.plate &&
                    reached.mounting == asked.mounting;
  const bool there = has_stayed(near, options_.stage_table.settled.dwell_s, options_.now, stage_there_);
  if (reading.stage_settled && there) return {};
  const auto describe = [](const TargetState& state) {
    return "plate '" + state.plate + "' " + std::string(mounting_in_words(state.mounting)) + " at " +
           position_text(state.shift_mm) + " mm";
  };
  return stage_.name() + ": asked for " + describe(asked) + ", reached " + describe(reached) +
         (reading.stage_settled && !(near && !there) ? ", at rest" : ", still moving");
}

Result<PresentedTarget> ScpiTarget::wait_until_reached(const TargetState& asked, const std::stop_token& stop) {
  auto reached = poll_until_reached(asked, stop);
  if (std::exchange(wait_reported_, false)) options_.on_wait(std::nullopt);
  return reached;
}

Result<PresentedTarget> ScpiTarget::poll_until_reached(const TargetState& asked, const std::stop_token& stop) {
  const auto start = options_.now();
  earlier_.reset();
  if (slow_at_k_ && (*slow_at_k_ != asked.delta_t_k || asked.wait != ContrastWait::within_band)) slow_at_k_.reset();
  black_body_there_.reset();
  stage_there_.reset();
  auto reported = start;
  std::mutex mutex;
  std::condition_variable_any wake;
  for (;;) {
    TODBENCH_TRY(auto reading, read(asked, stop));
    const auto waited = options_.now() - start;
    const auto black_body = black_body_lacks(reading, asked);
    const auto stage = stage_lacks(reading, asked);
    if (!black_body && !stage) {
      reading.target.settling_s = std::chrono::duration<double>(waited).count();
      return reading.target;
    }
    if (waited >= options_.settle_timeout) {
      const std::string after = " after " + decimal(std::chrono::duration<double>(waited).count(), 1) + " s";
      return fail(ErrorCode::timeout,
                  black_body.value_or("") + (black_body && stage ? "; " : "") + stage.value_or("") + after);
    }
    if (options_.on_wait && options_.now() - reported >= options_.report_interval) {
      reported = options_.now();
      wait_reported_ = true;
      options_.on_wait(TargetWait{.asked = asked,
                                  .reached = reading.target.state,
                                  .contrast_there = !black_body,
                                  .plate_there = !stage,
                                  .waited_s = std::chrono::duration<double>(waited).count(),
                                  .timeout_s = std::chrono::duration<double>(options_.settle_timeout).count()});
    }
    std::unique_lock lock(mutex);
    wake.wait_for(lock, stop, options_.poll_interval, [] { return false; });
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped while the target was settling");
  }
}

Result<PresentedTarget> ScpiTarget::present(const TargetState& state, std::stop_token stop) {
  if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the target was set");
  TODBENCH_TRY_VOID(check_within_limits(state));
  TODBENCH_TRY_VOID(black_body_.ensure_connected(stop));
  TODBENCH_TRY_VOID(stage_.ensure_connected(stop));
  asked_k_.reset();
  // The slowest first, so that they settle together.
  TODBENCH_TRY_VOID(black_body_.command(state.delta_t_k, stop));
  TODBENCH_TRY_VOID(stage_.command(state, stop));
  return wait_until_reached(state, stop);
}

Result<std::array<double, 2>> ScpiTarget::temperatures_k(std::stop_token stop) {
  if (!heat().absolute)
    return fail(ErrorCode::invalid_input,
                black_body_.name() + ": its command table has no absolute set-point (key set in [temperatures])");
  TODBENCH_TRY_VOID(black_body_.ensure_connected(stop));
  const auto limits = black_body_.absolute_limits(stop);
  if (!limits) return limits;
  TODBENCH_TRY_VOID(black_body_.radiator((*limits)[0], stop));
  return limits;
}

Result<PresentedTarget> ScpiTarget::present_temperature(const TargetState& state, double temperature_k,
                                                        std::stop_token stop) {
  TargetState flat = state;
  flat.delta_t_k = 0;
  if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the target was set");
  TODBENCH_TRY_VOID(check_within_limits(flat));
  TODBENCH_TRY(const auto limits, temperatures_k(stop));
  // This form also rejects NaN.
  if (!(temperature_k >= limits[0] && temperature_k <= limits[1]))
    return fail(ErrorCode::invalid_input, black_body_.name() + ": " + decimal(temperature_k, 3) + " K is outside " +
                                              decimal(limits[0], 3) + " to " + decimal(limits[1], 3) + " K");
  TODBENCH_TRY_VOID(stage_.ensure_connected(stop));
  TODBENCH_TRY_VOID(black_body_.command_absolute(temperature_k, stop));
  TODBENCH_TRY_VOID(stage_.command(flat, stop));
  asked_k_ = temperature_k;
  return wait_until_reached(flat, stop);
}

Result<PlateRun> ScpiTarget::run_along_x(double to_mm, double speed_mm_s, std::stop_token stop) {
  // This form also rejects NaN.
  if (!(to_mm >= travel_.min_mm.x && to_mm <= travel_.max_mm.x))
    return fail(ErrorCode::invalid_input, stage_.name() + ": a run to " + decimal(to_mm, 3) + " mm is outside " +
                                              decimal(travel_.min_mm.x, 3) + " to " + decimal(travel_.max_mm.x, 3) +
                                              " mm");
  TODBENCH_TRY(const auto speeds, stage_.run_speeds(stop));
  if (!(speed_mm_s >= speeds[0] && speed_mm_s <= speeds[1]))
    return fail(ErrorCode::invalid_input, stage_.name() + ": " + decimal(speed_mm_s, 3) + " mm/s is outside " +
                                              decimal(speeds[0], 3) + " to " + decimal(speeds[1], 3) + " mm/s");
  return stage_.run_along_x(to_mm, speed_mm_s, stop);
}

}  // namespace

Result<std::unique_ptr<Target>> open_scpi_target(ScpiTargetOptions options, const std::stop_token& stop) {
  auto target = std::make_unique<ScpiTarget>(std::move(options));
  TODBENCH_TRY_VOID(target->open(stop));
  return target;
}

}  // namespace todbench
