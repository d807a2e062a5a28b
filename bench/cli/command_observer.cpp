// SPDX-License-Identifier: GPL-3.0-or-later
// todbench observer
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <numbers>
#include <optional>
#include <system_error>
#include <vector>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/cli/session_argument.h"
#include "bench/judgement/verdict.h"
#include "bench/naked_eye/naked_eye_session.h"
#include "bench/observer_fit/observer_file.h"
#include "bench/observer_fit/observer_fit_json.h"
#include "bench/observer_fit/observer_fit_page.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/resources.h"
#include "bench/report/html.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "hvs/eye/contrast_sensitivity.h"

namespace todbench {
namespace {

struct ObserverFitArguments {
  std::vector<std::string> sessions;
  std::string from = "hvs-1", out;
  std::vector<std::string> free;
  std::optional<std::string> person{};
  bool one_person = false, overwrite = false;
  int replicates = 299, draws = 384;
  Opening opening{};
};

Result<std::array<bool, observer_key_count>> free_keys(const std::vector<std::string>& names, FittedKind kind) {
  std::vector<std::string> known;
  for (const ObserverKey key : all_observer_keys) known.emplace_back(parameter_name(key, kind));
  std::array<bool, observer_key_count> out{};
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      return fail(ErrorCode::invalid_input, "--free: unknown parameter '" + one_line(name) + "'" +
                                                nearest_name_hint(name, known) + " (known: " + quoted_list(known) +
                                                ")");
    }
    bool& free = out[static_cast<std::size_t>(found - known.begin())];
    if (free) return fail(ErrorCode::invalid_input, "--free: '" + name + "' is listed twice");
    free = true;
  }
  return out;
}

/// The name of the observer is that of its file. Names of built-in observers are rejected.
Result<std::string> name_for(const ObserverFitArguments& arguments) {
  const std::filesystem::path file = arguments.out;
  const auto refuse = [&](const std::string& why) {
    return fail(ErrorCode::invalid_input, "--out: " + one_line(arguments.out) + ": " + why);
  };
  if (file.extension() != ".toml") return refuse("expected a file that ends with .toml");
  std::string name = file.stem().string();
  if (name.empty() || name != one_line(name) || name != valid_text(name))
    return refuse("the name of the file is not a valid name of an observer");
  for (const std::string& shipped : resource_names(ResourceKind::observer)) {
    if (name == shipped) return refuse("an observer of this name is built in; choose another name");
  }
  std::error_code none;
  if (std::filesystem::is_directory(file, none)) return refuse("is a folder, expected a file");
  if (!arguments.overwrite && std::filesystem::exists(file, none))
    return refuse("the file exists already (--force overwrites it)");
  return name;
}

Result<PeopleFitOptions> options_of(const ObserverFitArguments& arguments, const Program& program) {
  PeopleFitOptions options;
  TODBENCH_TRY(const auto name, name_for(arguments));
  TODBENCH_TRY(const auto from, find_resource(ResourceKind::observer, arguments.from));
  TODBENCH_TRY(options.from, parse_observer(from));
  TODBENCH_TRY(const auto free, free_keys(arguments.free, options.kind()));
  options.from_sha256 = sha256_of(from.text);
  options.name = name;
  options.free = free;
  options.persons = arguments.one_person ? PersonsAre::one : PersonsAre::codes;
  options.replicates = arguments.replicates;
  options.draws = arguments.draws + arguments.draws % 2;
  options.seed = program.common.seed;
  return options;
}

void print_people(const Console& console, const PeopleFit& fit) {
  std::vector<TableRow> rows;
  for (const FittedPerson& person : fit.people) {
    std::string who;
    for (const std::size_t s : person.sessions) who += (who.empty() ? "" : "; ") + label_of(fit.sessions[s]);
    for (std::size_t k = 0; k < observer_key_count; ++k) {
      if (person.fit.free[k])
        rows.push_back({who, fit.options.parameter(k), fixed(person.fit.values[k], 4), range(person.fit.ci95[k], 4),
                        fixed(person.goodness.p, 3)});
    }
  }
  console.table({"person", "parameter", "value", "95 %", "p of the model"}, rows);
}

void print_fit(const Console& console, const PeopleFit& fit) {
  std::vector<TableRow> rows;
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (!fit.options.free[k]) continue;
    rows.push_back(
        {fit.options.parameter(k), fixed(fit.values[k], 4), range(fit.ci95[k], 4), fixed(fit.spread[k].between_sd, 3)});
  }
  console.table({"parameter", "value", "95 %", "between persons (sd of ln)"}, rows);
  if (fit.people.size() > 1) print_people(console, fit);
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (const auto spreads = spreads_from_default(fit, k)) {
      console.text(fit.options.parameter(k) + " lies " + fixed(std::abs(*spreads), 2) +
                   (*spreads < 0 ? " spreads below " : " spreads above ") + fit.options.from.name);
    }
  }
  console.text("goodness of fit of the model: p = " + fixed(fit.least_p, 3) +
               (fit.accepted ? "" : ", the model is rejected"));
}

Result<Json> fitted(Console& console, const ObserverFitArguments& arguments, const Program& program, PeopleFit& out) {
  TODBENCH_TRY(auto options, options_of(arguments, program));
  std::vector<AnsweredSession> sessions;
  std::vector<std::string> accepted;
  for (const std::string& folder : arguments.sessions) {
    if (is_naked_eye_session(folder)) {
      if (arguments.person)
        return fail(ErrorCode::invalid_input, folder + ": a naked-eye session states no person; leave out --person");
      TODBENCH_TRY(auto answered, answered_naked_eye(folder));
      sessions.push_back(std::move(answered));
      continue;
    }
    TODBENCH_TRY(const auto session, opened(console, folder, arguments.opening));
    for (const std::string& file : session.accepted_changes)
      accepted.push_back((std::filesystem::path(folder) / file).generic_string());
    TODBENCH_TRY(auto answered, answered_sessions(folder, session, arguments.person));
    std::ranges::move(answered, std::back_inserter(sessions));
  }
  console.phase("fitting the observer");
  options.on_progress = [&console](std::size_t done, std::size_t planned) { console.progress(done, planned); };
  auto fit = fit_people(std::move(sessions), options, program.stop->token());
  console.end_progress();
  if (!fit) return tl::unexpected(fit.error());
  out = *std::move(fit);
  Json json = people_fit_json(out);
  add_accepted_changes(json, arguments.opening, accepted);
  return json;
}

int run_observer_fit(Console& console, const ObserverFitArguments& arguments, const Program& program) {
  PeopleFit fit;
  auto json = fitted(console, arguments, program, fit);
  if (!json) return report_error(console, json.error());
  std::filesystem::path page = arguments.out;
  page.replace_extension(".html");
  if (auto written = write_file_atomically(page, render_html(people_fit_document(fit))); !written)
    return report_error(console, written.error());
  if (fit.usable()) {
    if (auto written = write_file_atomically(arguments.out, observer_file(fit)); !written)
      return report_error(console, written.error());
  }
  (*json)["parameter_file"] = fit.usable() ? Json(arguments.out) : Json(nullptr);
  (*json)["page"] = page.string();
  if (console.json()) {
    console.object(*json);
  } else {
    print_fit(console, fit);
    console.text("page: " + page.string());
    if (fit.usable()) console.text("observer: " + arguments.out);
  }
  if (fit.usable()) return 0;
  console.warning(fit.accepted ? "no parameter file was written: " + fit.not_identified.front()
                               : "no parameter file was written: the model does not describe the answers (p = " +
                                     fixed(fit.least_p, 3) + ")");
  return exit_code(ErrorCode::not_identifiable);
}

struct SensitivityArguments {
  std::string observer = "hvs-2";
  double luminance_cd_m2 = 0;
  std::vector<double> frequencies;
  std::optional<double> age_years, field_deg;
};

/// Sensitivity of an eye to gratings that fill a square field.
Result<std::vector<double>> sensitivities(const SensitivityArguments& arguments) {
  TODBENCH_TRY(const auto resource, find_resource(ResourceKind::observer, arguments.observer));
  TODBENCH_TRY(const auto spec, parse_observer(resource));
  TODBENCH_TRY_VOID(require_eye(spec, arguments.observer));
  EyeParameters eye = *spec.eye;
  if (arguments.age_years) eye.age_years = *arguments.age_years;
  if (arguments.field_deg) eye.field_deg2 = *arguments.field_deg * *arguments.field_deg;
  TODBENCH_TRY_VOID(validate(eye));
  if (!NumberRange::between(1e-3, 1e5).contains(arguments.luminance_cd_m2))
    return fail_at(ErrorCode::invalid_input, "--luminance", "expected 0.001 to 100000 cd/m2");
  const EyeFilter filter(eye, arguments.luminance_cd_m2);
  // The Gaussian envelope with the area of the field.
  const double sigma_deg = std::sqrt(eye.field_deg2 / std::numbers::pi);
  std::vector<double> found;
  for (const double frequency : arguments.frequencies) {
    if (!NumberRange::between(0.01, 200).contains(frequency))
      return fail_at(ErrorCode::invalid_input, "--frequency", "expected 0.01 to 200 cycles per degree");
    found.push_back(filter.gabor_d_prime(frequency, sigma_deg) / detection_d_prime(1));
  }
  return found;
}

int run_sensitivity(Console& console, const SensitivityArguments& arguments) {
  const auto found = sensitivities(arguments);
  if (!found) return report_error(console, found.error());
  if (console.json()) {
    Json json{{"observer", arguments.observer}, {"luminance_cd_m2", json_number(arguments.luminance_cd_m2)}};
    json["frequency_per_degree"] = arguments.frequencies;
    json["sensitivity"] = *found;
    console.object(json);
    return 0;
  }
  std::vector<TableRow> rows;
  for (std::size_t i = 0; i < found->size(); ++i)
    rows.push_back({fixed(arguments.frequencies[i], 2), fixed((*found)[i], 2)});
  console.table({"frequency [1/deg]", "sensitivity"}, rows);
  return 0;
}

void add_sensitivity_command(CLI::App& observer, Program& program) {
  auto* command = observer.add_subcommand(
      "sensitivity", "prints the contrast sensitivity (1 over contrast at threshold) of an observer with an eye");
  auto a = std::make_shared<SensitivityArguments>();
  command->add_option("NAME", a->observer, "observer: name or file")->required();
  command->add_option("--luminance", a->luminance_cd_m2, "luminance that the eye adapts to, in cd/m2")->required();
  command->add_option("--frequency", a->frequencies, "spatial frequencies in cycles per degree, separated by commas")
      ->delimiter(',')
      ->required();
  command->add_option("--age", a->age_years, "age in years, in place of the observer's");
  command->add_option("--field-deg", a->field_deg,
                      "side of the square field in degrees: it sets the pupil and the area of the gratings");
  finish_command(*command, program, [a](Console& console) { return run_sensitivity(console, *a); });
}

}  // namespace

void add_observer_command(CLI::App& app, Program& program) {
  auto* observer = app.add_subcommand("observer", "fits observers to the answers of people, and prints what they see");
  observer->require_subcommand(1);
  add_sensitivity_command(*observer, program);
  add_naked_eye_command(*observer, program);
  auto* command = observer->add_subcommand(
      "fit", "fits the parameters of an observer to human answers, each with the picture that the person saw");
  auto a = std::make_shared<ObserverFitArguments>();
  command->add_option("SESSION", a->sessions, "session folders with the answers of a person")->required();
  command->add_option("--from", a->from, "observer from which the fit starts: name or file")->capture_default_str();
  command
      ->add_option("--free", a->free,
                   "parameters to fit, separated by commas: blur_sigma_samples, internal_noise, sensor_noise_factor, "
                   "lapse; with "
                   "an eye: gain, contrast_noise, sensor_noise_factor, lapse")
      ->delimiter(',')
      ->required();
  command
      ->add_option("--out", a->out,
                   "parameter file to write, NAME.toml; the page NAME.html is written to the same folder")
      ->required();
  command->add_option(
      "--person", a->person,
      "code of the one person of the sessions whose answers are fitted, or the number of the sitting of "
      "a person without a code; default: all people");
  command->add_flag("--one-person", a->one_person, "states that the same person answered in all sessions");
  command->add_option("--replicates", a->replicates, "simulated data sets of the model for the goodness-of-fit test")
      ->check(whole_number(99, 100000))
      ->capture_default_str();
  command->add_option("--draws", a->draws, "draws of the observer's own noise for the probabilities of one picture")
      ->check(whole_number(32, 100000))
      ->capture_default_str();
  command->add_flag("--force", a->overwrite, "overwrites an existing file");
  add_accept_changed(*command, a->opening.accept_changed);
  finish_command(*command, program, [a, &program](Console& console) { return run_observer_fit(console, *a, program); });
}

}  // namespace todbench
