// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/human_record.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <string>
#include <system_error>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/plan_options.h"
#include "bench/session/fit_record.h"
#include "bench/session/manifest.h"
#include "bench/session/open_session.h"
#include "bench/session/trials_csv.h"
#include "bench/text/csv_table.h"
#include "bench/text/files.h"
#include "bench/text/json_fields.h"
#include "bench/text/json_file.h"
#include "bench/text/text.h"
#include "tod/adequacy/adequacy.h"

namespace todbench {
namespace {

constexpr const char* trials_name = "trials_human.csv";
constexpr const char* fits_name = "fits_human.json";
constexpr const char* shown_name = "shown_human.csv";
constexpr const char* shown_header =
    "answer_number,presentation,triangle,frame,truth,answer,response_s,limit_ms,magnification,black_k,white_k,rows,"
    "columns,kelvin,noise_k";
constexpr std::size_t shown_columns = 15;
/// Columns that files of earlier versions do not have.
constexpr std::size_t later_shown_columns = 1;

/// Returns the samples row by row, separated by blanks, so that they read back exactly.
std::string shown_text(const HumanRecord& record) {
  std::string text = std::string(shown_header) + "\n";
  for (std::size_t i = 0; i < record.shown.size(); ++i) {
    const Trial& trial = record.trials[i];
    const ShownPatch& patch = record.shown[i];
    text += std::to_string(i + 1) + "," + std::to_string(trial.presentation) + "," + csv_field(trial.triangle) + "," +
            std::to_string(trial.frame) + "," + std::string(to_string(trial.truth)) + "," +
            std::string(to_string(trial.answer)) + "," + number_text(patch.response_s) + "," +
            (patch.limit_ms ? std::to_string(*patch.limit_ms) : "") + "," + std::to_string(patch.magnification) + "," +
            number_text(patch.black_k) + "," + number_text(patch.white_k) + "," + std::to_string(patch.kelvin.rows) +
            "," + std::to_string(patch.kelvin.cols) + ",";
    std::string samples;
    for (const float kelvin : patch.kelvin) samples += (samples.empty() ? "" : " ") + number_text(kelvin);
    text += samples + "," + (patch.noise_k ? number_text(*patch.noise_k) : "") + "\n";
  }
  return text;
}

/// Parses the samples of a patch; empty if the text is not `rows` times `columns` numbers.
cv::Mat1f samples_from(const std::string& text, int rows, int columns) {
  cv::Mat1f kelvin(rows, columns);
  std::size_t begin = 0;
  for (float& sample : kelvin) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const auto value = begin < text.size() ? parse_number(text.substr(begin, end - begin)) : std::nullopt;
    if (!value) return {};
    sample = static_cast<float>(*value);
    begin = end + 1;
  }
  return begin > text.size() ? kelvin : cv::Mat1f();
}

Result<std::vector<ShownPatch>> read_shown(const std::filesystem::path& file, std::size_t trials) {
  TODBENCH_TRY(const auto text, read_text_file(file));
  TODBENCH_TRY(const auto table, parse_csv(text, file.string()));
  const bool has_noise = table.header.size() == shown_columns;
  if (!has_noise && table.header.size() + later_shown_columns != shown_columns)
    return table.wrong(1, "expected the columns " + std::string(shown_header));
  if (table.rows.size() != trials) return table.wrong(1, "expected one row for each trial of trials_human.csv");
  std::vector<ShownPatch> out;
  for (const auto& row : table.rows) {
    const auto number = [&](std::size_t column) { return parse_number(row.fields[column]); };
    constexpr double most = 4096;  // samples on a side
    const auto rows = number(11), columns = number(12), magnification = number(8);
    if (!rows || !columns || !(*rows >= 1 && *rows <= most && *columns >= 1 && *columns <= most) || !number(6) ||
        !magnification || !number(9) || !number(10) || (!row.fields[7].empty() && !number(7)) ||
        (has_noise && !row.fields[14].empty() && !(number(14).value_or(-1) >= 0)))
      return table.wrong(row.line, "a number is missing or out of range");
    ShownPatch patch{.kelvin = samples_from(row.fields[13], static_cast<int>(*rows), static_cast<int>(*columns)),
                     .black_k = *number(9),
                     .white_k = *number(10),
                     .magnification = static_cast<int>(*magnification),
                     .limit_ms = {},
                     .response_s = *number(6),
                     .noise_k = has_noise ? number(14) : std::nullopt};
    if (const auto limit = number(7)) patch.limit_ms = static_cast<int>(*limit);
    if (patch.kelvin.empty()) return table.wrong(row.line, "column kelvin: expected rows x columns numbers");
    out.push_back(std::move(patch));
  }
  return out;
}

constexpr const char* people_folder = "people";
constexpr const char* facts_name = "people/people.json";

/// Files of the N-th person, from 1. The first one has the names of versions that knew one person.
struct PersonFiles {
  std::string trials, shown, fits;
};
PersonFiles files_of(std::size_t number) {
  if (number == 1) return {trials_name, shown_name, fits_name};
  const std::string stem = std::string(people_folder) + "/" + std::to_string(number) + "-";
  return {stem + "trials.csv", stem + "shown.csv", stem + "fits.json"};
}

Result<HumanRecord> read_record_of(const std::filesystem::path& session, const PersonFiles& files) {
  TODBENCH_TRY(auto trials, read_trials(session / files.trials));
  TODBENCH_TRY(const Json json, read_json_file(session / files.fits));
  TODBENCH_TRY(auto curve, curve_from(json));
  std::vector<ShownPatch> shown;
  std::error_code none;
  if (std::filesystem::exists(session / files.shown, none)) {
    TODBENCH_TRY(shown, read_shown(session / files.shown, trials.size()));
  }
  return HumanRecord{std::move(trials), std::move(curve), std::move(shown)};
}

/// people.json.
struct People {
  std::vector<PersonFacts> people;
};
void people_fields(JsonFields& json, People& people) {
  json.value("people", people.people, person_fields);
}

/// Returns the facts of all people; one without facts for answers of a version that knew one person.
Result<People> read_facts(const std::filesystem::path& session) {
  std::error_code none;
  if (!std::filesystem::exists(session / facts_name, none)) {
    People one;
    if (std::filesystem::exists(session / trials_name, none)) one.people.emplace_back();
    return one;
  }
  return read_record_file<People>(session / facts_name, people_fields);
}

}  // namespace

void person_fields(JsonFields& json, PersonFacts& person) {
  json.value("code", person.code);
  json.value("age_years", person.age_years);
  json.value("acuity_decimal", person.acuity_decimal);
  json.value("distance_m", person.distance_m);
  json.value("luminance_cd_m2", person.luminance_cd_m2);
  json.value("screen", person.screen);
  json.value("judged_utc", person.judged_utc);
  json.value("training_answers", person.training_answers);
}

Result<HumanRecord> human_record(std::vector<Trial> answers, std::vector<ShownPatch> shown, const Plan& plan) {
  assert(shown.size() == answers.size());
  TODBENCH_TRY(auto curve, tod_curve(answers, fit_options(plan)));
  curve.observer = "human";
  for (TodPoint& point : curve.points) {
    point.estimator_reason = EstimatorReason::person;
    point.answers = AnswersTaken{AnswerKind::binary, 1, AnswersReason::person};
  }
  examine(curve, fit_options(plan));
  return HumanRecord{std::move(answers), std::move(curve), std::move(shown)};
}

Result<void> add_person(const std::filesystem::path& session, const PersonRecord& person) {
  TODBENCH_TRY_VOID(require_intact(session));
  TODBENCH_TRY(People people, read_facts(session));
  people.people.push_back(person.person);
  const PersonFiles files = files_of(people.people.size());
  std::error_code problem;
  std::filesystem::create_directories(session / people_folder, problem);
  if (problem) return fail(ErrorCode::io, (session / people_folder).string() + ": " + problem.message());
  const HumanRecord& record = person.record;
  TODBENCH_TRY(auto writer, TrialsWriter::create(session / files.trials));
  for (const Trial& trial : record.trials) {
    TODBENCH_TRY_VOID(writer.append(trial));
  }
  TODBENCH_TRY_VOID(writer.sync());
  TODBENCH_TRY_VOID(write_json_file(session / files.fits, curve_record(record.curve)));
  TODBENCH_TRY_VOID(write_file_atomically(session / files.shown, shown_text(record)));
  TODBENCH_TRY(const Json facts, json_of(people, people_fields));
  TODBENCH_TRY_VOID(write_json_file(session / facts_name, facts));
  return refresh_manifest(session, {files.trials, files.shown, files.fits, facts_name});
}

Result<std::optional<HumanRecord>> read_human(const std::filesystem::path& session) {
  std::error_code none;
  if (!std::filesystem::exists(session / trials_name, none)) return std::nullopt;
  TODBENCH_TRY(auto record, read_record_of(session, files_of(1)));
  return record;
}

Result<std::vector<PersonRecord>> read_people(const std::filesystem::path& session) {
  TODBENCH_TRY(const People people, read_facts(session));
  std::vector<PersonRecord> out;
  for (std::size_t i = 0; i < people.people.size(); ++i) {
    TODBENCH_TRY(auto record, read_record_of(session, files_of(i + 1)));
    out.push_back({people.people[i], std::move(record)});
  }
  return out;
}

std::string shown_file_of_person(std::size_t number) {
  return files_of(number).shown;
}

MeanOverPeople mean_over_people(const std::vector<std::string>& codes, const std::vector<double>& thresholds) {
  // ln threshold of the sittings by person; a person without a code has a key of their own.
  std::map<std::string, std::vector<double>> persons;
  for (std::size_t i = 0; i < codes.size(); ++i)
    persons[codes[i].empty() ? "\n" + std::to_string(i) : codes[i]].push_back(std::log(thresholds[i]));
  std::vector<double> logs;
  for (const auto& [key, sittings] : persons)
    logs.push_back(std::accumulate(sittings.begin(), sittings.end(), 0.0) / static_cast<double>(sittings.size()));
  if (logs.empty()) return {};
  const auto n = static_cast<double>(logs.size());
  const double mean = std::accumulate(logs.begin(), logs.end(), 0.0) / n;
  MeanOverPeople out{.people = static_cast<int>(logs.size()), .mean = std::exp(mean)};
  if (logs.size() > 1) {
    double squares = 0;
    for (const double value : logs) squares += (value - mean) * (value - mean);
    const double half = distribution::quantile_above(0.025, n - 1) * std::sqrt(squares / (n - 1) / n);
    out.ci95 = std::pair(std::exp(mean - half), std::exp(mean + half));
  }
  return out;
}

std::vector<PeopleMean> mean_over_people(const std::vector<PersonRecord>& people) {
  // Codes and thresholds of the sittings with a threshold, by contrast.
  std::map<double, std::pair<std::vector<std::string>, std::vector<double>>, std::greater<>> found;
  for (const PersonRecord& one : people) {
    for (const TodPoint& point : one.record.curve.points) {
      if (!threshold_identified(point.fit)) continue;
      auto& [codes, thresholds] = found[point.set_delta_t_k];
      codes.push_back(one.person.code);
      thresholds.push_back(*point.fit.threshold);
    }
  }
  std::vector<PeopleMean> means;
  for (const auto& [contrast, sittings] : found) {
    const MeanOverPeople of = mean_over_people(sittings.first, sittings.second);
    means.push_back({.set_delta_t_k = contrast, .people = of.people, .s75_mrad = of.mean, .ci95_mrad = of.ci95});
  }
  return means;
}

}  // namespace todbench
