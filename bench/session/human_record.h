// SPDX-License-Identifier: GPL-3.0-or-later
// Answers of a person to the frames of a session, stored with those of the model observer.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/plan.h"
#include "tod/presentation/trial.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Presentation of a patch; the picture that the person saw can be reproduced from it.
struct ShownPatch {
  cv::Mat1f kelvin;                 ///< samples that the model observer judged
  double black_k = 0, white_k = 0;  ///< ends of the grey scale
  int magnification = 1;            ///< screen pixels per sample; bicubic without a display in the plan
  std::optional<int> limit_ms;      ///< maximum display time; empty: until answered
  double response_s = 0;            ///< time from display to answer
  std::optional<double> noise_k{};  ///< temporal noise of a sample, as given to the model; empty in older files
};

/// Answers and the curve fitted to them. The trials have the same format as those of the model, with the person's
/// answers and scores of 0.
struct HumanRecord {
  std::vector<Trial> trials;
  TodCurve curve;
  std::vector<ShownPatch> shown;  ///< one per trial, in order
};

/// Fits the answers like those of the model. Precondition: one patch per answer. Errors: `invalid_input` (no answers).
[[nodiscard]] Result<HumanRecord> human_record(std::vector<Trial> answers, std::vector<ShownPatch> shown,
                                               const Plan& plan);
/// Writes trials_human.csv, shown_human.csv and fits_human.json into a finished session, replaces earlier ones and
/// lists them in the manifest. Errors: `io`; `invalid_input` (no manifest, or files that differ from it), in which case
/// no file is written.
[[nodiscard]] Result<void> write_human(const std::filesystem::path& session, const HumanRecord& record);
/// Reads the record from a session that open_session() accepted; empty if no person has answered. Errors:
/// `invalid_input` with file and line or key.
[[nodiscard]] Result<std::optional<HumanRecord>> read_human(const std::filesystem::path& session);

}  // namespace todbench
