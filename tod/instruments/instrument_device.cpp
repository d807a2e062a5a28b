// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/instrument_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

// Differences below these count as equal set-points: half the last digit of instruments of this class.
constexpr double same_temperature_k = 0.0005;
constexpr double same_position_mm = 0.0005;
// No plate or radiator of a bench is hotter.
constexpr double hottest_k = 5000;

/// A number as sent: in the unit of the file, with its decimals.
std::string sent_number(double value, const InstrumentUnit& unit, int decimals) {
  return fmt::format("{:.{}f}", (value - unit.offset) / unit.scale, decimals);
}

double in_ours(double value, const InstrumentUnit& unit) {
  return value * unit.scale + unit.offset;
}

/// Index of an enumerator that counts from 0.
std::size_t place_of(Mounting mounting) {
  return static_cast<std::size_t>(std::find(all_mountings.begin(), all_mountings.end(), mounting) -
                                  all_mountings.begin());
}

}  // namespace

InstrumentDevice::InstrumentDevice(std::string role, std::string endpoint, ScpiClientOptions options,
                                   InstrumentTable table)
    : role_(std::move(role)), endpoint_(std::move(endpoint)), options_(options), table_(std::move(table)) {}

Result<void> InstrumentDevice::ensure_connected(const std::stop_token& stop) {
  if (client_ && client_->is_open()) return {};
  auto client = ScpiClient::connect(endpoint_, options_, stop, table_.speech);
  if (!client) {
    Error error = client.error();
    if (client_ && error.code == ErrorCode::not_found) error.code = ErrorCode::disconnected;
    return fail(role_, error);
  }
  if (client_ && client_->identity() != client->identity())
    return fail(ErrorCode::disconnected, role_ + " at " + endpoint_ + ": the instrument was " +
                                             to_text(client_->identity()) + " and is now " +
                                             to_text(client->identity()));
  client_.emplace(std::move(*client));
  return {};
}

std::string InstrumentDevice::name() const {
  const std::string who = client_ ? to_text(client_->identity()) : "";
  return role_ + " (" + (who.empty() ? table_.description : who) + ")";
}

namespace {

template <typename T>
Result<T> of_instrument(const InstrumentDevice& device, Result<T> result) {
  if (result) return result;
  // An instrument that refuses a supported request cannot be used for measurement. It is not an error of the plan,
  // because its states were checked against the limits stated by the instrument.
  const bool refuses = result.error().code == ErrorCode::invalid_input;
  return fail(device.name(), refuses ? with_code(ErrorCode::disconnected, result.error()) : result.error());
}

}  // namespace

Result<void> InstrumentDevice::send(const std::string& text, const std::stop_token& stop) {
  return of_instrument(*this, client_->command(text, stop));
}

Result<std::string> InstrumentDevice::ask(const std::string& text, const std::stop_token& stop) {
  return of_instrument(*this, client_->query(text, stop));
}

Result<std::vector<double>> InstrumentDevice::numbers(const NumberQuestion& question, std::size_t count,
                                                      const std::stop_token& stop) {
  std::vector<double> all;
  for (const auto& query : question.queries) {
    const std::string form = question.answer.empty() ? comma_form(count / question.queries.size()) : question.answer;
    auto some = of_instrument(*this, client_->query_form(query, form, stop));
    if (!some) return some;
    all.insert(all.end(), some->begin(), some->end());
  }
  if (all.size() != count)
    return fail(ErrorCode::disconnected,
                name() + fmt::format(": answered {} numbers instead of {}", all.size(), count));
  return all;
}

Result<bool> InstrumentDevice::is_settled(const std::stop_token& stop) {
  const SettledRule& rule = table_.settled;
  if (rule.query.empty()) return true;
  if (!rule.bit) {
    TODBENCH_TRY(auto answer, ask(rule.query, stop));
    return std::find(rule.answers.begin(), rule.answers.end(), answer) != rule.answers.end();
  }
  auto condition = numbers({{rule.query}, ""}, 1, stop);
  if (!condition) return tl::unexpected(condition.error());
  const double bits = condition->front();
  if (bits < 0 || bits > std::numeric_limits<std::uint16_t>::max())
    return fail(ErrorCode::disconnected,
                name() + ": the answer to " + rule.query + " is not the value of a 16-bit register");
  const bool set = (static_cast<unsigned>(bits) >> *rule.bit & 1U) != 0;
  return set != rule.bit_means_settling;
}

Result<double> BlackBodyDevice::difference(const NumberQuestion& question, const std::stop_token& stop) {
  TODBENCH_TRY(auto value, numbers(question, 1, stop));
  return in_ours(value.front(), words().unit);
}

Result<std::array<double, 2>> BlackBodyDevice::limits(const std::stop_token& stop) {
  if (!words().limits.asks()) return words().limits_k;
  TODBENCH_TRY(auto ends, numbers(words().limits, 2, stop));
  return std::array{in_ours(ends[0], words().unit), in_ours(ends[1], words().unit)};
}

Result<double> BlackBodyDevice::set_point(const std::stop_token& stop) {
  return difference(words().set_point, stop);
}

std::string BlackBodyDevice::set_command(double delta_t_k) const {
  return command_of(words().set, {sent_number(delta_t_k, words().unit, words().decimals)});
}

Result<void> BlackBodyDevice::command(double delta_t_k, const std::stop_token& stop) {
  if (words().set_point.asks()) {
    TODBENCH_TRY(auto now_k, set_point(stop));
    if (std::abs(now_k - delta_t_k) <= same_temperature_k) return {};
  }
  return send(set_command(delta_t_k), stop);
}

Result<std::array<double, 2>> BlackBodyDevice::absolute_limits(const std::stop_token& stop) {
  const AbsoluteWords& absolute = *words().absolute;
  if (!absolute.limits.asks()) return absolute.limits_k;
  TODBENCH_TRY(const auto ends, numbers(absolute.limits, 2, stop));
  return std::array{in_ours(ends[0], words().absolute_unit), in_ours(ends[1], words().absolute_unit)};
}

Result<void> BlackBodyDevice::command_absolute(double temperature_k, const std::stop_token& stop) {
  const AbsoluteWords& absolute = *words().absolute;
  if (absolute.set_point.asks()) {
    TODBENCH_TRY(const auto now, numbers(absolute.set_point, 1, stop));
    if (std::abs(in_ours(now.front(), words().absolute_unit) - temperature_k) <= same_temperature_k) return {};
  }
  return send(command_of(absolute.set, {sent_number(temperature_k, words().absolute_unit, absolute.decimals)}), stop);
}

Result<double> BlackBodyDevice::radiator(double coldest_k, const std::stop_token& stop) {
  TODBENCH_TRY(const auto value, numbers(words().radiator, 1, stop));
  const double kelvin = in_ours(value.front(), words().absolute_unit);
  // A black body is never colder than half of its coldest set-point: 17 read where 290 K are possible are 17 degrees.
  if (kelvin > 0.5 * coldest_k && kelvin <= hottest_k) return kelvin;
  return fail(ErrorCode::invalid_input,
              name() + fmt::format(": {} answered {:g}, which is {:.2f} K by its table, but its set-points begin at "
                                   "{:g} K: does it answer in degrees Celsius? State unit = \"degC\" in [temperatures] "
                                   "of the table",
                                   words().radiator.queries.front(), value.front(), kelvin, coldest_k));
}

Result<double> BlackBodyDevice::measured(const std::stop_token& stop) {
  return difference(words().measured, stop);
}

Result<double> BlackBodyDevice::temperature(const NumberQuestion& question, const std::stop_token& stop) {
  TODBENCH_TRY(auto value, numbers(question, 1, stop));
  const double kelvin = in_ours(value.front(), words().absolute_unit);
  if (kelvin > 0 && kelvin <= hottest_k) return kelvin;
  return fail(ErrorCode::disconnected, name() + ": " + question.queries.front() + " answered " +
                                           fmt::format("{:.3f}", kelvin) + " K, which is not a possible temperature");
}

Result<BlackBodyReading> BlackBodyDevice::read(const std::stop_token& stop) {
  BlackBodyReading reading;
  TODBENCH_TRY(reading.delta_t_k, measured(stop));
  for (const auto& [question, value] :
       {std::pair(&words().plate, &reading.plate_k), std::pair(&words().radiator, &reading.radiator_k)}) {
    if (!question->asks()) continue;
    TODBENCH_TRY(auto kelvin, temperature(*question, stop));
    *value = kelvin;
  }
  return reading;
}

Result<std::vector<double>> StageDevice::travel(const std::stop_token& stop) {
  const StagePosition& position = *words().position;
  if (!position.limits.asks()) return std::vector(position.limits_mm.begin(), position.limits_mm.end());
  auto ends = numbers(position.limits, 4, stop);
  if (!ends) return ends;
  for (double& end : *ends) end = in_ours(end, position.unit);
  return ends;
}

Result<std::array<double, 2>> StageDevice::run_speeds(const std::stop_token& stop) {
  const StageRun& run = *words().run;
  if (!run.limits.asks()) return run.limits_mm_s;
  TODBENCH_TRY(const auto ends, numbers(run.limits, 2, stop));
  const InstrumentUnit& unit = words().position->unit;
  return std::array{ends[0] * unit.scale, ends[1] * unit.scale};
}

Result<PlateRun> StageDevice::run_along_x(double to_mm, double speed_mm_s, const std::stop_token& stop) {
  const InstrumentUnit& unit = words().position->unit;
  const int decimals = words().position->decimals;
  const InstrumentUnit per_second{.name = unit.name, .scale = unit.scale, .offset = 0};
  const std::string text =
      command_of(words().run->set, {sent_number(to_mm, unit, decimals), sent_number(speed_mm_s, per_second, decimals)});
  TODBENCH_TRY_VOID(send(text, stop));
  TODBENCH_TRY(const auto said, numbers(words().run->measured, 4, stop));
  constexpr double not_a_number = 9e37;  // SCPI-99 volume 1, 7.2.1.5: 9.91E37
  PlateRun run{
      .from_mm = in_ours(said[0], unit), .to_mm = in_ours(said[1], unit), .speed_mm_s = in_ours(said[2], per_second)};
  if (said[3] < not_a_number) run.start_s = said[3];
  // This form also rejects NaN.
  if (!(run.speed_mm_s > 0) || run.from_mm == run.to_mm)
    return fail(ErrorCode::disconnected, name() + ": reports no run after " + text);
  return run;
}

Result<std::vector<std::string>> StageDevice::plate_names(const std::stop_token& stop) {
  if (words().catalogue.empty()) return words().plates;
  TODBENCH_TRY(auto answer, ask(words().catalogue, stop));
  return scpi_fields(answer);
}

Result<StageLimits> StageDevice::limits(const std::stop_token& stop) {
  StageLimits limits;
  if (words().position) {
    TODBENCH_TRY(auto ends, travel(stop));
    const auto& t = ends;
    limits.min_mm = {t[0], t[2]};
    limits.max_mm = {t[1], t[3]};
  }
  TODBENCH_TRY(limits.plates, plate_names(stop));
  return limits;
}

bool StageDevice::holds(Mounting mounting) const {
  if (words().mounting.set.empty()) return mounting == Mounting::identity;
  return !words().mounting_words[place_of(mounting)].empty();
}

std::string StageDevice::plate_command(const std::string& plate) const {
  std::string word = plate;
  for (std::size_t i = 0; i < words().plates.size(); ++i) {
    if (words().plates[i] == plate) word = words().plate_words[i];
  }
  return command_of(words().plate.set, {words().quoted ? scpi_quoted(word) : word});
}

std::string StageDevice::mounting_command(Mounting mounting) const {
  return command_of(words().mounting.set, {words().mounting_words[place_of(mounting)]});
}

std::vector<std::string> StageDevice::position_commands(cv::Point2d place_mm) const {
  const StagePosition& position = *words().position;
  const std::string x = sent_number(place_mm.x, position.unit, position.decimals);
  const std::string y = sent_number(place_mm.y, position.unit, position.decimals);
  if (position.set.size() == 1) return {command_of(position.set.front(), {x, y})};
  return {command_of(position.set[0], {x}), command_of(position.set[1], {y})};
}

Result<std::string> StageDevice::plate(const std::string& query, const std::stop_token& stop) {
  auto answer = ask(query, stop);
  if (!answer) return answer;
  const std::string word = scpi_fields(*answer).front();
  for (std::size_t i = 0; i < words().plates.size(); ++i) {
    if (words().plate_words[i] == word) return words().plates[i];
  }
  return word;
}

Result<Mounting> StageDevice::mounting(const std::string& query, const std::stop_token& stop) {
  TODBENCH_TRY(auto answer, ask(query, stop));
  for (std::size_t i = 0; i < all_mountings.size(); ++i) {
    if (!answer.empty() && words().mounting_words[i] == answer) return all_mountings[i];
  }
  return fail(ErrorCode::disconnected, name() + ": " + query + " answered an unknown mounting");
}

Result<cv::Point2d> StageDevice::position(const NumberQuestion& question, const std::stop_token& stop) {
  TODBENCH_TRY(auto place, numbers(question, 2, stop));
  const InstrumentUnit& unit = words().position->unit;
  return cv::Point2d(in_ours(place[0], unit), in_ours(place[1], unit));
}

Result<void> StageDevice::command_plate(const TargetState& state, const std::stop_token& stop) {
  const StageChoice& choice = words().plate;
  if (choice.set.empty()) return {};
  if (!choice.set_point.empty()) {
    TODBENCH_TRY(auto asked, plate(choice.set_point, stop));
    if (asked == state.plate) return {};
  }
  return send(plate_command(state.plate), stop);
}

Result<void> StageDevice::command_mounting(const TargetState& state, const std::stop_token& stop) {
  const StageChoice& choice = words().mounting;
  if (choice.set.empty()) return {};
  if (!choice.set_point.empty()) {
    TODBENCH_TRY(auto answer, ask(choice.set_point, stop));
    if (answer == words().mounting_words[place_of(state.mounting)]) return {};
  }
  return send(mounting_command(state.mounting), stop);
}

Result<void> StageDevice::command_position(const TargetState& state, const std::stop_token& stop) {
  if (!words().position) return {};
  if (words().position->set_point.asks()) {
    TODBENCH_TRY(auto asked, position(words().position->set_point, stop));
    const cv::Point2d miss = asked - state.shift_mm;
    if (std::abs(miss.x) <= same_position_mm && std::abs(miss.y) <= same_position_mm) return {};
  }
  for (const auto& text : position_commands(state.shift_mm)) {
    TODBENCH_TRY_VOID(send(text, stop));
  }
  return {};
}

Result<void> StageDevice::command(const TargetState& state, const std::stop_token& stop) {
  TODBENCH_TRY_VOID(command_plate(state, stop));
  TODBENCH_TRY_VOID(command_mounting(state, stop));
  return command_position(state, stop);
}

Result<TargetState> StageDevice::read(const TargetState& asked, const std::stop_token& stop) {
  TargetState reached = asked;
  if (!words().plate.measured.empty()) {
    TODBENCH_TRY(reached.plate, plate(words().plate.measured, stop));
  }
  if (!words().mounting.measured.empty()) {
    TODBENCH_TRY(reached.mounting, mounting(words().mounting.measured, stop));
  }
  if (words().position) {
    TODBENCH_TRY(reached.shift_mm, position(words().position->measured, stop));
  }
  return reached;
}

}  // namespace todbench
