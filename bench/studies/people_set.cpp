// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/people_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/report/tod_figures.h"
#include "bench/studies/scene_pictures.h"
#include "bench/text/csv_table.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/json_file.h"
#include "bench/text/text.h"
#include "tod/observer_fit/people.h"

namespace todbench {
namespace {

constexpr const char* m75_schema = "todbench-m75-1";
constexpr int least_side_px = 512;

/// A name whose other characters than letters, digits, "-" and "_" are "_".
std::string file_name_of(std::string name) {
  for (char& c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    if (!plain) c = '_';
  }
  return name;
}

/// The trials as the experimenter sees them.
std::string truth_csv(const PersonExperiment& experiment) {
  std::string csv = "number,picture,range_m,target,aspect,draw\n";
  std::size_t number = 0;
  for (const PersonTrial& trial : experiment.trials()) {
    ++number;
    csv += fmt::format("{},{},{},{},{},{}\n", number, picture_name(number),
                       number_text(experiment.conditions()[trial.condition].range_m),
                       csv_field(experiment.alternatives()[trial.truth]), trial.aspect, trial.draw);
  }
  return csv;
}

Result<void> write_png(const std::filesystem::path& file, const cv::Mat1b& picture, const PngEncoder& png) {
  TODBENCH_TRY(const auto bytes, png(picture));
  return write_file_atomically(file, bytes);
}

void m75_fields(JsonFields& json, StatedM75& m75) {
  json.constant("schema", m75_schema);
  json.value("set", m75.set);
  json.value("answers_of", m75.answers_of);
  json.value("curve_of", m75.curve_of);
  json.value("m75", m75.m75);
  json.value("m75_ci95", m75.ci95);
}

PeopleShare share_of_people(const std::vector<PersonResult>& persons, std::size_t condition) {
  PeopleShare out;
  for (const PersonResult& person : persons) {
    out.shown += person.conditions[condition].shown;
    out.right += person.conditions[condition].right;
  }
  const double count = static_cast<double>(persons.size()), p = static_cast<double>(out.right) / out.shown;
  double squares = 0;
  for (const PersonResult& person : persons) {
    const PersonShare& own = person.conditions[condition];
    squares += std::pow(static_cast<double>(own.right) / own.shown - p, 2);
  }
  double answers = out.shown;
  // Everyone answered as many pictures, so that the mean has the variance of a person over their number.
  if (const double variance = count > 1 ? squares / (count - 1) / count : 0; variance > 0 && p > 0 && p < 1)
    answers = std::min(answers, p * (1 - p) / variance);
  out.ci95 = wilson_interval(p * answers, answers);
  return out;
}

}  // namespace

Result<std::string> people_set_number(const PersonExperiment& experiment) {
  std::string text = experiment.description().dump();
  for (const std::string& name : experiment.alternatives()) text += name + "\n";
  std::vector<bool> drawn(experiment.conditions().size(), false);
  for (const PersonTrial& trial : experiment.trials()) {
    if (drawn[trial.condition]) continue;
    drawn[trial.condition] = true;
    TODBENCH_TRY(const auto kelvin, experiment.picture_k(trial));
    // Few digits: the last bits of a picture may differ between processors.
    text += fmt::format("{} {:.4g}\n", kelvin.cols, cv::norm(kelvin));
  }
  return sha256_of(text + truth_csv(experiment)).substr(0, 12);
}

Result<void> write_people_set(const std::filesystem::path& folder, const PersonExperiment& experiment,
                              const PngEncoder& png) {
  if (is_there(folder)) return fail(ErrorCode::invalid_input, folder.string() + ": exists");
  TODBENCH_TRY(const auto number, people_set_number(experiment));
  for (const char* part : {"show/targets", "truth"}) {
    TODBENCH_TRY_VOID(make_folder(folder / part));
  }
  std::string sheet = "number,picture,experiment,answer\n";
  std::size_t index = 0;
  for (const PersonTrial& trial : experiment.trials()) {
    ++index;
    TODBENCH_TRY(const auto kelvin, experiment.picture_k(trial));
    const GreyScale grey = experiment.grey(trial);
    TODBENCH_TRY_VOID(write_png(folder / "show" / picture_name(index),
                                grey_picture(kelvin, grey.black_k, grey.white_k, least_side_px), png));
    sheet += fmt::format("{},{},{},\n", index, picture_name(index), number);
  }
  for (std::size_t t = 0; t < experiment.alternatives().size(); ++t) {
    const auto file = folder / "show/targets" / (file_name_of(experiment.alternatives()[t]) + ".png");
    TODBENCH_TRY_VOID(write_png(file, grey_picture(cv::Mat1f(experiment.icons()[t]), 0, 1, least_side_px), png));
  }
  Json record{{"schema", "todbench-people-set-1"},
              {"experiment", number},
              {"alternatives", experiment.alternatives()},
              {"pictures", experiment.trials().size()}};
  record.update(experiment.description());
  TODBENCH_TRY_VOID(write_file_atomically(folder / "truth/truth.csv", truth_csv(experiment)));
  TODBENCH_TRY_VOID(write_file_atomically(folder / "truth/experiment.json", record.dump(2) + "\n"));
  return write_file_atomically(folder / "show/answers.csv", sheet);
}

Result<std::vector<ExperimentAnswer>> read_people_answers(const std::filesystem::path& file,
                                                          const PersonExperiment& experiment) {
  TODBENCH_TRY(const auto text, read_text_file(file));
  TODBENCH_TRY(const auto table, parse_csv(text, file.string()));
  const auto number_column = table.column("number"), experiment_column = table.column("experiment"),
             answer_column = table.column("answer");
  if (!number_column || !experiment_column || !answer_column)
    return table.wrong(1, "expected the columns number, experiment and answer");
  TODBENCH_TRY(const auto number, people_set_number(experiment));
  const std::size_t count = experiment.trials().size();
  std::vector<std::optional<std::size_t>> found(count);
  for (const CsvRow& row : table.rows) {
    if (row.fields[*experiment_column] != number) {
      return table.wrong(row.line, fmt::format("the answers belong to experiment '{}', and these options describe {}: "
                                               "repeat the options and the seed with which the set was written",
                                               one_line(row.fields[*experiment_column]), number));
    }
    const auto picture = parse_number(row.fields[*number_column]);
    if (!picture || !(*picture >= 1 && *picture <= static_cast<double>(count)) || *picture != std::floor(*picture))
      return table.wrong(row.line, fmt::format("expected the number of a picture, 1 to {}", count));
    auto& answer = found[static_cast<std::size_t>(*picture) - 1];
    if (answer) return table.wrong(row.line, fmt::format("picture {:g} is answered twice", *picture));
    const std::string& name = row.fields[*answer_column];
    if (name.empty()) return table.wrong(row.line, "an answer is missing; a person who is not sure guesses");
    const auto at = std::ranges::find(experiment.alternatives(), name);
    if (at == experiment.alternatives().end()) {
      return table.wrong(row.line, "unknown target '" + one_line(name) + "'" +
                                       nearest_name_hint(name, experiment.alternatives()) +
                                       " (known: " + quoted_list(experiment.alternatives()) + ")");
    }
    answer = static_cast<std::size_t>(at - experiment.alternatives().begin());
  }
  std::vector<ExperimentAnswer> answers;
  for (const auto& answer : found) {
    if (!answer)
      return fail(ErrorCode::invalid_input,
                  fmt::format("{}: picture {} has no answer", file.string(), answers.size() + 1));
    answers.push_back({.answer = *answer});
  }
  return answers;
}

PeopleResult people_result(const PersonExperiment& experiment,
                           const std::vector<std::vector<ExperimentAnswer>>& persons) {
  PeopleResult out;
  for (const auto& answers : persons) out.persons.push_back(person_result(experiment, answers));
  for (std::size_t c = 0; c < experiment.conditions().size(); ++c)
    out.ranges.push_back(share_of_people(out.persons, c));
  if (out.persons.size() == 1) {
    out.r75_m = out.persons.front().r75_m;
    return out;
  }
  std::vector<PersonEstimate> estimates;
  for (const PersonResult& person : out.persons) {
    const SetCriterion& own = person.r75_m;
    if (own.value && own.ci95.low && own.ci95.high && *own.ci95.high > *own.ci95.low)
      estimates.push_back({std::log(*own.value), std::log(*own.ci95.high / *own.ci95.low) / (2 * normal_z95)});
  }
  if (estimates.size() < 2) return out;
  const PeopleSpread spread = spread_over(estimates);
  const auto range = [](const std::optional<double>& ln) { return ln ? std::optional(std::exp(*ln)) : std::nullopt; };
  out.r75_m = {range(spread.mean), {range(spread.mean_ci95.low), range(spread.mean_ci95.high)}};
  out.between_sd = spread.between_sd;
  return out;
}

Result<void> write_m75_file(const std::filesystem::path& file, const StatedM75& m75) {
  return write_json_file(file, json_of(m75, m75_fields));
}

Result<StatedM75> read_m75_file(const std::filesystem::path& file) {
  TODBENCH_TRY(const StatedM75 m75, read_record_file<StatedM75>(file, m75_fields));
  for (const std::optional<double>& value : {std::optional(m75.m75), m75.ci95.low, m75.ci95.high}) {
    if (value && !(*value >= 1e-6 && *value <= 1e6))
      return fail(ErrorCode::invalid_input, file.string() + ": m75 or its interval is not between 1e-6 and 1e6");
  }
  return m75;
}

}  // namespace todbench
