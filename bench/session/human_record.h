// A person's answers to the frames of a session, beside those of the model observer.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/plan/plan.h"
#include "tod/presentation/trial.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// How a patch was presented: with it the picture that the person saw can be made again.
struct ShownPatch {
  cv::Mat1f kelvin;                 ///< samples, as the model observer judged them
  double black_k = 0, white_k = 0;  ///< ends of the grey scale
  int magnification = 1;            ///< screen pixels per sample, bicubic
  std::optional<int> limit_ms;      ///< shown so long at most; nothing: until answered
  double response_s = 0;            ///< from showing to answering
  std::optional<double> noise_k{};  ///< temporal noise of a sample that the model was told; older files do not have it
};

/// Answers and the curve fitted to them. The trials have the format of the model's, with the person's answer and scores
/// of 0.
struct HumanRecord {
  std::vector<Trial> trials;
  TodCurve curve;
  std::vector<ShownPatch> shown;  ///< one per trial, in order
};

/// Fits the answers as the plan fits those of the model. `invalid_input` when there are none. Precondition: as many
/// patches as answers.
[[nodiscard]] Result<HumanRecord> human_record(std::vector<Trial> answers, std::vector<ShownPatch> shown,
                                               const Plan& plan);
/// Writes trials_human.csv, shown_human.csv and fits_human.json into a finished session and lists them in its manifest,
/// in place of earlier ones. `io`; `invalid_input` for a folder without a manifest, or whose files are not those of the
/// manifest: nothing is written then.
[[nodiscard]] Result<void> write_human(const std::filesystem::path& session, const HumanRecord& record);
/// Of a session that open_session() took. Nothing when no person has answered. `invalid_input` with file and line or
/// key.
[[nodiscard]] Result<std::optional<HumanRecord>> read_human(const std::filesystem::path& session);

}  // namespace todbench
