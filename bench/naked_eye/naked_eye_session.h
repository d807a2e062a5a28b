// SPDX-License-Identifier: GPL-3.0-or-later
// Folder of a naked-eye session: the prediction before the first answer, the answers with their pictures, and the
// comparison after the last answer.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/naked_eye/naked_eye_prediction.h"
#include "bench/observer_fit/people_fit.h"
#include "bench/session/human_record.h"
#include "bench/text/json.h"

namespace todbench {

inline constexpr std::string_view naked_eye_name = "naked_eye.json";
inline constexpr std::string_view naked_eye_comparison_name = "naked_eye_comparison.json";

/// Session with its pictures and answers. Used by one thread at a time.
class NakedEyeSession {
 public:
  /// Computes the prediction, and writes task and prediction into a new folder. Errors: those of predict_naked_eye();
  /// `invalid_input` if the folder exists; `io` with the path.
  [[nodiscard]] static Result<NakedEyeSession> begin(const NakedEyeTask& task, const std::filesystem::path& folder,
                                                     int pictures, const std::stop_token& stop);

  [[nodiscard]] const NakedEyeTask& task() const { return task_; }
  [[nodiscard]] const NakedEyePrediction& prediction() const { return prediction_; }
  [[nodiscard]] std::size_t planned() const { return trials_.size(); }
  [[nodiscard]] std::size_t done() const { return answers_.size(); }
  [[nodiscard]] bool complete() const { return done() == planned(); }
  /// Returns the next trial. Precondition: not complete.
  [[nodiscard]] const NakedEyeTrial& trial() const { return trials_[done()]; }
  /// Returns the picture of the next trial. Precondition: not complete.
  [[nodiscard]] const NakedEyePicture& picture() const { return picture_; }
  /// Records the answer to picture(). `response_s`: time from display to answer.
  void answer(Apex answer, double response_s, std::optional<int> limit_ms);
  /// Writes the answers, the facts about the person, and the comparison. Call this function once. Errors:
  /// `invalid_input` (no answers), `io`.
  [[nodiscard]] Result<void> finish(const PersonFacts& person);
  /// Returns the record. Precondition: finish() was called.
  [[nodiscard]] const HumanRecord& record() const { return *record_; }
  /// Returns naked_eye_comparison(). Precondition: finish() was called.
  [[nodiscard]] const Json& comparison() const { return comparison_; }

 private:
  NakedEyeSession() noexcept(false) = default;  // the constructor of Json may throw
  void draw_next();

  NakedEyeTask task_;
  NakedEyePrediction prediction_;
  std::filesystem::path folder_;
  std::shared_ptr<TemplateObserver> windows_;  ///< provides the size of the window of each target
  std::vector<NakedEyeTrial> trials_;
  NakedEyePicture picture_;
  std::vector<Trial> answers_;
  std::vector<ShownPatch> shown_;
  std::optional<HumanRecord> record_;
  Json comparison_;
};

/// Compares the answers of a person with the prediction. Returns "contrasts" (s75_mrad, s75_ci95_mrad,
/// predicted_s75_mrad, predicted_spread_mrad, inside_spread, sizes), and the chi-squared test of the model itself.
[[nodiscard]] Json naked_eye_comparison(const NakedEyePrediction& prediction, const HumanRecord& record);

/// Returns whether the folder contains a naked-eye session.
[[nodiscard]] bool is_naked_eye_session(const std::filesystem::path& folder);
/// Reads the answers for a fit. Errors: `invalid_input` (no answers, or files that differ from the manifest), `io`.
[[nodiscard]] Result<AnsweredSession> answered_naked_eye(const std::filesystem::path& folder);

}  // namespace todbench
