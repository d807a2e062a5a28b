// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/instruments/plate_stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "acquisition/base/rng.h"
#include "sim_devices/lab/instruments/elapsed_time.h"
#include "tod/instruments/scpi_client.h"

namespace todbench {
namespace {

using TimePoint = std::chrono::steady_clock::time_point;
using Parameters = std::span<const std::string>;

struct MountingKeyword {
  Mounting mounting;
  std::string_view mnemonic, short_form;
};
constexpr std::array mounting_keywords{MountingKeyword{Mounting::identity, "IDENtity", "IDEN"},
                                       MountingKeyword{Mounting::rotated_180, "ROTated", "ROT"},
                                       MountingKeyword{Mounting::mirrored_horizontally, "HMIRrored", "HMIR"},
                                       MountingKeyword{Mounting::mirrored_vertically, "VMIRrored", "VMIR"}};

std::string short_form(Mounting mounting) {
  const auto* found = std::find_if(mounting_keywords.begin(), mounting_keywords.end(),
                                   [&](const auto& keyword) { return keyword.mounting == mounting; });
  return std::string(found->short_form);
}

template <typename C>
bool is_complete(const C& change, TimePoint time) {
  return seconds_between(change.since, time) >= change.duration_s;
}

template <typename C>
auto value_at(const C& change, TimePoint time) {
  return is_complete(change, time) ? change.to : change.from;
}

// Starts a change from the present state. A repeated goal changes nothing.
template <typename C, typename T>
void change_to(C& change, T value, TimePoint time, double duration_s) {
  if (change.to == value) return;
  change.from = value_at(change, time);
  change.to = std::move(value);
  change.since = std::max(time, change.since);
  change.duration_s = duration_s;
}

template <typename C>
cv::Point2d position_at(const C& run, TimePoint time) {
  if (is_complete(run, time)) return run.to;
  return run.from + (run.to - run.from) * (seconds_between(run.since, time) / run.duration_s);
}

std::string position_text(cv::Point2d position_mm) {
  return scpi_decimal(position_mm.x, 4) + "," + scpi_decimal(position_mm.y, 4);
}

// Written so that NaN fails. Slot names go through SCPI string data, which is printable ASCII.
bool is_valid(const PlateStageOptions& o) {
  const auto printable = [](const std::string& name) {
    return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) { return c >= 0x20 && c <= 0x7e; });
  };
  return !o.plates.empty() && std::all_of(o.plates.begin(), o.plates.end(), printable) &&
         std::set(o.plates.begin(), o.plates.end()).size() == o.plates.size() && o.travel_mm >= 0 &&
         o.speed_mm_per_s > 0 && o.settle_s >= 0 && o.resolution_mm > 0 && o.plate_change_s >= 0 &&
         o.mounting_change_s >= 0 && o.slowest_run_mm_per_s > 0 && o.slowest_run_mm_per_s <= o.speed_mm_per_s &&
         o.run_jitter_mm >= 0 && o.now;
}

// A query without parameters.
template <typename Answer>
ScpiCommand query(std::string header, Answer answer) {
  return {std::move(header), [answer](Parameters parameters) -> ScpiAnswer {
            if (auto count = scpi_count(parameters, 0); !count) return tl::unexpected(count.error());
            return answer();
          }};
}

}  // namespace

Result<std::unique_ptr<PlateStage>> PlateStage::start(PlateStageOptions options) {
  if (!is_valid(options))
    return fail(ErrorCode::invalid_input, "plate stage " + options.serial +
                                              ": needs slots with distinct printable names, a positive speed and "
                                              "resolution, and no negative times or travel");
  const auto time = options.now() - std::chrono::hours(24);
  const Motion at_rest{{options.plates.front(), options.plates.front(), time, 0},
                       {Mounting::identity, Mounting::identity, time, 0},
                       {{0, 0}, {0, 0}, time, 0},
                       std::nullopt};
  auto server_options = options.server;
  auto stage = std::make_unique<PlateStage>(std::move(options), at_rest);
  auto server = ScpiServer::start(std::move(server_options), stage->language());
  if (!server) return fail("starting the emulated plate stage", server.error());
  stage->server_ = std::move(*server);
  return stage;
}

PlateStage::PlateStage(PlateStageOptions options, Motion motion)
    : options_(std::move(options)), motion_(std::move(motion)) {}

PlateStage::Motion PlateStage::motion() const {
  const std::scoped_lock lock(mutex_);
  return motion_;
}

double PlateStage::camera_time_s() const {
  if (options_.camera_clock_s) return options_.camera_clock_s();
  return std::chrono::duration<double>(options_.now().time_since_epoch()).count();
}

cv::Point2d PlateStage::place_in(const Motion& motion, double camera_time_s) const {
  const cv::Point2d there = position_at(motion.position, options_.now());
  if (!motion.run) return there;
  const double gone_s = camera_time_s - motion.run->start_s.value_or(0);
  if (gone_s >= motion.run->duration_s()) return there;
  const auto millisecond = static_cast<std::uint64_t>(std::max(0.0, camera_time_s) * 1000);
  const double jitter_mm =
      options_.run_jitter_mm * static_cast<double>(RandomStream(options_.seed, "stage.jitter").normal(millisecond));
  return {motion.run->from_mm + motion.run->direction() * motion.run->speed_mm_s * std::max(0.0, gone_s) + jitter_mm,
          there.y};
}

PlateStageState PlateStage::state_at(double camera_time_s) const {
  const auto time = options_.now();
  const Motion current = motion();
  const bool table_at_rest =
      seconds_between(current.position.since, time) >= current.position.duration_s + options_.settle_s;
  PlateStageState state;
  state.plate = value_at(current.plate, time);
  state.mounting = value_at(current.mounting, time);
  state.shift_mm = place_in(current, camera_time_s);
  const bool runs = current.run && camera_time_s - current.run->start_s.value_or(0) < current.run->duration_s();
  if (runs) state.speed_mm_per_s = current.run->direction() * current.run->speed_mm_s;
  state.is_moving = runs || !table_at_rest || !is_complete(current.plate, time) || !is_complete(current.mounting, time);
  return state;
}

void PlateStage::move_to(cv::Point2d position_mm) {
  const auto time = options_.now();
  const auto rounded = [&](double mm) { return std::round(mm / options_.resolution_mm) * options_.resolution_mm; };
  const cv::Point2d goal{rounded(position_mm.x), rounded(position_mm.y)};
  const double camera_time = camera_time_s();
  const std::scoped_lock lock(mutex_);
  auto& run = motion_.position;
  const cv::Point2d here = place_in(motion_, camera_time);
  if (goal == run.to && here == goal) return;
  if (!motion_.run && goal == run.to) return;  // on its way
  motion_.run.reset();
  run.from = here;
  run.to = goal;
  run.since = std::max(time, run.since);
  run.duration_s = std::hypot(run.to.x - run.from.x, run.to.y - run.from.y) / options_.speed_mm_per_s;
}

std::vector<ScpiCommand> PlateStage::plate_commands() {
  const auto select = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 1); !count) return tl::unexpected(count.error());
    if (std::find(options_.plates.begin(), options_.plates.end(), parameters[0]) == options_.plates.end())
      return tl::unexpected(ScpiError{-224, "Illegal parameter value; no such plate"});
    const auto time = options_.now();
    const std::scoped_lock lock(mutex_);
    change_to(motion_.plate, parameters[0], time, options_.plate_change_s);
    return "";
  };
  const auto catalogue = [this] {
    std::string names;
    for (const auto& plate : options_.plates) names.append(names.empty() ? "" : ",").append(scpi_quoted(plate));
    return names;
  };
  return {{"ROUTe:PLATe", select},
          query("ROUTe:PLATe?", [this] { return scpi_quoted(motion().plate.to); }),
          query("ROUTe:PLATe:ACTual?", [this] { return scpi_quoted(state().plate); }),
          query("ROUTe:PLATe:CATalog?", catalogue)};
}

std::vector<ScpiCommand> PlateStage::mounting_commands() {
  const auto select = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 1); !count) return tl::unexpected(count.error());
    const auto* found = std::find_if(mounting_keywords.begin(), mounting_keywords.end(), [&](const auto& keyword) {
      return scpi_keyword(parameters[0], keyword.mnemonic);
    });
    if (found == mounting_keywords.end()) return tl::unexpected(ScpiError{-224, "Illegal parameter value"});
    const auto time = options_.now();
    const std::scoped_lock lock(mutex_);
    change_to(motion_.mounting, found->mounting, time, options_.mounting_change_s);
    return "";
  };
  return {{"ROUTe:MOUNting", select},
          query("ROUTe:MOUNting?", [this] { return short_form(motion().mounting.to); }),
          query("ROUTe:MOUNting:ACTual?", [this] { return short_form(state().mounting); })};
}

std::vector<ScpiCommand> PlateStage::position_commands() {
  const auto move = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 2); !count) return tl::unexpected(count.error());
    const auto x = scpi_number(parameters[0], -options_.travel_mm, options_.travel_mm, "MM");
    if (!x) return tl::unexpected(x.error());
    const auto y = scpi_number(parameters[1], -options_.travel_mm, options_.travel_mm, "MM");
    if (!y) return tl::unexpected(y.error());
    move_to({*x, *y});
    return "";
  };
  const auto limits = [this] {
    const cv::Point2d range{-options_.travel_mm, options_.travel_mm};
    return position_text(range) + "," + position_text(range);
  };
  return {{"[SOURce:]POSition", move},
          query("[SOURce:]POSition?", [this] { return position_text(motion().position.to); }),
          query("[SOURce:]POSition:LIMits?", limits),
          query("MEASure:POSition?", [this] { return position_text(state().shift_mm); })};
}

std::vector<ScpiCommand> PlateStage::run_commands() {
  const auto start = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 2); !count) return tl::unexpected(count.error());
    const auto x = scpi_number(parameters[0], -options_.travel_mm, options_.travel_mm, "MM");
    if (!x) return tl::unexpected(x.error());
    const auto speed = scpi_number(parameters[1], options_.slowest_run_mm_per_s, options_.speed_mm_per_s, "MM/S");
    if (!speed) return tl::unexpected(speed.error());
    const double camera_time = camera_time_s();
    const auto time = options_.now();
    const std::scoped_lock lock(mutex_);
    const cv::Point2d here = place_in(motion_, camera_time);
    if (here.x == *x) return tl::unexpected(ScpiError{-221, "Settings conflict; the plate is already there"});
    motion_.position = {{*x, here.y}, {*x, here.y}, time, 0};
    motion_.run = PlateRun{.from_mm = here.x, .to_mm = *x, .speed_mm_s = *speed, .start_s = camera_time};
    return "";
  };
  const auto limits = [this] {
    return scpi_decimal(options_.slowest_run_mm_per_s, 4) + "," + scpi_decimal(options_.speed_mm_per_s, 4);
  };
  const auto last = [this] {
    const auto run = motion().run;
    if (!run) return std::string("0,0,0,9.91E37");
    return scpi_decimal(run->from_mm, 4) + "," + scpi_decimal(run->to_mm, 4) + "," + scpi_decimal(run->speed_mm_s, 4) +
           "," + (options_.has_trigger ? scpi_decimal(*run->start_s, 9) : "9.91E37");
  };
  return {{"[SOURce:]SCAN", start}, query("[SOURce:]SCAN:LIMits?", limits), query("MEASure:SCAN?", last)};
}

ScpiLanguage PlateStage::language() {
  const auto reset = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 0); !count) return tl::unexpected(count.error());
    move_to({0, 0});
    return "";
  };
  std::vector<ScpiCommand> commands{{"*RST", reset}, query("STATus:OPERation:CONDition?", [this] {
                                      return std::string(state().is_moving ? "2" : "0");
                                    })};
  for (auto part : {plate_commands(), mounting_commands(), position_commands(), run_commands()})
    commands.insert(commands.end(), part.begin(), part.end());
  return {"todbench,Emulated plate stage," + options_.serial + ",1.0", std::move(commands)};
}

}  // namespace todbench
