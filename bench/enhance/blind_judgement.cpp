// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/enhance/blind_judgement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/devices/processed_source.h"
#include "bench/enhance/decidable.h"
#include "bench/enhance/judge_again.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/plan_options.h"
#include "bench/session/fit_record.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/json_fields.h"
#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

/// Collects the judged patches of a run, beside what the listener of the caller does.
ExperimentListener collecting(const ExperimentListener& listener, std::vector<JudgedTrial>& into) {
  ExperimentListener out = listener;
  out.on_trial = [&into, &listener](SessionCurve curve, const Trial& trial, const Patch& patch) {
    cv::Mat1f kelvin;
    patch.kelvin.convertTo(kelvin, CV_32F);
    into.push_back({curve, trial, std::move(kelvin), patch.noise_k});
    if (listener.on_trial) listener.on_trial(curve, trial, patch);
  };
  return out;
}

std::vector<JudgedTrial> of_curve(const std::vector<JudgedTrial>& trials, SessionCurve curve) {
  std::vector<JudgedTrial> out;
  std::copy_if(trials.begin(), trials.end(), std::back_inserter(out),
               [curve](const JudgedTrial& trial) { return trial.curve == curve; });
  return out;
}

Result<std::vector<JudgedTrial>> judged_patches(const std::filesystem::path& session, const JudgeRequest& request,
                                                const std::filesystem::path& folder, const ExperimentListener& listener,
                                                std::stop_token stop) {
  std::vector<JudgedTrial> trials;
  TODBENCH_TRY(const auto run, judge_again(session, request, {.folder = folder, .existing = ExistingFolder::refuse},
                                           collecting(listener, trials), std::move(stop)));
  if (run.ended_by) return tl::unexpected(*run.ended_by);
  return trials;
}

/// Place of a triangle that all sources show: contrast, plate, name of the triangle.
using TriangleKey = std::tuple<double, std::string, std::string>;
TriangleKey key_of(const Trial& trial) {
  return {trial.set_delta_t_k, trial.plate, trial.triangle};
}

/// Side of the smallest field of each triangle, in pixels of the camera.
std::map<TriangleKey, int> common_fields(const std::vector<BlindSource>& sources) {
  std::map<TriangleKey, int> fields;
  for (const BlindSource& source : sources) {
    for (const JudgedTrial& judged : source.trials) {
      const int side = std::min(judged.patch_k.rows, judged.patch_k.cols) / source.samples_per_pixel;
      const auto [at, first] = fields.try_emplace(key_of(judged.trial), side);
      if (!first) at->second = std::min(at->second, side);
    }
  }
  return fields;
}

cv::Mat1f middle_of(const cv::Mat1f& patch, int side) {
  const int left = (patch.cols - side) / 2, top = (patch.rows - side) / 2;
  return patch(cv::Rect(left, top, side, side)).clone();
}

/// Trials whose triangle every source shows.
std::vector<JudgedTrial> shown_by_all(const BlindSource& source, const std::vector<std::set<TriangleKey>>& shown) {
  std::vector<JudgedTrial> out;
  for (const JudgedTrial& judged : source.trials) {
    const TriangleKey key = key_of(judged.trial);
    if (std::all_of(shown.begin(), shown.end(), [&](const auto& keys) { return keys.contains(key); }))
      out.push_back(judged);
  }
  return out;
}

/// Removes the ratios of the last source at contrasts at which a point may not be used.
void withhold(BlindResult& result) {
  for (ComparisonPoint& point : result.ratios.back().points) {
    if (why_withheld(result, result.records.size() - 1, point.set_delta_t_k).empty()) continue;
    point.ratio.reset();
    point.ratio_ci95 = point.ratio_ci90 = {};
    point.p_difference.reset();
    point.p_equivalence.reset();
    point.withheld = true;
    point.verdict = ComparisonVerdict::inconclusive;
  }
}

Json points_json(const TodCurve& curve) {
  Json points = Json::array();
  for (const TodPoint& point : curve.points) {
    points.push_back({{"set_delta_t_k", point.set_delta_t_k},
                      {"answers", point.fit.trials},
                      {"s75_mrad", json_number(identified_threshold(point.fit))},
                      {"s75_ci95_mrad", json_interval(point.fit.ci95)},
                      {"verdict", to_string(point.fit.verdict)},
                      {"adequacy", adequacy_json(point.adequacy)}});
  }
  return points;
}

Json ratios_json(const BlindResult& result, std::size_t source) {
  Json points = Json::array();
  for (const ComparisonPoint& point : result.ratios[source - 1].points) {
    const std::string why = why_withheld(result, source, point.set_delta_t_k);
    points.push_back({{"set_delta_t_k", point.set_delta_t_k},
                      {"acuity_ratio", json_number(point.ratio)},
                      {"acuity_ratio_ci95", json_interval(point.ratio_ci95)},
                      {"p_difference", json_number(point.p_difference)},
                      {"withheld", why.empty() ? Json() : Json(why)}});
  }
  return points;
}

std::string answers_csv(const BlindResult& result, const std::vector<BlindAnswer>& answers) {
  std::string text =
      "answer_number,source,presentation,plate,triangle,set_delta_t_k,size_mrad,truth,answer,response_s\n";
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Trial& trial = answers[i].trial;
    text += std::to_string(i + 1) + "," + csv_field(result.sources[answers[i].source]) + "," +
            std::to_string(trial.presentation) + "," + csv_field(trial.plate) + "," + csv_field(trial.triangle) + "," +
            number_text(trial.set_delta_t_k) + "," + number_text(trial.size_mrad) + "," +
            std::string(to_string(trial.truth)) + "," + std::string(to_string(trial.answer)) + "," +
            number_text(answers[i].shown.response_s) + "\n";
  }
  return text;
}

}  // namespace

Result<std::vector<BlindSource>> blind_sources(const std::filesystem::path& session,
                                               const std::vector<EnhancementPackage>& packages, bool with_twin,
                                               const std::filesystem::path& folder, const ExperimentListener& listener,
                                               std::stop_token stop) {
  const std::filesystem::path models = folder / "sources";
  TODBENCH_TRY_VOID(make_folder(models));
  TODBENCH_TRY(const auto plain, judged_patches(session, {}, models / "camera", listener, stop));
  std::vector<BlindSource> sources{{.name = "camera", .trials = of_curve(plain, SessionCurve::main)}};
  if (with_twin) sources.push_back({.name = "simulated", .trials = of_curve(plain, SessionCurve::twin)});
  for (const EnhancementPackage& package : packages) {
    const bool known = std::any_of(sources.begin(), sources.end(),
                                   [&](const BlindSource& source) { return source.name == package.name; });
    if (known) return fail(ErrorCode::invalid_input, "two sources have the name '" + one_line(package.name) + "'");
    TODBENCH_TRY(const auto judged, judged_patches(session, {.package = package},
                                                   models / std::to_string(sources.size()), listener, stop));
    sources.push_back({.name = package.name,
                       .samples_per_pixel = samples_per_pixel(made_stages(package, {})),
                       .trials = of_curve(judged, SessionCurve::main)});
  }
  return sources;
}

Result<std::vector<BlindPatch>> blind_order(const std::vector<BlindSource>& sources, int per_size, std::uint64_t seed) {
  std::vector<std::set<TriangleKey>> shown;
  for (const BlindSource& source : sources) {
    shown.emplace_back();
    for (const JudgedTrial& judged : source.trials) shown.back().insert(key_of(judged.trial));
  }
  const auto fields = common_fields(sources);
  const RandomStream stream(seed, "blind");
  std::vector<BlindPatch> patches;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const std::vector<JudgedTrial> common = shown_by_all(sources[s], shown);
    for (const std::size_t i : balanced_choice(common, per_size, stream.sub(s + 1))) {
      BlindPatch patch{.source = s, .judged = common[i], .samples_per_pixel = sources[s].samples_per_pixel};
      patch.judged.patch_k =
          middle_of(patch.judged.patch_k, fields.at(key_of(patch.judged.trial)) * patch.samples_per_pixel);
      patches.push_back(std::move(patch));
    }
  }
  if (patches.empty())
    return fail(ErrorCode::invalid_input, "there is nothing to judge: the sources have no triangle in common");
  shuffle(patches, stream.sub(0));
  return patches;
}

Result<BlindResult> blind_result(const std::vector<std::string>& sources, const std::vector<BlindAnswer>& answers,
                                 const Plan& plan) {
  BlindResult result{.sources = sources, .records = {}, .ratios = {}};
  for (std::size_t s = 0; s < sources.size(); ++s) {
    std::vector<Trial> trials;
    std::vector<ShownPatch> shown;
    for (const BlindAnswer& answer : answers) {
      if (answer.source != s) continue;
      trials.push_back(answer.trial);
      shown.push_back(answer.shown);
    }
    auto record = human_record(std::move(trials), std::move(shown), plan);
    if (!record) return fail("source " + sources[s], record.error());
    result.records.push_back(*std::move(record));
    if (s == 0) continue;
    const ComparisonOptions options{.margin_percent = plan.limits.equivalence_margin_percent.value_or(10),
                                    .fit = fit_options(plan)};
    TODBENCH_TRY(Comparison ratio, compare(result.records[s].curve, result.records[0].curve, options));
    result.ratios.push_back(std::move(ratio));
    withhold(result);
  }
  return result;
}

std::string why_withheld(const BlindResult& result, std::size_t source, double set_delta_t_k) {
  for (const std::size_t s : {std::size_t{0}, source}) {
    for (const TodPoint& point : result.records[s].curve.points) {
      if (!same_contrast(point.set_delta_t_k, set_delta_t_k)) continue;
      if (auto why = why_undecided(result.sources[s], point); !why.empty()) return why;
    }
  }
  return "";
}

int exit_code(const BlindResult& result) {
  for (std::size_t s = 0; s < result.sources.size(); ++s) {
    for (const TodPoint& point : result.records[s].curve.points) {
      if (!why_undecided(result.sources[s], point).empty()) return exit_code(VerdictKind::inconclusive);
    }
  }
  return 0;
}

Json blind_json(const BlindResult& result, const PersonFacts& person, std::uint64_t seed) {
  Json sources = Json::array(), ratios = Json::array();
  for (std::size_t s = 0; s < result.sources.size(); ++s) {
    const auto& trials = result.records[s].trials;
    sources.push_back(
        {{"name", result.sources[s]},
         {"answers", trials.size()},
         {"right", std::count_if(trials.begin(), trials.end(), [](const Trial& t) { return t.correct(); })},
         {"points", points_json(result.records[s].curve)}});
  }
  for (std::size_t r = 0; r < result.ratios.size(); ++r) {
    ratios.push_back(
        {{"source", result.sources[r + 1]}, {"to", result.sources[0]}, {"points", ratios_json(result, r + 1)}});
  }
  return {{"person", person.code},
          {"judged_utc", person.judged_utc},
          {"seed", seed},
          {"sources", sources},
          {"ratios", ratios}};
}

Result<void> write_blind(const std::filesystem::path& folder, const BlindResult& result,
                         const std::vector<BlindAnswer>& answers, const PersonFacts& person, std::uint64_t seed) {
  TODBENCH_TRY_VOID(make_folder(folder));
  TODBENCH_TRY_VOID(write_file_atomically(folder / "blind.csv", answers_csv(result, answers)));
  return write_json_file(folder / "blind.json", blind_json(result, person, seed));
}

}  // namespace todbench
