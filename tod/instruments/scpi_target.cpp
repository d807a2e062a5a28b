#include "tod/instruments/scpi_target.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace todbench {
namespace {

constexpr unsigned settling_bit = 1U << 1;  // SCPI-99 volume 1, 20.1.3: OPERation condition register, SETTling

// Below these a set-point counts as the one asked for: half the last digit instruments of this class show.
constexpr double same_temperature_k = 0.0005;
constexpr double same_position_mm = 0.0005;
// No plate or radiator of a bench is hotter.
constexpr double hottest_k = 5000;

struct MountingName {
  Mounting mounting;
  const char* keyword;  // short form, as sent and as answered
  const char* description;
};
constexpr std::array mounting_names{MountingName{Mounting::identity, "IDEN", "not turned"},
                                    MountingName{Mounting::rotated_180, "ROT", "rotated by 180 degrees"},
                                    MountingName{Mounting::mirrored_horizontally, "HMIR", "mirrored left to right"},
                                    MountingName{Mounting::mirrored_vertically, "VMIR", "mirrored top to bottom"}};

const MountingName& name_of(Mounting mounting) {
  return *std::find_if(mounting_names.begin(), mounting_names.end(),
                       [&](const auto& name) { return name.mounting == mounting; });
}

std::optional<Mounting> mounting_answered(const std::string& text) {
  for (const auto& name : mounting_names)
    if (text == name.keyword) return name.mounting;
  return {};
}

std::string decimal(double value, int decimals) {
  return fmt::format("{:.{}f}", value, decimals);
}

std::string position_text(cv::Point2d position) {
  return decimal(position.x, 3) + "," + decimal(position.y, 3);
}

struct Limits {
  double min_delta_t_k = 0, max_delta_t_k = 0;
  cv::Point2d min_shift_mm, max_shift_mm;
  std::vector<std::string> plates;
};

// An instrument that is connected anew when it went away, and is then required to be the same one.
class Instrument {
 public:
  Instrument(std::string role, std::string endpoint, ScpiClientOptions options)
      : role_(std::move(role)), endpoint_(std::move(endpoint)), options_(options) {}

  Result<void> ensure_connected(const std::stop_token& stop) {
    if (client_ && client_->is_open()) return {};
    auto client = ScpiClient::connect(endpoint_, options_, stop);
    if (!client) {
      Error error = client.error();
      if (client_ && error.code == ErrorCode::not_found) error.code = ErrorCode::disconnected;
      return fail(role_, error);
    }
    if (client_ && client_->identity() != client->identity())
      return fail(ErrorCode::disconnected, role_ + " at " + endpoint_ + ": was " + to_text(client_->identity()) +
                                               ", is now " + to_text(client->identity()));
    client_.emplace(std::move(*client));
    return {};
  }

  [[nodiscard]] std::string name() const { return role_ + " (" + to_text(client_->identity()) + ")"; }

  Result<void> command(const std::string& text, const std::stop_token& stop) {
    return named(client_->command(text, stop));
  }
  Result<std::string> query(const std::string& text, const std::stop_token& stop) {
    return named(client_->query(text, stop));
  }
  Result<std::vector<double>> numbers(const std::string& text, std::size_t count, const std::stop_token& stop) {
    return named(client_->query_numbers(text, count, stop));
  }
  Result<bool> is_settled(const std::stop_token& stop) {
    auto condition = numbers("STAT:OPER:COND?", 1, stop);
    if (!condition) return tl::unexpected(condition.error());
    const double bits = condition->front();
    if (bits < 0 || bits > 65535)
      return fail(ErrorCode::disconnected, name() + ": STAT:OPER:COND? is not a 16-bit register");
    return (static_cast<unsigned>(bits) & settling_bit) == 0;
  }

 private:
  template <typename T>
  Result<T> named(Result<T> result) {
    if (result) return result;
    // An instrument that refuses what it was asked before, or should know, cannot be measured with: that is no mistake
    // of the plan, whose states were checked against the limits that the instrument stated.
    const bool refuses = result.error().code == ErrorCode::invalid_input;
    return fail(name(), refuses ? with_code(ErrorCode::disconnected, result.error()) : result.error());
  }

  std::string role_, endpoint_;
  ScpiClientOptions options_;
  std::optional<ScpiClient> client_;  // kept after the connection closed, for its identity
};

class ScpiTarget final : public Target {
 public:
  explicit ScpiTarget(ScpiTargetOptions options)
      : options_(std::move(options)),
        black_body_("black body", options_.black_body, options_.connection),
        stage_("plate stage", options_.stage, options_.connection) {}

  Result<void> open(const std::stop_token& stop);

  const TargetCapabilities& capabilities() const override { return capabilities_; }
  Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override;

 private:
  struct Reading {
    PresentedTarget target;
    bool black_body_settled = false, stage_settled = false;
  };

  Result<void> read_limits(const std::stop_token& stop);
  [[nodiscard]] Result<void> check_within_limits(const TargetState& state) const;
  Result<void> command_plate(const TargetState& state, const std::stop_token& stop);
  Result<void> command_position(const TargetState& state, const std::stop_token& stop);
  Result<void> command_temperature(const TargetState& state, const std::stop_token& stop);
  Result<Reading> read(const std::stop_token& stop);
  [[nodiscard]] std::optional<std::string> black_body_lacks(const Reading& reading, const TargetState& asked) const;
  [[nodiscard]] std::optional<std::string> stage_lacks(const Reading& reading, const TargetState& asked) const;
  Result<PresentedTarget> wait_until_reached(const TargetState& asked, const std::stop_token& stop);
  Result<PresentedTarget> poll_until_reached(const TargetState& asked, const std::stop_token& stop);

  ScpiTargetOptions options_;
  Instrument black_body_, stage_;
  Limits limits_;
  TargetCapabilities capabilities_;
  bool wait_reported_ = false;
};

Result<void> ScpiTarget::open(const std::stop_token& stop) {
  if (auto done = black_body_.ensure_connected(stop); !done) return done;
  if (auto done = stage_.ensure_connected(stop); !done) return done;
  if (auto done = read_limits(stop); !done) {
    Error error = done.error();
    if (error.code != ErrorCode::interrupted) error.code = ErrorCode::not_found;
    return fail("reading what the instruments can do", error);
  }
  capabilities_.description = black_body_.name() + "; " + stage_.name();
  capabilities_.sets_shift = true;
  return {};
}

Result<void> ScpiTarget::read_limits(const std::stop_token& stop) {
  auto min = black_body_.numbers("SOUR:TEMP:DIFF? MIN", 1, stop);
  if (!min) return tl::unexpected(min.error());
  auto max = black_body_.numbers("SOUR:TEMP:DIFF? MAX", 1, stop);
  if (!max) return tl::unexpected(max.error());
  auto travel = stage_.numbers("SOUR:POS:LIM?", 4, stop);
  if (!travel) return tl::unexpected(travel.error());
  auto plates = stage_.query("ROUT:PLAT:CAT?", stop);
  if (!plates) return tl::unexpected(plates.error());
  const auto& t = *travel;
  limits_ = {min->front(), max->front(), {t[0], t[2]}, {t[1], t[3]}, scpi_fields(*plates)};
  return {};
}

Result<void> ScpiTarget::check_within_limits(const TargetState& state) const {
  // Written so that NaN fails.
  if (!(state.delta_t_k >= limits_.min_delta_t_k && state.delta_t_k <= limits_.max_delta_t_k))
    return fail(ErrorCode::invalid_input, black_body_.name() + ": " + decimal(state.delta_t_k, 3) + " K is outside " +
                                              decimal(limits_.min_delta_t_k, 3) + " to " +
                                              decimal(limits_.max_delta_t_k, 3) + " K");
  const auto& shift = state.shift_mm;
  if (!(shift.x >= limits_.min_shift_mm.x && shift.x <= limits_.max_shift_mm.x && shift.y >= limits_.min_shift_mm.y &&
        shift.y <= limits_.max_shift_mm.y))
    return fail(ErrorCode::invalid_input, stage_.name() + ": shift " + position_text(shift) + " mm is outside " +
                                              position_text(limits_.min_shift_mm) + " to " +
                                              position_text(limits_.max_shift_mm) + " mm");
  if (std::find(limits_.plates.begin(), limits_.plates.end(), state.plate) == limits_.plates.end()) {
    std::string known;
    for (const auto& plate : limits_.plates) known += (known.empty() ? "" : ", ") + plate;
    return fail(ErrorCode::invalid_input, stage_.name() + ": has no plate '" + state.plate + "', only: " + known);
  }
  return {};
}

Result<void> ScpiTarget::command_plate(const TargetState& state, const std::stop_token& stop) {
  auto plate = stage_.query("ROUT:PLAT?", stop);
  if (!plate) return tl::unexpected(plate.error());
  if (scpi_fields(*plate).front() != state.plate)
    if (auto done = stage_.command("ROUT:PLAT " + scpi_quoted(state.plate), stop); !done) return done;
  auto mounting = stage_.query("ROUT:MOUN?", stop);
  if (!mounting) return tl::unexpected(mounting.error());
  if (mounting_answered(*mounting) == state.mounting) return {};
  return stage_.command(std::string("ROUT:MOUN ") + name_of(state.mounting).keyword, stop);
}

Result<void> ScpiTarget::command_position(const TargetState& state, const std::stop_token& stop) {
  auto position = stage_.numbers("SOUR:POS?", 2, stop);
  if (!position) return tl::unexpected(position.error());
  if (std::abs((*position)[0] - state.shift_mm.x) <= same_position_mm &&
      std::abs((*position)[1] - state.shift_mm.y) <= same_position_mm)
    return {};
  return stage_.command("SOUR:POS " + decimal(state.shift_mm.x, 4) + "," + decimal(state.shift_mm.y, 4), stop);
}

Result<void> ScpiTarget::command_temperature(const TargetState& state, const std::stop_token& stop) {
  auto set_point = black_body_.numbers("SOUR:TEMP:DIFF?", 1, stop);
  if (!set_point) return tl::unexpected(set_point.error());
  if (std::abs(set_point->front() - state.delta_t_k) <= same_temperature_k) return {};
  return black_body_.command("SOUR:TEMP:DIFF " + decimal(state.delta_t_k, 4), stop);
}

Result<ScpiTarget::Reading> ScpiTarget::read(const std::stop_token& stop) {
  Reading reading;
  // Settled first, values after it: a value read before the flag could be older than the flag says.
  auto stage_settled = stage_.is_settled(stop);
  if (!stage_settled) return tl::unexpected(stage_settled.error());
  auto black_body_settled = black_body_.is_settled(stop);
  if (!black_body_settled) return tl::unexpected(black_body_settled.error());
  reading.stage_settled = *stage_settled;
  reading.black_body_settled = *black_body_settled;

  auto plate = stage_.query("ROUT:PLAT:ACT?", stop);
  if (!plate) return tl::unexpected(plate.error());
  auto mounting = stage_.query("ROUT:MOUN:ACT?", stop);
  if (!mounting) return tl::unexpected(mounting.error());
  const auto mounting_reached = mounting_answered(*mounting);
  if (!mounting_reached)
    return fail(ErrorCode::disconnected, stage_.name() + ": ROUT:MOUN:ACT? answered an unknown mounting");
  auto position = stage_.numbers("MEAS:POS?", 2, stop);
  if (!position) return tl::unexpected(position.error());
  std::array<double, 3> temperatures{};
  const std::array queries{"MEAS:TEMP:DIFF?", "MEAS:TEMP:PLAT?", "MEAS:TEMP:BBOD?"};
  for (std::size_t i = 0; i < queries.size(); ++i) {
    auto value = black_body_.numbers(queries[i], 1, stop);
    if (!value) return tl::unexpected(value.error());
    temperatures[i] = value->front();
  }
  for (const std::size_t i : {1, 2}) {
    if (temperatures[i] > 0 && temperatures[i] <= hottest_k) continue;
    return fail(ErrorCode::disconnected, black_body_.name() + ": " + queries[i] + " answered " +
                                             decimal(temperatures[i], 3) + " K, which no plate can have");
  }
  reading.target.state = {
      scpi_fields(*plate).front(), *mounting_reached, temperatures[0], {(*position)[0], (*position)[1]}};
  reading.target.plate_temperature_k = temperatures[1];
  reading.target.black_body_temperature_k = temperatures[2];
  return reading;
}

std::optional<std::string> ScpiTarget::black_body_lacks(const Reading& reading, const TargetState& asked) const {
  const double reached = reading.target.state.delta_t_k;
  if (reading.black_body_settled && std::abs(reached - asked.delta_t_k) <= options_.delta_t_tolerance_k) return {};
  return black_body_.name() + ": asked for " + decimal(asked.delta_t_k, 4) + " K, reached " + decimal(reached, 4) +
         (reading.black_body_settled ? " K, settled" : " K, still settling");
}

std::optional<std::string> ScpiTarget::stage_lacks(const Reading& reading, const TargetState& asked) const {
  const auto& reached = reading.target.state;
  const cv::Point2d miss = reached.shift_mm - asked.shift_mm;
  const bool in_place = std::max(std::abs(miss.x), std::abs(miss.y)) <= options_.shift_tolerance_mm;
  if (reading.stage_settled && in_place && reached.plate == asked.plate && reached.mounting == asked.mounting)
    return {};
  const auto describe = [](const TargetState& state) {
    return "plate '" + state.plate + "' " + name_of(state.mounting).description + " at " +
           position_text(state.shift_mm) + " mm";
  };
  return stage_.name() + ": asked for " + describe(asked) + ", reached " + describe(reached) +
         (reading.stage_settled ? ", at rest" : ", still moving");
}

Result<PresentedTarget> ScpiTarget::wait_until_reached(const TargetState& asked, const std::stop_token& stop) {
  auto reached = poll_until_reached(asked, stop);
  if (std::exchange(wait_reported_, false)) options_.on_wait(std::nullopt);
  return reached;
}

Result<PresentedTarget> ScpiTarget::poll_until_reached(const TargetState& asked, const std::stop_token& stop) {
  const auto start = options_.now();
  auto reported = start;
  std::mutex mutex;
  std::condition_variable_any wake;
  for (;;) {
    auto reading = read(stop);
    if (!reading) return tl::unexpected(reading.error());
    const auto waited = options_.now() - start;
    const auto black_body = black_body_lacks(*reading, asked);
    const auto stage = stage_lacks(*reading, asked);
    if (!black_body && !stage) {
      reading->target.settling_s = std::chrono::duration<double>(waited).count();
      return reading->target;
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
                                  .reached = reading->target.state,
                                  .contrast_there = !black_body,
                                  .plate_there = !stage,
                                  .waited_s = std::chrono::duration<double>(waited).count(),
                                  .timeout_s = std::chrono::duration<double>(options_.settle_timeout).count()});
    }
    std::unique_lock lock(mutex);
    wake.wait_for(lock, stop, options_.poll_interval, [] { return false; });
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped while the target settles");
  }
}

Result<PresentedTarget> ScpiTarget::present(const TargetState& state, std::stop_token stop) {
  if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the target was set");
  if (auto done = check_within_limits(state); !done) return tl::unexpected(done.error());
  if (auto done = black_body_.ensure_connected(stop); !done) return tl::unexpected(done.error());
  if (auto done = stage_.ensure_connected(stop); !done) return tl::unexpected(done.error());
  // The slowest first, so that they settle together.
  if (auto done = command_temperature(state, stop); !done) return tl::unexpected(done.error());
  if (auto done = command_plate(state, stop); !done) return tl::unexpected(done.error());
  if (auto done = command_position(state, stop); !done) return tl::unexpected(done.error());
  return wait_until_reached(state, stop);
}

}  // namespace

Result<std::unique_ptr<Target>> open_scpi_target(ScpiTargetOptions options, const std::stop_token& stop) {
  auto target = std::make_unique<ScpiTarget>(std::move(options));
  if (auto opened = target->open(stop); !opened) return tl::unexpected(opened.error());
  return target;
}

}  // namespace todbench
