// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/recorded_answers.h"

#include <charconv>
#include <cmath>
#include <limits>

#include "acquisition/base/try.h"
#include "bench/text/json_fields.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr double unknown_number = std::numeric_limits<double>::quiet_NaN();
constexpr const char* rest_tag = "rest";
constexpr const char* calls_tag = "calls";
constexpr const char* recovery_tag = "recovery";
constexpr const char* target_tag = "target";
constexpr const char* again_tag = "again";

std::string clock_tag(Moment why) {
  return "clock." + std::string(to_string(why));
}

/// A number that is not finite is null.
void state_fields(JsonFields& json, TargetState& state) {
  json.value("plate", state.plate);
  json.value("mounting", state.mounting, all_mountings);
  json.number_or("delta_t_k", state.delta_t_k, unknown_number);
  json.number_or("shift_x_mm", state.shift_mm.x, unknown_number);
  json.number_or("shift_y_mm", state.shift_mm.y, unknown_number);
}

void error_fields(JsonFields& json, Error& error) {
  constexpr auto last = static_cast<std::int64_t>(ErrorCode::internal);
  auto code = static_cast<std::int64_t>(error.code);
  json.value("code", code);
  json.value("message", error.message);
  error.code = static_cast<ErrorCode>(code >= 0 && code <= last ? code : last);
}

void outcome_fields(JsonFields& json, std::optional<Error>& failed) {
  json.value("failed", failed, error_fields);
}

/// Request to a target and its report.
struct TargetAnswer {
  TargetState set;
  std::optional<Error> failed{};
  PresentedTarget said{};  ///< if it did not fail
};

void target_answer_fields(JsonFields& json, TargetAnswer& answer) {
  json.value("set", answer.set, state_fields);
  outcome_fields(json, answer.failed);
  if (answer.failed) return;
  json.value("reached", answer.said.state, state_fields);
  json.value("plate_temperature_k", answer.said.plate_temperature_k);
  json.value("black_body_temperature_k", answer.said.black_body_temperature_k);
  json.number_or("settling_s", answer.said.settling_s, unknown_number);
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
  const std::optional<Error> failed = back ? std::nullopt : std::optional(back.error());
  return {recovery_tag, to_line(json_of(failed, outcome_fields).value_or(Json()))};
}

Reading again_answer() {
  return {again_tag, "1"};
}

Reading target_answer(const TargetState& set, const Result<PresentedTarget>& said) {
  const TargetAnswer answer = said ? TargetAnswer{set, std::nullopt, *said} : TargetAnswer{set, said.error()};
  return {target_tag, to_line(json_of(answer, target_answer_fields).value_or(Json()))};
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
  TODBENCH_TRY(const auto text, take(tag));
  std::int64_t value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size())
    return refuse("a whole number for '" + tag + "'", "'" + one_line(text) + "'");
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
  TODBENCH_TRY(const std::string text, take(recovery_tag));
  const auto failed = from_json<std::optional<Error>>(Json::parse(text, nullptr, false), outcome_fields);
  if (!failed) return refuse("an outcome for 'recovery'", failed.error().message);
  if (*failed) return tl::unexpected(**failed);
  return {};
}

Result<PresentedTarget> RecordedAnswers::target(const TargetState& set) {
  TODBENCH_TRY(const std::string text, take(target_tag));
  const auto answer = from_json<TargetAnswer>(Json::parse(text, nullptr, false), target_answer_fields);
  if (!answer) return refuse("a report of the target", answer.error().message);
  // The recording does not state how the contrast was waited for, nor its point of the curve.
  TargetState recorded = answer->set;
  recorded.wait = set.wait;
  recorded.point_delta_t_k = set.point_delta_t_k;
  if (recorded != set) return refuse("a target set to " + described(set), described(answer->set));
  if (answer->failed) return tl::unexpected(*answer->failed);
  return answer->said;
}

bool RecordedAnswers::again() {
  if (disagreement_ || next_ == readings_.size() || readings_[next_].tag != again_tag) return false;
  ++next_;
  return true;
}

Result<void> RecordedAnswers::agreed() const {
  if (disagreement_) return tl::unexpected(*disagreement_);
  return {};
}

}  // namespace todbench
