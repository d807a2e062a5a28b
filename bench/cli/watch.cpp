// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/watch.h"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/judgement/verdict_record.h"
#include "bench/report/curve_lines.h"
#include "bench/run/running_fit.h"
#include "bench/session/provenance.h"
#include "bench/session/session_folder.h"
#include "bench/session/trials_csv.h"
#include "bench/text/files.h"
#include "bench/text/json.h"
#include "bench/text/json_file.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr auto look_period = std::chrono::seconds(1);

Result<SessionState> state_of(const std::filesystem::path& folder) {
  TODBENCH_TRY(const auto json, read_json_file(folder / "provenance.json"));
  TODBENCH_TRY(const auto provenance, provenance_from(json));
  return provenance.state;
}

std::uintmax_t size_of(const std::filesystem::path& file) {
  std::error_code none;
  const auto bytes = std::filesystem::file_size(file, none);
  return none ? 0 : bytes;
}

/// Fits the trials so far. The last line of a growing file may be incomplete: then there is no curve this time.
std::optional<TodCurve> curve_of(const std::filesystem::path& trials, RunningFit& fit, const std::stop_token& stop) {
  std::error_code none;
  if (!std::filesystem::exists(trials, none)) return std::nullopt;
  const auto read = read_trials(trials);
  if (!read || read->empty()) return std::nullopt;
  return fit.curve_of(*read, stop);
}

void show(Console& console, const CurveLines& lines) {
  if (console.audience() == Console::Audience::terminal) {
    console.picture(curve_lines(lines, console.columns() - 1));
  } else {
    console.note(curve_in_one_line(lines));
  }
}

int conclude(Console& console, const std::filesystem::path& folder, SessionState state) {
  if (state == SessionState::interrupted) {
    console.text("the session was interrupted; its trials so far are valid");
    return exit_code(ErrorCode::interrupted);
  }
  const auto json = read_json_file(folder / "verdict.json");
  if (!json) return report_error(console, json.error());
  const auto verdict = verdict_from(*json);
  if (!verdict) return report_error(console, with_context((folder / "verdict.json").string(), verdict.error()));
  if (console.json()) {
    console.object({{"session", folder.string()}, {"verdict", to_string(verdict->decision)}});
  } else {
    console.text("verdict: " + std::string(to_string(verdict->decision)) + " (" + verdict->reason + ")");
  }
  return exit_code(verdict->decision);
}

}  // namespace

int watch_session(Console& console, const std::filesystem::path& folder, const std::stop_token& stop) {
  const auto plan = load_plan((folder / "session.toml").string());
  if (!plan) return report_error(console, with_context(folder.string(), plan.error()));
  RunningFit fit(*plan);
  std::mutex mutex;
  std::condition_variable_any wake;
  std::uintmax_t shown_bytes = 0;
  for (;;) {
    // Read the state first: data read later are at least as new.
    const auto state = state_of(folder);
    if (!state) return report_error(console, state.error());
    const auto bytes = size_of(folder / "trials.csv") + size_of(folder / "trials_simulated.csv");
    if (bytes != shown_bytes) {
      shown_bytes = bytes;
      std::optional<TodCurve> measured, twin;
      if (const auto session = *state == SessionState::running ? Result<Session>(Session{}) : read_session(folder)) {
        measured = session->curve;
        twin = session->twin;
      }
      // While it runs, and if it left no fits.
      if (!measured) measured = curve_of(folder / "trials.csv", fit, stop);
      if (!twin) twin = curve_of(folder / "trials_simulated.csv", fit, stop);
      show(console, {.delta_t_k = plan->target.delta_t_k,
                     .measured = measured ? &*measured : nullptr,
                     .twin = twin ? &*twin : nullptr,
                     .limits = plan->limits.acuity});
    }
    if (*state != SessionState::running) return conclude(console, folder, *state);
    std::unique_lock lock(mutex);
    wake.wait_for(lock, stop, look_period, [] { return false; });
    if (stop.stop_requested()) return exit_code(ErrorCode::interrupted);
  }
}

}  // namespace todbench
