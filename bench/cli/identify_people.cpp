// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/identify_people.h"

#include <fmt/format.h>

#include <filesystem>

#include "bench/cli/commands.h"
#include "bench/judgement/verdict.h"
#include "bench/picture_files/encoded_picture.h"
#include "bench/report/tod_figures.h"
#include "bench/session/fit_record.h"
#include "bench/studies/people_set.h"

namespace todbench {
namespace {

int write_set(Console& console, const PeopleOptions& options, const PersonExperiment& experiment) {
  console.phase("drawing the pictures for people");
  const auto written =
      write_people_set(options.folder, experiment, [](const cv::Mat1b& picture) { return png_of(picture); });
  console.end_progress();
  if (!written) return report_error(console, written.error());
  const auto show = std::filesystem::path(options.folder) / "show";
  if (console.json()) {
    console.object(
        {{"folder", options.folder}, {"pictures", experiment.trials().size()}, {"targets", experiment.alternatives()}});
    return 0;
  }
  console.text(fmt::format("{} pictures in {}; the truth is in {}", experiment.trials().size(), show.string(),
                           (std::filesystem::path(options.folder) / "truth").string()));
  console.text("give a person a copy of " + show.string() + ", and read the filled answers.csv with --answers");
  return 0;
}

/// How the answers of the people are named as an observer.
std::string people_text(std::size_t persons) {
  return persons == 1 ? "one person" : fmt::format("{} people", persons);
}

Json people_json(const PersonExperiment& experiment, const IdentificationStudyTask& task, const PeopleResult& people,
                 const IdentificationStudy& rated) {
  Json ranges = Json::array(), persons = Json::array();
  for (std::size_t c = 0; c < people.ranges.size(); ++c) {
    const PeopleShare& share = people.ranges[c];
    ranges.push_back({{"range_m", json_number(experiment.conditions()[c].range_m)},
                      {"transmittance", json_number(experiment.conditions()[c].transmittance)},
                      {"shown", share.shown},
                      {"right", share.right},
                      {"proportion_correct", static_cast<double>(share.right) / share.shown},
                      {"ci95", json_interval(share.ci95)}});
  }
  for (const PersonResult& person : people.persons)
    persons.push_back({{"r75_m", json_number(person.r75_m.value)}, {"r75_ci95_m", json_interval(person.r75_m.ci95)}});
  return {{"set", task.set.name},
          {"sensor", task.sensor.name},
          {"observer", "human"},
          {"chance", rated.chance},
          {"persons", persons},
          {"ranges", ranges},
          {"r75_m", json_number(people.r75_m.value)},
          {"r75_ci95_m", json_interval(people.r75_m.ci95)},
          {"between_sd", json_number(people.between_sd)},
          {"curve_of", task.observer.name},
          {"m75", criterion_json(rated.m75, rated.no_m75_because)},
          {"v50", criterion_json(rated.v50, rated.no_m75_because)},
          {"notes", rated.notes}};
}

void print_people(Console& console, const PersonExperiment& experiment, const IdentificationStudyTask& task,
                  const PeopleResult& people, const IdentificationStudy& rated) {
  console.text(fmt::format("answers of {} to the pictures of {}, sensor {}", people_text(people.persons.size()),
                           task.set.name, task.sensor.name));
  std::vector<TableRow> rows;
  for (std::size_t c = 0; c < people.ranges.size(); ++c) {
    const PeopleShare& share = people.ranges[c];
    rows.push_back({fixed(experiment.conditions()[c].range_m, 0), fixed(experiment.conditions()[c].transmittance, 3),
                    std::to_string(share.shown), fixed(static_cast<double>(share.right) / share.shown, 3),
                    range(share.ci95, 3)});
  }
  console.table({"range [m]", "transmittance", "answers", "P correct", "95 %"}, rows);
  console.text("");
  console.text(range_text(people.r75_m, people.persons.size() == 1
                                            ? no_r75
                                            : "fewer than two people have a range of 75 % correct with an interval"));
  console.text("criteria of the set for people, on the TOD curve of " + task.observer.name + ": " +
               criteria_text(rated));
}

int read_answers(Console& console, const PeopleOptions& options, const IdentificationStudyTask& task,
                 const PersonExperiment& experiment) {
  std::vector<std::vector<ExperimentAnswer>> persons;
  for (const std::string& file : options.answers) {
    auto answers = read_people_answers(file, experiment);
    if (!answers) return report_error(console, answers.error());
    persons.push_back(*std::move(answers));
  }
  const PeopleResult people = people_result(experiment, persons);
  const auto rated = rate_found_range(task, people.r75_m);
  if (!rated) return report_error(console, rated.error());
  for (const std::string& sentence : rated->notes) console.note(sentence);
  if (!options.m75_out.empty()) {
    if (!rated->m75.value)
      return report_error(console,
                          {ErrorCode::not_identifiable, "--m75-out: the answers give no M75, so no file is written"});
    const StatedM75 m75{.set = task.set.name,
                        .answers_of = people_text(persons.size()),
                        .curve_of = task.observer.name,
                        .m75 = *rated->m75.value,
                        .ci95 = rated->m75.ci95};
    if (auto written = write_m75_file(options.m75_out, m75); !written) return report_error(console, written.error());
  }
  if (console.json()) {
    console.object(people_json(experiment, task, people, *rated));
  } else {
    print_people(console, experiment, task, people, *rated);
  }
  return exit_code(people.r75_m.value ? VerdictKind::pass : VerdictKind::inconclusive);
}

}  // namespace

std::string range_text(const SetCriterion& r75_m, std::string_view none_because) {
  if (!r75_m.value) return "no range found, because " + std::string(none_because);
  return "75 % correct at " + fixed(r75_m.value, 1) + " m, 95 %: " + range(r75_m.ci95, 1) + " m";
}

std::string criteria_text(const IdentificationStudy& study) {
  if (!study.m75.value) return "no M75 and no V50, because " + study.no_m75_because;
  return "M75 " + fixed(study.m75.value, 2) + " (" + range(study.m75.ci95, 2) + "), V50 " + fixed(study.v50.value, 2) +
         " (" + range(study.v50.ci95, 2) + ")";
}

Json criterion_json(const SetCriterion& criterion, const std::string& none_because) {
  Json json{{"value", json_number(criterion.value)}, {"ci95", json_interval(criterion.ci95)}};
  if (!criterion.value) json["reason"] = none_because;
  return json;
}

void PeopleOptions::add_to(CLI::App& command) {
  auto* write = command.add_option("--people", folder,
                                   "new folder for pictures for people, in random order, with the truth apart; asks no "
                                   "observer");
  auto* read = command
                   .add_option("--answers", answers,
                               "answers.csv of one or several people to the pictures that --people wrote with the same "
                               "options and seed")
                   ->excludes(write);
  command.add_option("--per-target", per_target, "pictures of every target at every range for a person")
      ->check(whole_number(1, 1000))
      ->capture_default_str();
  command.add_option("--m75-out", m75_out, "file for the M75 of the people, for todbench range --m75-of")->needs(read);
}

int run_identify_people(Console& console, const PeopleOptions& options, const IdentificationStudyTask& task) {
  const auto experiment = PersonExperiment::of_set(task, options.per_target);
  if (!experiment) return report_error(console, experiment.error());
  return options.folder.empty() ? read_answers(console, options, task, *experiment)
                                : write_set(console, options, *experiment);
}

}  // namespace todbench
