// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/person_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "bench/report/tod_figures.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/json_fields.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr int icon_width = 96, icon_height = 64;
constexpr int contrasts_of_bars = 6;
constexpr double first_over_ideal = 2, step_of_contrasts = 1.6, step_of_resolved = 2;
constexpr int bars_for_an_empty_frame = 3;
/// Share of yes answers to empty frames above which yes answers mean little.
constexpr double most_false_alarms = 0.25;
constexpr std::size_t phases_of_bars = 16;
constexpr int gap_samples = 4;
constexpr int resamples_of_answers = 1000;

/// Grey level of a part of a target. One as warm as the background is still part of the shape.
double grey_of_part(double above_background_k, double most_k) {
  const double relative = above_background_k / most_k;
  return 0.5 + 0.35 * relative + (relative < 0 ? -0.15 : 0.15);
}

/// Draws the target of a picture as large as fits.
void draw_picture(cv::Mat1d& icon, const FieldScene& scene) {
  const ScenePicture& picture = *scene.picture;
  const cv::Mat1d above_k = picture.kelvin - scene.background_k;
  const double most_k = cv::norm(above_k, cv::NORM_INF, picture.target);
  const double scale =
      0.9 * std::min(static_cast<double>(icon.cols) / above_k.cols, static_cast<double>(icon.rows) / above_k.rows);
  for (int y = 0; y < icon.rows; ++y) {
    for (int x = 0; x < icon.cols; ++x) {
      const int column = cvFloor((x + 0.5 - icon.cols / 2.0) / scale + above_k.cols / 2.0);
      const int row = cvFloor((y + 0.5 - icon.rows / 2.0) / scale + above_k.rows / 2.0);
      const bool inside = column >= 0 && row >= 0 && column < above_k.cols && row < above_k.rows;
      if (inside && picture.target(row, column) != 0) icon(y, x) = grey_of_part(above_k(row, column), most_k);
    }
  }
}

/// Draws the target of polygons as large as fits.
void draw_regions(cv::Mat1d& icon, const FieldScene& scene) {
  cv::Rect2d box;
  double most_k = 0;
  for (const SceneRegion& region : scene.regions) {
    if (!region.target) continue;
    for (const cv::Point2d& corner : region.outline_m) {
      const cv::Rect2d point(corner.x, corner.y, 1e-9, 1e-9);
      box = box.area() > 0 ? box | point : point;
    }
    most_k = std::max(most_k, std::abs(region.temperature_k - scene.background_k));
  }
  if (!(most_k > 0)) return;
  const double scale = 0.9 * std::min(icon.cols / box.width, icon.rows / box.height);
  const cv::Point2d middle(box.x + box.width / 2, box.y + box.height / 2);
  for (const SceneRegion& region : scene.regions) {
    if (!region.target) continue;
    std::vector<cv::Point> outline;
    for (const cv::Point2d& corner : region.outline_m)
      outline.emplace_back(cvRound((corner.x - middle.x) * scale + icon.cols / 2.0),
                           cvRound((corner.y - middle.y) * scale + icon.rows / 2.0));
    cv::fillPoly(icon, std::vector{outline}, grey_of_part(region.temperature_k - scene.background_k, most_k));
  }
}

/// Draws the target alone, hot white and cold black.
cv::Mat1d icon_of(const FieldScene& scene) {
  constexpr int fine = 4;
  cv::Mat1d icon(icon_height * fine, icon_width * fine, 0.5);
  if (scene.picture)
    draw_picture(icon, scene);
  else
    draw_regions(icon, scene);
  cv::Mat1d small;
  cv::resize(icon, small, {icon_width, icon_height}, 0, 0, cv::INTER_AREA);
  return small;
}

/// Draws `bars` bars in a square.
void draw_bars(cv::Mat1d& icon, int bars, int x0) {
  constexpr int width = 36;
  const double unit = static_cast<double>(width) / (2 * bars - 1);
  for (int bar = 0; bar < bars; ++bar)
    icon.colRange(x0 + cvRound(2 * bar * unit), x0 + cvRound((2 * bar + 1) * unit))
        .rowRange((icon_height - width) / 2, (icon_height + width) / 2) = 0.9;
}

/// Icon of the alternatives of a criterion; 0 bars: empty.
cv::Mat1d icon_of_two(int left, int right) {
  cv::Mat1d icon(icon_height, icon_width, 0.5);
  if (left > 0) draw_bars(icon, left, 6);
  if (right > 0) draw_bars(icon, right, icon_width - 42);
  return icon;
}

cv::Mat1d icon_of_one(int bars) {
  cv::Mat1d icon(icon_height, icon_width, 0.5);
  if (bars > 0) draw_bars(icon, bars, (icon_width - 36) / 2);
  return icon;
}

/// Half of the span covers both the contrast and the noise.
GreyScale grey_about(double contrast_k, double noise_k) {
  const double half = std::max(1.5 * contrast_k, 3 * noise_k);
  return {-half, half};
}

double deviation_of(const cv::Mat1f& picture) {
  cv::Scalar mean, sd;
  cv::meanStdDev(picture, mean, sd);
  return sd[0];
}

}  // namespace

std::string_view to_string(PersonTask task) {
  return task == PersonTask::identify ? "identify" : "mrtd";
}

void PersonExperiment::shuffle(std::uint64_t seed) {
  const RandomStream order(seed, "person.order");
  for (std::size_t i = trials_.size(); i > 1; --i) std::swap(trials_[i - 1], trials_[order.below(i, i)]);
}

Result<PersonExperiment> PersonExperiment::of_set(const IdentificationStudyTask& task, int per_target) {
  TODBENCH_TRY(const auto experiment, experiment_of(task));
  TODBENCH_TRY(auto frames, IdentificationFrames::of(experiment));
  PersonExperiment out;
  out.task_ = PersonTask::identify;
  const std::size_t aspects = experiment.targets.front().aspects.size(), targets = experiment.targets.size();
  // People know models from their broadest aspect, the one nearest to 90 degrees, and others from their first picture.
  std::size_t known = 0;
  for (std::size_t a = 1; a < task.set.azimuths_deg.size(); ++a) {
    if (std::abs(task.set.azimuths_deg[a] - 90) < std::abs(task.set.azimuths_deg[known] - 90)) known = a;
  }
  for (const auto& target : experiment.targets) {
    out.alternatives_.push_back(target.name);
    out.icons_.push_back(icon_of(target.aspects[known]));
  }
  const RandomStream choice(task.seed, "person.identify");
  std::uint64_t number = 0;
  for (std::size_t r = 0; r < task.ranges_m.size(); ++r) {
    double mean_k = 0;
    for (std::size_t t = 0; t < targets; ++t) {
      for (std::size_t a = 0; a < aspects; ++a)
        mean_k += frames.contrast_k(r, t, a) / static_cast<double>(targets * aspects);
      for (int k = 0; k < per_target; ++k, ++number) {
        out.trials_.push_back({.condition = r,
                               .truth = t,
                               .aspect = choice.below(aspects, 2 * number),
                               .draw = choice.below(1U << 20U, 2 * number + 1)});
      }
    }
    out.conditions_.push_back({.range_m = task.ranges_m[r],
                               .transmittance = experiment.ranges[r].transmittance,
                               .contrast_k = mean_k,
                               .place = r});
    out.grey_.push_back(grey_about(mean_k, task.sensor.netd_k));
  }
  out.description_ = {{"set", task.set.name},
                      {"sensor", task.sensor.name},
                      {"atmosphere", task.air.name},
                      {"azimuths_deg", task.set.azimuths_deg},
                      {"cn2_m_minus_2_3", task.cn2_m_minus_2_3},
                      {"motion_mrad_s", {task.motion.x_mrad_s, task.motion.y_mrad_s}},
                      {"seed", task.seed}};
  out.frames_ = std::move(frames);
  out.shuffle(task.seed);
  return out;
}

void PersonExperiment::describe_bars() {
  switch (criterion_) {
    case BarCriterion::four_or_five:
      alternatives_ = {"four on the left", "four on the right"};
      icons_ = {icon_of_two(4, 5), icon_of_two(5, 4)};
      return;
    case BarCriterion::bars_resolved:
      alternatives_ = {"four bars", "not four bars"};
      icons_ = {icon_of_one(4), icon_of_one(0)};
      return;
    case BarCriterion::detection:
      alternatives_ = {"bars on the left", "bars on the right"};
      icons_ = {icon_of_two(4, 0), icon_of_two(0, 4)};
      return;
  }
}

Result<PersonExperiment> PersonExperiment::of_bars(const VirtualMrtdTask& task, int per_contrast) {
  TODBENCH_TRY(auto bars, BarFrames::of(task));
  PersonExperiment out;
  out.task_ = PersonTask::bars;
  out.criterion_ = task.criterion;
  out.describe_bars();
  const bool yes_or_no = task.criterion == BarCriterion::bars_resolved;
  const double step = yes_or_no ? step_of_resolved : step_of_contrasts;
  const int empty = yes_or_no ? (per_contrast + bars_for_an_empty_frame - 1) / bars_for_an_empty_frame : 0;
  const RandomStream choice(task.seed, "person.bars");
  std::uint64_t number = 0;
  for (std::size_t f = 0; f < task.frequencies_per_mrad.size(); ++f) {
    double contrast_k = first_over_ideal * bars.ideal_k(f);
    const double noise_k = deviation_of(bars.frame_k(f, BarPattern::uniform, 0, 0, 0));
    for (int c = 0; c < contrasts_of_bars; ++c, contrast_k *= step) {
      for (int k = 0; k < per_contrast + empty; ++k, ++number) {
        const std::size_t side = choice.below(2, 3 * number);
        out.trials_.push_back({.condition = out.conditions_.size(),
                               .truth = yes_or_no ? (k < per_contrast ? 0U : 1U) : side,
                               .phase = choice.below(phases_of_bars, 3 * number + 1),
                               .draw = 2 * choice.below(1U << 20U, 3 * number + 2)});
      }
      out.conditions_.push_back(
          {.frequency_per_mrad = task.frequencies_per_mrad[f], .contrast_k = contrast_k, .place = f});
      out.grey_.push_back(grey_about(contrast_k, noise_k));
    }
  }
  out.description_ = {{"sensor", task.sensor.name},
                      {"axis", task.axis == BarAxis::horizontal ? "horizontal" : "vertical"},
                      {"criterion", std::string(to_string(task.criterion))},
                      {"seed", task.seed}};
  out.bars_ = std::move(bars);
  out.shuffle(task.seed);
  return out;
}

Result<cv::Mat1f> PersonExperiment::picture_k(const PersonTrial& trial) const {
  const PersonCondition& condition = conditions_[trial.condition];
  if (task_ == PersonTask::identify) return frames_->frame_k(condition.place, trial.truth, trial.aspect, trial.draw);
  const auto interval = [&](bool four, std::uint64_t draw) {
    const bool five = criterion_ == BarCriterion::four_or_five;
    return bars_->frame_k(condition.place, !four && five ? BarPattern::five_bars : BarPattern::four_bars,
                          four || five ? condition.contrast_k : 0, trial.phase, draw);
  };
  if (criterion_ == BarCriterion::bars_resolved) return interval(trial.truth == 0, trial.draw);
  const cv::Mat1f left = interval(trial.truth == 0, trial.draw), right = interval(trial.truth == 1, trial.draw + 1);
  const cv::Mat1f gap = cv::Mat1f::zeros(left.rows, gap_samples);
  cv::Mat1f both;
  cv::hconcat(std::vector<cv::Mat>{left, gap, right}, both);
  return both;
}

namespace {

bool yes_or_no(const PersonExperiment& experiment) {
  return experiment.task() == PersonTask::bars && experiment.criterion() == BarCriterion::bars_resolved;
}

/// Answered trials, right or wrong, by condition; without empty frames.
std::vector<std::vector<bool>> right_by_condition(const PersonExperiment& experiment,
                                                  const std::vector<ExperimentAnswer>& answers) {
  std::vector<std::vector<bool>> right(experiment.conditions().size());
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const PersonTrial& trial = experiment.trials()[i];
    if (yes_or_no(experiment) && trial.truth != 0) continue;
    right[trial.condition].push_back(answers[i].answer == trial.truth);
  }
  return right;
}

PersonShare share_of(int right, int shown) {
  return {.shown = shown,
          .right = right,
          .ci95 = shown == 0 ? Interval{} : wilson_interval(static_cast<double>(right), static_cast<double>(shown))};
}

/// False alarms by frequency.
std::vector<PersonShare> false_alarms_of(const PersonExperiment& experiment,
                                         const std::vector<ExperimentAnswer>& answers) {
  std::vector<std::pair<int, int>> counts(experiment.conditions().size() / contrasts_of_bars);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const PersonTrial& trial = experiment.trials()[i];
    if (trial.truth == 0) continue;
    auto& [seen, shown] = counts[experiment.conditions()[trial.condition].place];
    ++shown;
    if (answers[i].answer == 0) ++seen;
  }
  std::vector<PersonShare> out;
  out.reserve(counts.size());
  for (const auto& [seen, shown] : counts) out.push_back(share_of(seen, shown));
  return out;
}

/// Crossing of 75 % by the shares of some conditions, the easiest first; `at` increases.
SetCriterion passing_of(const std::vector<double>& at, const std::vector<std::vector<bool>>& right,
                        std::uint64_t seed) {
  std::vector<double> shares;
  for (const auto& answers : right) {
    if (answers.empty()) return {};
    shares.push_back(static_cast<double>(std::count(answers.begin(), answers.end(), true)) /
                     static_cast<double>(answers.size()));
  }
  std::vector<Crossing75> resampled;
  const RandomStream numbers(seed, "person.resample");
  for (std::uint64_t r = 0; r < resamples_of_answers; ++r) {
    std::vector<double> drawn;
    std::uint64_t index = 0;
    for (const auto& answers : right) {
      double sum = 0;
      for (std::size_t i = 0; i < answers.size(); ++i)
        sum += answers[numbers.sub(r).below(answers.size(), index++)] ? 1 : 0;
      drawn.push_back(sum / static_cast<double>(answers.size()));
    }
    resampled.push_back(crossing_of_75_percent(at, drawn));
  }
  return with_interval(crossing_of_75_percent(at, shares), resampled);
}

std::optional<double> inverse(const std::optional<double>& value) {
  return value ? std::optional(1 / *value) : std::nullopt;
}

Json share_json(const PersonShare& share) {
  return {{"shown", share.shown},
          {"right", share.right},
          {"proportion_correct", share.shown > 0 ? Json(static_cast<double>(share.right) / share.shown) : Json()},
          {"ci95", json_interval(share.ci95)}};
}

Json person_json(const PersonExperiment& experiment, const std::vector<ExperimentAnswer>& answers, const Json& person,
                 bool complete) {
  const PersonResult result = person_result(experiment, answers);
  Json json{{"schema", "todbench-person-1"},
            {"task", to_string(experiment.task())},
            {"observer", "human"},
            {"person", person},
            {"complete", complete},
            {"answers", answers.size()},
            {"planned", experiment.trials().size()},
            {"alternatives", experiment.alternatives()}};
  json.update(experiment.description());
  Json rows = Json::array();
  for (std::size_t c = 0; c < experiment.conditions().size(); ++c) {
    const PersonCondition& condition = experiment.conditions()[c];
    Json row = share_json(result.conditions[c]);
    row["contrast_k"] = json_number(condition.contrast_k);
    if (experiment.task() == PersonTask::identify) {
      row["range_m"] = json_number(condition.range_m);
      row["transmittance"] = json_number(condition.transmittance);
      row["confusion"] = result.confusion[c];
    } else {
      row["frequency_per_mrad"] = json_number(condition.frequency_per_mrad);
    }
    rows.push_back(std::move(row));
  }
  if (experiment.task() == PersonTask::identify) {
    json["ranges"] = rows;
    json["chance"] = 1.0 / static_cast<double>(experiment.alternatives().size());
    json["r75_m"] = json_number(result.r75_m.value);
    json["r75_ci95_m"] = json_interval(result.r75_m.ci95);
    return json;
  }
  json["contrasts"] = rows;
  json["frequencies"] = Json::array();
  for (const PersonCondition& condition : experiment.conditions()) {
    if (condition.place < json["frequencies"].size()) continue;
    const SetCriterion& threshold = result.thresholds_k[condition.place];
    Json row{{"frequency_per_mrad", json_number(condition.frequency_per_mrad)},
             {"threshold_k", json_number(threshold.value)},
             {"threshold_ci95_k", json_interval(threshold.ci95)}};
    if (!result.false_alarms.empty()) {
      const PersonShare& seen = result.false_alarms[condition.place];
      row["false_alarms"] = {
          {"shown", seen.shown},
          {"seen", seen.right},
          {"proportion", seen.shown > 0 ? Json(static_cast<double>(seen.right) / seen.shown) : Json()},
          {"ci95", json_interval(seen.ci95)}};
    }
    json["frequencies"].push_back(std::move(row));
  }
  return json;
}

std::string answers_csv(const PersonExperiment& experiment, const std::vector<ExperimentAnswer>& answers) {
  std::string csv =
      "number,range_m,frequency_per_mrad,contrast_k,shown,answered,aspect,phase,draw,response_s,limit_ms,black_k,"
      "white_k\n";
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const PersonTrial& trial = experiment.trials()[i];
    const PersonCondition& condition = experiment.conditions()[trial.condition];
    const bool set = experiment.task() == PersonTask::identify;
    const GreyScale grey = experiment.grey(trial);
    csv +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", i + 1, set ? number_text(condition.range_m) : "",
                    set ? "" : number_text(condition.frequency_per_mrad), number_text(condition.contrast_k),
                    csv_field(experiment.alternatives()[trial.truth]),
                    csv_field(experiment.alternatives()[answers[i].answer]), trial.aspect, trial.phase, trial.draw,
                    number_text(answers[i].response_s), answers[i].limit_ms ? std::to_string(*answers[i].limit_ms) : "",
                    number_text(grey.black_k), number_text(grey.white_k));
  }
  return csv;
}

}  // namespace

PersonResult person_result(const PersonExperiment& experiment, const std::vector<ExperimentAnswer>& answers) {
  const auto right = right_by_condition(experiment, answers);
  const std::size_t alternatives = experiment.alternatives().size();
  PersonResult out;
  for (const auto& one : right) {
    const auto count = std::count(one.begin(), one.end(), true);
    out.conditions.push_back(share_of(static_cast<int>(count), static_cast<int>(one.size())));
  }
  out.confusion.assign(right.size(), std::vector(alternatives, std::vector<int>(alternatives, 0)));
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const PersonTrial& trial = experiment.trials()[i];
    ++out.confusion[trial.condition][trial.truth][answers[i].answer];
  }
  const std::uint64_t seed = experiment.description().at("seed").get<std::uint64_t>();
  std::vector<double> at;
  if (experiment.task() == PersonTask::identify) {
    for (const PersonCondition& condition : experiment.conditions()) at.push_back(condition.range_m);
    out.r75_m = passing_of(at, right, seed);
    return out;
  }
  if (yes_or_no(experiment)) out.false_alarms = false_alarms_of(experiment, answers);
  // Contrasts of a frequency from the highest: the inverse increases like a range.
  for (std::size_t first = 0; first < right.size(); first += contrasts_of_bars) {
    std::vector<std::vector<bool>> own;
    at.clear();
    for (std::size_t c = first + contrasts_of_bars; c-- > first;) {
      at.push_back(1 / experiment.conditions()[c].contrast_k);
      own.push_back(right[c]);
    }
    const std::size_t frequency = first / contrasts_of_bars;
    if (yes_or_no(experiment) &&
        out.false_alarms[frequency].right > most_false_alarms * out.false_alarms[frequency].shown) {
      out.thresholds_k.push_back({});
      continue;
    }
    const SetCriterion found = passing_of(at, own, seed);
    out.thresholds_k.push_back({inverse(found.value), {inverse(found.ci95.high), inverse(found.ci95.low)}});
  }
  return out;
}

Result<void> write_person(const std::filesystem::path& folder, const PersonExperiment& experiment,
                          const std::vector<ExperimentAnswer>& answers, const PersonFacts& person, bool complete) {
  TODBENCH_TRY(const auto facts, json_of(person, person_fields));
  if (is_there(folder)) return fail(ErrorCode::invalid_input, folder.string() + ": exists");
  TODBENCH_TRY_VOID(make_folder(folder));
  TODBENCH_TRY_VOID(write_file_atomically(folder / "answers.csv", answers_csv(experiment, answers)));
  return write_file_atomically(folder / "person.json",
                               person_json(experiment, answers, facts, complete).dump(2) + "\n");
}

}  // namespace todbench
