// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/bars_people.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "bench/session/manifest.h"
#include "bench/session/open_session.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/json_file.h"

namespace todbench {
namespace {

constexpr const char* bars_name = "people/bars.json";
constexpr std::string_view bars_schema = "todbench-bars-people-1";

struct BarsSittings {
  std::vector<BarsSitting> people;
};

void answer_fields(JsonFields& json, BarsAnswer& answer) {
  json.value("place", answer.place);
  json.value("axis", answer.axis, std::array{EdgeAxis::x, EdgeAxis::y});
  json.value("frequency_per_pitch", answer.frequency_per_pitch);
  json.value("size_px", answer.size_px);
  json.value("contrast_k", answer.contrast_k);
  json.value("set_up", answer.set_up);
  json.value("target_left", answer.target_left);
  json.value("answered_left", answer.answered_left);
  json.value("response_s", answer.response_s);
}

Json place_json(const BarsThreshold& of) {
  return {{"place", of.place},
          {"axis", to_string(of.axis)},
          {"frequency_per_pitch", json_number(of.frequency_per_pitch)},
          {"size_px", json_number(of.size_px)}};
}

Json thresholds_json(const std::vector<BarsThreshold>& thresholds) {
  Json rows = Json::array();
  for (const BarsThreshold& one : thresholds) {
    Json row = place_json(one);
    row["positive_k"] = json_number(one.found.positive_k);
    row["negative_k"] = json_number(one.found.negative_k);
    row["threshold_k"] = json_number(one.found.half_k);
    row["ci95_k"] = json_interval(one.found.ci95);
    row["lapse"] = one.found.lapse;
    row["answers"] = one.found.answers;
    row["right"] = one.found.right;
    row["reason"] = one.found.reason.empty() ? Json() : Json(one.found.reason);
    rows.push_back(std::move(row));
  }
  return rows;
}

void sitting_fields(JsonFields& json, BarsSitting& sitting) {
  person_fields(json, sitting.person);
  json.value("seed", sitting.seed);
  json.value("magnification", sitting.magnification);
  json.value("answers", sitting.answers, answer_fields);
  if (!json.reading()) json.derived("thresholds", thresholds_json(bars_thresholds(sitting)));
}

void sittings_fields(JsonFields& json, BarsSittings& all) {
  json.constant("schema", bars_schema);
  json.value("people", all.people, sitting_fields);
}

std::tuple<bool, EdgeAxis, double, double> order_of(const BarsThreshold& of) {
  return {of.size_px > 0, of.axis, of.frequency_per_pitch, of.size_px};
}

/// Thresholds of the sittings at one place.
struct ThresholdsOfPlace {
  std::vector<std::string> codes;
  std::vector<ForcedChoiceThreshold> found;
};

/// Variance of ln mean from the set-ups that all people share.
double common_variance(const ThresholdsOfPlace& place, int people) {
  std::map<int, double> means;
  for (const auto& [set_up, first] : place.found.front().half_k_without) {
    std::vector<double> without;
    for (const ForcedChoiceThreshold& one : place.found) {
      const auto at = one.half_k_without.find(set_up);
      if (at != one.half_k_without.end()) without.push_back(at->second);
    }
    if (without.size() == place.found.size()) means[set_up] = mean_over_people(place.codes, without).mean;
  }
  if (means.size() < 2) return 0;
  double own = 0;
  for (const ForcedChoiceThreshold& one : place.found)
    own += jackknife_variance_of_ln(one.half_k_without) / static_cast<double>(place.found.size());
  return std::max(0.0, (people * jackknife_variance_of_ln(means) - own) / (people - 1));
}

MeanOverPeople mean_of_place(const ThresholdsOfPlace& place) {
  std::vector<double> thresholds;
  for (const ForcedChoiceThreshold& one : place.found) thresholds.push_back(*one.half_k);
  MeanOverPeople out = mean_over_people(place.codes, thresholds);
  if (!out.ci95) return out;
  const auto set_ups = static_cast<double>(place.found.front().half_k_without.size());
  const double common =
      distribution::quantile_above(0.025, set_ups - 1) * std::sqrt(common_variance(place, out.people));
  const double half = std::hypot(std::log(out.ci95->second / out.mean), common);
  out.ci95 = std::pair(out.mean * std::exp(-half), out.mean * std::exp(half));
  return out;
}

}  // namespace

std::vector<BarsThreshold> bars_thresholds(const BarsSitting& sitting) {
  std::vector<BarsThreshold> out;
  std::vector<std::vector<ForcedChoice>> choices;
  for (const BarsAnswer& answer : sitting.answers) {
    const auto known = std::ranges::find(out, answer.place, &BarsThreshold::place);
    const auto at = static_cast<std::size_t>(known - out.begin());
    if (known == out.end()) {
      out.push_back({answer.place, answer.axis, answer.frequency_per_pitch, answer.size_px, {}});
      choices.emplace_back();
    }
    choices[at].push_back({answer.contrast_k, answer.set_up, answer.target_left == answer.answered_left});
  }
  for (std::size_t i = 0; i < out.size(); ++i) out[i].found = forced_choice_threshold(choices[i]);
  std::ranges::stable_sort(out, {}, order_of);
  return out;
}

std::vector<JudgedBars> judged_bars(const std::vector<BarsSitting>& sittings) {
  std::vector<JudgedBars> out;
  for (const BarsSitting& sitting : sittings) out.push_back({sitting.person.code, bars_thresholds(sitting)});
  return out;
}

std::vector<BarsMean> bars_means(const std::vector<JudgedBars>& sittings) {
  std::vector<BarsMean> means;
  std::vector<ThresholdsOfPlace> found;
  for (const JudgedBars& sitting : sittings) {
    for (const BarsThreshold& one : sitting.thresholds) {
      const auto known = std::ranges::find_if(means, [&](const BarsMean& mean) { return mean.of.place == one.place; });
      const auto at = static_cast<std::size_t>(known - means.begin());
      if (known == means.end()) {
        means.push_back({.of = {one.place, one.axis, one.frequency_per_pitch, one.size_px, {}}});
        found.emplace_back();
      }
      means[at].answers += one.found.answers;
      if (!one.found.half_k) {
        ++means[at].without;
        continue;
      }
      found[at].codes.push_back(sitting.person);
      found[at].found.push_back(one.found);
    }
  }
  for (std::size_t i = 0; i < means.size(); ++i) {
    if (means[i].without == 0) means[i].over = mean_of_place(found[i]);
  }
  std::ranges::stable_sort(means, {}, [](const BarsMean& mean) { return order_of(mean.of); });
  return means;
}

Result<void> add_bars_sitting(const std::filesystem::path& session, const BarsSitting& sitting) {
  TODBENCH_TRY_VOID(require_intact(session));
  BarsSittings all;
  TODBENCH_TRY(all.people, read_bars_sittings(session));
  all.people.push_back(sitting);
  TODBENCH_TRY_VOID(make_folder(session / "people"));
  TODBENCH_TRY_VOID(write_json_file(session / bars_name, json_of(all, sittings_fields)));
  return refresh_manifest(session, {bars_name});
}

Result<std::vector<BarsSitting>> read_bars_sittings(const std::filesystem::path& session) {
  if (!is_there(session / bars_name)) return std::vector<BarsSitting>{};
  TODBENCH_TRY(BarsSittings all, read_record_file<BarsSittings>(session / bars_name, sittings_fields));
  return std::move(all.people);
}

Json bars_people_json(const std::vector<BarsSitting>& sittings) {
  Json people = Json::array(), means = Json::array();
  const std::vector<JudgedBars> judged = judged_bars(sittings);
  for (std::size_t i = 0; i < sittings.size(); ++i) {
    people.push_back({{"person", judged[i].person},
                      {"judged_utc", sittings[i].person.judged_utc},
                      {"answers", sittings[i].answers.size()},
                      {"thresholds", thresholds_json(judged[i].thresholds)}});
  }
  for (const BarsMean& mean : bars_means(judged)) {
    Json row = place_json(mean.of);
    row["people"] = mean.over.people;
    row["without_threshold"] = mean.without;
    row["answers"] = mean.answers;
    row["threshold_k"] = mean.over.people > 0 ? json_number(mean.over.mean) : Json();
    row["ci95_k"] = mean.over.ci95 ? json_interval({mean.over.ci95->first, mean.over.ci95->second}) : Json();
    means.push_back(std::move(row));
  }
  return {{"people", people}, {"means", means}};
}

}  // namespace todbench
