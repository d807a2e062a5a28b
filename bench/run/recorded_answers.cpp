// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/recorded_answers.h"

#include <charconv>
#include <cmath>
#include <limits>

#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr const char* rest_tag = "rest";
constexpr const char* calls_tag = "calls";
constexpr const char* recovery_tag = "recovery";
constexpr const char* target_tag = "target";

std::string clock_tag(Moment why) {
  return "clock." + std::string(to_string(why));
}

Json state_json(const TargetState& state) {
  return {{"plate", state.plate},
          {"mounting", to_string(state.mounting)},
          {"delta_t_k", json_number(state.delta_t_k)},
          {"shift_x_mm", json_number(state.shift_mm.x)},
          {"shift_y_mm", json_number(state.shift_mm.y)}};
}

Json error_json(const Error& error) {
  return {{"code", static_cast<int>(error.code)}, {"message", error.message}};
}

/// Converts an absent number back to NaN.
double number_of(const JsonReader& reader) {
  return reader.optional_number().value_or(std::numeric_limits<double>::quiet_NaN());
}

TargetState state_of(const JsonReader& reader) {
  TargetState state;
  state.plate = reader.at("plate").text();
  state.mounting = reader.at("mounting").named(all_mountings);
  state.delta_t_k = number_of(reader.at("delta_t_k"));
  state.shift_mm = {number_of(reader.at("shift_x_mm")), number_of(reader.at("shift_y_mm"))};
  return state;
}

Error error_of(const JsonReader& reader) {
  const auto last = static_cast<std::int64_t>(ErrorCode::internal);
  const std::int64_t code = reader.at("code").whole();
  return {static_cast<ErrorCode>(code >= 0 && code <= last ? code : last), reader.at("message").text()};
}

std::string described(const TargetState& state) {
  return state.plate + " " + std::string(to_string(state.mounting)) + " at " + number_text(state.delta_t_k) +
         " K, shifted by " + number_text(state.shift_mm.x) + ", " + number_text(state.shift_mm.y) + " mm";
}

}  // namespace

Reading clock_answer(Moment why, std::int64_t now_ns) {
  return {clock_tag(why), std::to_string(now_ns)};
}

Reading rest_answer(bool rests) {
  return {rest_tag, rests ? "1" : "0"};
}

Reading calls_answer(std::int64_t calls) {
  return {calls_tag, std::to_string(calls)};
}

Reading recovery_answer(const Result<void>& back) {
  return {recovery_tag, to_line(Json{{"failed", back ? Json(nullptr) : error_json(back.error())}})};
}

Reading target_answer(const TargetState& set, const Result<PresentedTarget>& said) {
  Json answer{{"set", state_json(set)}};
  answer["failed"] = said ? Json(nullptr) : error_json(said.error());
  if (said) {
    answer["reached"] = state_json(said->state);
    answer["plate_temperature_k"] = json_number(said->plate_temperature_k);
    answer["black_body_temperature_k"] = json_number(said->black_body_temperature_k);
    answer["settling_s"] = json_number(said->settling_s);
  }
  return {target_tag, to_line(answer)};
}

tl::unexpected<Error> RecordedAnswers::refuse(const std::string& expected, const std::string& found) {
  disagreement_ = Error{ErrorCode::invalid_input,
                        name_ + ": answer " + std::to_string(next_) + ": expected " + expected + ", found " + found +
                            ". Replay the session with the version of the program that measured it"};
  return tl::unexpected(*disagreement_);
}

Result<std::string> RecordedAnswers::take(const std::string& tag) {
  if (disagreement_) return tl::unexpected(*disagreement_);
  if (next_ == readings_.size()) return fail(ErrorCode::disconnected, name_ + ": the recording ends here");
  const Reading& reading = readings_[next_++];
  if (reading.tag == tag) return reading.value;
  return refuse("'" + tag + "'", reading.tag.empty() ? "a damaged answer" : "'" + one_line(reading.tag) + "'");
}

Result<std::int64_t> RecordedAnswers::take_whole(const std::string& tag) {
  const auto text = take(tag);
  if (!text) return tl::unexpected(text.error());
  std::int64_t value = 0;
  const auto [end, problem] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (problem != std::errc() || end != text->data() + text->size())
    return refuse("a whole number for '" + tag + "'", "'" + one_line(*text) + "'");
  return value;
}

Result<std::int64_t> RecordedAnswers::clock(Moment why) {
  return take_whole(clock_tag(why));
}

Result<bool> RecordedAnswers::rest() {
  return take_whole(rest_tag).map([](std::int64_t rests) { return rests == 1; });
}

Result<std::int64_t> RecordedAnswers::calls() {
  return take_whole(calls_tag);
}

Result<void> RecordedAnswers::recovery() {
  const auto text = take(recovery_tag);
  if (!text) return tl::unexpected(text.error());
  const Json json = Json::parse(*text, nullptr, false);
  const JsonReader answer(json);
  const JsonReader failed = answer.at("failed");
  const std::optional<Error> error = failed.is_null() ? std::nullopt : std::optional(error_of(failed));
  if (const auto read = answer.finish(); !read) return refuse("an outcome for 'recovery'", read.error().message);
  if (error) return tl::unexpected(*error);
  return {};
}

Result<PresentedTarget> RecordedAnswers::target(const TargetState& set) {
  const auto text = take(target_tag);
  if (!text) return tl::unexpected(text.error());
  const Json json = Json::parse(*text, nullptr, false);
  const JsonReader answer(json);
  const TargetState then = state_of(answer.at("set"));
  const JsonReader failed = answer.at("failed");
  std::optional<Error> error;
  PresentedTarget said;
  if (failed.is_null()) {
    said = {.state = state_of(answer.at("reached")),
            .plate_temperature_k = answer.at("plate_temperature_k").optional_number(),
            .black_body_temperature_k = answer.at("black_body_temperature_k").optional_number(),
            .settling_s = number_of(answer.at("settling_s"))};
  } else {
    error = error_of(failed);
  }
  if (const auto read = answer.finish(); !read) return refuse("a report of the target", read.error().message);
  if (then != set) return refuse("a target set to " + described(set), described(then));
  if (error) return tl::unexpected(*error);
  return said;
}

Result<void> RecordedAnswers::agreed() const {
  if (disagreement_) return tl::unexpected(*disagreement_);
  return {};
}

}  // namespace todbench
