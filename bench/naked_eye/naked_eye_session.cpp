// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/naked_eye/naked_eye_session.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/session/manifest.h"
#include "bench/session/open_session.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/json_fields.h"
#include "bench/text/json_file.h"
#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

/// The content of naked_eye.json.
struct NakedEyeRecord {
  std::string observer;
  ViewedDisplay display;  ///< linear_display()
  std::vector<double> contrasts;
  double noise = 0;
  int per_size = 0;
  std::uint64_t seed = 1;
  NakedEyePrediction prediction;
};

void linear_display_fields(JsonFields& json, ViewedDisplay& display) {
  json.value("pixel_pitch_mm", display.pixel_pitch_mm);
  json.value("viewing_distance_m", display.viewing_distance_m);
  json.value("luminance_white_cd_m2", display.luminance_white_cd_m2);
  json.value("luminance_black_cd_m2", display.luminance_black_cd_m2);
  json.value("gamma", display.gamma);
  json.value("veil_cd_m2", display.veil_cd_m2);
  json.value("zoom", display.zoom);
  json.value("spot_mm", display.spot_mm);
  json.value("span_k", display.span_k);
}

void record_fields(JsonFields& json, NakedEyeRecord& record) {
  json.constant("schema", "todbench-naked-eye-1");
  json.value("observer", record.observer);
  json.value("display", record.display, linear_display_fields);
  json.value("contrast", record.contrasts);
  json.value("noise_contrast", record.noise);
  json.value("per_size", record.per_size);
  json.value("seed", record.seed);
  json.value("prediction", record.prediction, prediction_fields);
}

Result<NakedEyeRecord> read_record(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / naked_eye_name;
  TODBENCH_TRY(NakedEyeRecord record, read_record_file<NakedEyeRecord>(file, record_fields));
  if (auto possible = validate(record.display); !possible) return fail(file.string(), possible.error());
  return record;
}

/// The same display with its pixel pitch as a number.
ViewedDisplay recorded_display(const ViewedDisplay& display) {
  ViewedDisplay out = linear_display(display);
  out.pixel_pitch_mm = pixel_pitch_mm(display);
  out.diagonal_in = 0;
  out.pixels.clear();
  return out;
}

bool same_size(double a_mrad, double b_mrad) {
  return std::abs(a_mrad - b_mrad) < 1e-6 * b_mrad;
}

}  // namespace

Result<NakedEyeSession> NakedEyeSession::begin(const NakedEyeTask& task, const std::filesystem::path& folder,
                                               int pictures, const std::stop_token& stop) {
  if (is_there(folder)) return fail(ErrorCode::invalid_input, folder.string() + ": exists");
  TODBENCH_TRY(auto prediction, predict_naked_eye(task, pictures, stop));
  NakedEyeSession out;
  out.task_ = task;
  out.prediction_ = std::move(prediction);
  out.folder_ = folder;
  out.windows_ = std::make_shared<TemplateObserver>(model_at_linear_display(task), triangle_alternatives());
  TODBENCH_TRY_VOID(make_folder(folder));
  const NakedEyeRecord record{.observer = task.model.name,
                              .display = recorded_display(*task.model.display),
                              .contrasts = task.contrasts,
                              .noise = task.noise,
                              .per_size = task.per_size,
                              .seed = task.seed,
                              .prediction = out.prediction_};
  TODBENCH_TRY_VOID(write_json_file(folder / naked_eye_name, json_of(record, record_fields)));
  TODBENCH_TRY_VOID(write_manifest(folder));
  out.trials_ = naked_eye_trials(task, out.prediction_.sizes_samples());
  out.draw_next();
  return out;
}

void NakedEyeSession::draw_next() {
  if (complete()) return;
  // The prediction has prepared the observer for every size.
  const auto prepared = windows_->prepare(trial().size_samples, 1);
  picture_ = naked_eye_picture(task_, trial(), (*prepared)->window_samples());
}

void NakedEyeSession::answer(Apex answer, double response_s, std::optional<int> limit_ms) {
  const NakedEyeTrial& asked = trial();
  const double mrad = mrad_per_sample(*task_.model.display);
  const double distance_m = task_.model.display->viewing_distance_m;
  answers_.push_back({.presentation = static_cast<std::int64_t>(answers_.size()),
                      .plate = "naked-eye",
                      .triangle = "triangle",
                      .set_delta_t_k = asked.contrast,
                      .delta_t_k = asked.contrast,
                      .size_mm = asked.size_samples * mrad * distance_m,
                      .size_mrad = asked.size_samples * mrad,
                      .size_px = asked.size_samples,
                      .truth = asked.truth,
                      .answer = answer,
                      .phase_x_px = asked.centroid.x,
                      .phase_y_px = asked.centroid.y,
                      .frame = asked.number});
  const auto zoom = static_cast<int>(task_.model.display->zoom);
  shown_.push_back({.kelvin = picture_.contrast,
                    .black_k = -largest_contrast(*task_.model.display),
                    .white_k = largest_contrast(*task_.model.display),
                    .magnification = zoom,
                    .limit_ms = limit_ms,
                    .response_s = response_s,
                    .noise_k = picture_.noise});
  draw_next();
}

Result<void> NakedEyeSession::finish(const PersonFacts& person) {
  TODBENCH_TRY(record_, human_record(answers_, shown_, Plan{}));
  if (auto written = add_person(folder_, {.person = person, .record = *record_}); !written) return written;
  comparison_ = naked_eye_comparison(prediction_, *record_);
  comparison_["complete"] = complete();
  TODBENCH_TRY(const auto sum, sha256_of_file(folder_ / naked_eye_name));
  comparison_["prediction_sha256"] = sum;
  TODBENCH_TRY_VOID(write_json_file(folder_ / naked_eye_comparison_name, comparison_));
  return refresh_manifest(folder_, {std::string(naked_eye_comparison_name)});
}

Json naked_eye_comparison(const NakedEyePrediction& prediction, const HumanRecord& record) {
  Json contrasts = Json::array();
  double chi2 = 0;
  int cells = 0;
  for (const NakedEyeContrast& predicted : prediction.contrasts) {
    Json sizes = Json::array();
    for (const NakedEyeShare& size : predicted.sizes) {
      double shown = 0, right = 0;
      for (const Trial& trial : record.trials) {
        if (trial.set_delta_t_k != predicted.contrast || !same_size(trial.size_mrad, size.size_mrad)) continue;
        ++shown;
        right += trial.correct() ? 1 : 0;
      }
      sizes.push_back({{"size_mrad", size.size_mrad},
                       {"shown", shown},
                       {"right", right},
                       {"predicted_proportion_correct", size.share}});
      const double variance = shown * size.share * (1 - size.share);
      // A cell in which the model expects fewer than one wrong answer has no normal law.
      if (variance < 0.75) continue;
      chi2 += (right - shown * size.share) * (right - shown * size.share) / variance;
      ++cells;
    }
    Json row{{"contrast", predicted.contrast},
             {"predicted_s75_mrad", predicted.s75_mrad},
             {"predicted_spread_mrad", json_interval({predicted.spread_low_mrad, predicted.spread_high_mrad})},
             {"s75_mrad", nullptr},
             {"s75_ci95_mrad", nullptr},
             {"inside_spread", nullptr},
             {"sizes", sizes}};
    const auto point = std::find_if(record.curve.points.begin(), record.curve.points.end(),
                                    [&](const TodPoint& one) { return one.set_delta_t_k == predicted.contrast; });
    if (point != record.curve.points.end() && point->fit.threshold) {
      row["s75_ci95_mrad"] = json_interval(point->fit.ci95);
      if (const auto found = stated_threshold(point->fit)) {
        row["s75_mrad"] = *found;
        row["inside_spread"] = *found >= predicted.spread_low_mrad.value_or(0) &&
                               (!predicted.spread_high_mrad || *found <= *predicted.spread_high_mrad);
      }
    }
    contrasts.push_back(std::move(row));
  }
  Json out{{"schema", "todbench-naked-eye-comparison-1"}, {"answers", record.trials.size()}, {"contrasts", contrasts}};
  out["model"] = {{"chi2", chi2}, {"degrees_of_freedom", cells}, {"p", nullptr}};
  if (cells > 0) out["model"]["p"] = cdf(complement(boost::math::chi_squared(cells), chi2));
  return out;
}

bool is_naked_eye_session(const std::filesystem::path& folder) {
  return is_there(folder / naked_eye_name);
}

Result<AnsweredSession> answered_naked_eye(const std::filesystem::path& folder) {
  TODBENCH_TRY_VOID(require_intact(folder));
  TODBENCH_TRY(const auto record, read_record(folder));
  TODBENCH_TRY(auto human, read_human(folder));
  if (!human || human->trials.empty() || human->shown.empty())
    return fail(ErrorCode::invalid_input, folder.string() + ": this session has no answers of a person");
  TODBENCH_TRY(const auto manifest, manifest_digest(folder));
  TODBENCH_TRY(auto shown, sha256_of_file(folder / "shown_human.csv"));
  const auto whole = std::filesystem::absolute(folder).lexically_normal();
  return AnsweredSession{.folder = (whole.has_filename() ? whole : whole.parent_path()).filename().string(),
                         .manifest_sha256 = manifest,
                         .shown_sha256 = std::move(shown),
                         .samples_per_pitch = 1,
                         .noise_k = record.noise,
                         .display = record.display,
                         .human = *std::move(human)};
}

}  // namespace todbench
