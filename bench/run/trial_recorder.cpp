// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/trial_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "acquisition/base/try.h"
#include "bench/devices/processed_source.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Returns a sentence if the scale of the picture differs by 0.2 % or more from that of distance and IFOV: a distance
/// that is wrong by a share changes the acuity by the same share.
std::string scale_sentence(const SetUpRecord& set_up, double distance_m) {
  constexpr double noted_from = 0.002;
  const double deviation = set_up.registration.scale_deviation;
  if (std::abs(deviation) < noted_from) return "";
  return fmt::format(
      "plate {} is {:.2f} % {} in the picture than at {:g} m with the stated IFOV: check distance_m and ifov_mrad. If "
      "the distance is wrong, the acuity is wrong by the same share",
      set_up.plate, 100 * std::abs(deviation), deviation > 0 ? "larger" : "smaller", distance_m);
}

/// The answer to the first frame, which is that of a run without graded answers.
Trial binary(Trial trial) {
  trial.probability_correct.reset();
  trial.frames = 1;
  return trial;
}

/// The files of a run. The first error of one stops the run.
class TrialFiles {
 public:
  TrialFiles(TrialsWriter trials, TargetsWriter targets, std::stop_source& halt)
      : trials_(std::move(trials)), targets_(std::move(targets)), halt_(halt) {}

  void append(const Trial& trial) {
    if (!error_) keep(trials_.append(trial));
    if (!error_) ++on_disk_;
  }
  void append(const Presentation& shown) {
    if (!error_) keep(targets_.append(shown));
  }
  void sync() {
    keep(trials_.sync());
    keep(targets_.sync());
  }
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }
  [[nodiscard]] std::size_t on_disk() const { return on_disk_; }

 private:
  void keep(const Result<void>& written) {
    if (written || error_) return;
    error_ = written.error();
    halt_.request_stop();
  }

  TrialsWriter trials_;
  TargetsWriter targets_;
  std::stop_source& halt_;
  std::optional<Error> error_;
  std::size_t on_disk_ = 0;
};

void report_lost_camera(const OpenSession& open, const OpenedBench& bench) {
  const SourceInfo& info = bench.camera->info();
  const auto patience_s = std::chrono::duration<double>(bench.patience).count();
  if (patience_s > 0) {
    note(open.folder, open.listener,
         "camera lost, waiting " + number_text(patience_s) + " s for " + info.model + " with serial number " +
             info.serial);
  }
  if (open.listener.on_lost) open.listener.on_lost(info, bench.patience);
}

/// Events that only the log and the listener need.
void report_to(const OpenSession& open, const OpenedBench& bench, MeasurementListener& events) {
  events.on_progress = open.listener.on_progress;
  events.on_note = [&open](const std::string& sentence) { note(open.folder, open.listener, sentence); };
  events.on_rejected = [&open](const RejectedFrame& frame) {
    (void)open.folder.log("frame " + std::to_string(frame.sequence) +
                          " not used: " + std::string(to_string(frame.reason)) +
                          (frame.seen ? " (" + std::string(to_string(*frame.seen)) + ")" : ""));
  };
  events.on_lost = [&open, &bench](const Error&) { report_lost_camera(open, bench); };
}

}  // namespace

Result<MeasurementResult> record_trials(const OpenSession& open, OpenedBench& bench, Observer& observer,
                                        TrialSchedule& schedule, const MeasurementOptions& options, SessionCurve which,
                                        AnswerKind kept, std::stop_token stop) {
  std::stop_source halt;
  const std::stop_callback forward(std::move(stop), [&halt] { halt.request_stop(); });
  TODBENCH_TRY(auto trials, open.folder.open_trials(which));
  TODBENCH_TRY(auto targets, open.folder.open_targets(which));
  TrialFiles files(std::move(trials), std::move(targets), halt);
  MeasurementListener events;
  report_to(open, bench, events);
  // A simulated exposure has no host time: its files do not depend on when it is made.
  events.on_trial = [&](Trial trial) {
    if (bench.simulated) trial.host_time_ns = trial.device_time_ns;
    files.append(kept == AnswerKind::binary ? binary(std::move(trial)) : trial);
  };
  events.on_presentation = [&](Presentation shown) {
    if (bench.simulated) shown.host_time_ns.reset();
    files.append(shown);
  };
  events.on_patch = [&](const Trial& trial, const Patch& patch) {
    if (open.listener.on_trial && !files.error()) open.listener.on_trial(which, trial, patch);
  };
  std::vector<std::string> scale_notes;
  events.on_set_up = [&](const SetUpRecord& set_up) {
    auto sentence = scale_sentence(set_up, options.distance_m);
    if (!sentence.empty() && which == SessionCurve::main) {
      note(open.folder, open.listener, sentence);
      scale_notes.push_back(std::move(sentence));
    }
    if (open.listener.on_set_up) open.listener.on_set_up(which, set_up);
  };
  auto result =
      measure(*bench.camera, *bench.target, observer, schedule, options, *bench.host, events, halt.get_token());
  if (result && kept == AnswerKind::binary) {
    for (Trial& trial : result->trials) trial = binary(std::move(trial));
  }
  if (result && bench.simulated) {
    for (Presentation& shown : result->presentations) shown.host_time_ns.reset();
  }
  if (result) result->notes.insert(result->notes.end(), scale_notes.begin(), scale_notes.end());
  files.sync();
  if (files.error()) {
    if (!result || files.on_disk() == 0) return tl::unexpected(*files.error());
    result->trials.resize(std::min(files.on_disk(), result->trials.size()));
    result->ended_by = files.error();
  }
  return result;
}

ModuleLine module_log(SessionFolder& folder) {
  constexpr int most_lines = 1000;
  return [&folder, lines = std::make_shared<int>(0)](std::string_view line) {
    if (++*lines <= most_lines) (void)folder.log("module: " + one_line(std::string(line)));
  };
}

void put_behind(OpenedBench& bench, const std::vector<ModulePlan>& modules, const AddedStages& added,
                const ModuleLine& log_line, MeasurementOptions& options) {
  auto stages = module_stages(modules, log_line);
  if (added.make) std::ranges::move(added.make(log_line), std::back_inserter(stages));
  options.judged_samples_per_pixel = samples_per_pixel(stages);
  put_stages_behind(bench, std::move(stages));
}

}  // namespace todbench
