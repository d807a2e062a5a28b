// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/observer_fit/people_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "hvs/observer/open_parameters.h"

namespace todbench {
namespace {

struct PersonQuestion {
  std::vector<AnsweredPatch> patches;
  std::vector<PersonAnswer> answers;
  std::vector<ShownSize> cells;
};

ShownSize shown_size(const Trial& trial) {
  // Sizes of one row of a plate may differ in the last bit of their description.
  return {trial.set_delta_t_k, std::round(trial.size_mrad * 1e6) / 1e6};
}

PersonQuestion question_of(const std::vector<AnsweredSession>& sessions, const std::vector<std::size_t>& own) {
  PersonQuestion out;
  std::set<ShownSize> sizes;
  for (const std::size_t s : own) {
    for (const Trial& trial : sessions[s].human.trials) sizes.insert(shown_size(trial));
  }
  out.cells.assign(sizes.begin(), sizes.end());
  for (const std::size_t s : own) {
    const AnsweredSession& session = sessions[s];
    for (std::size_t i = 0; i < session.human.trials.size(); ++i) {
      const Trial& trial = session.human.trials[i];
      const ShownPatch& shown = session.human.shown[i];
      const auto cell = std::lower_bound(out.cells.begin(), out.cells.end(), shown_size(trial)) - out.cells.begin();
      out.answers.push_back({.patch = out.patches.size(),
                             .answer = static_cast<int>(trial.answer),
                             .truth = static_cast<int>(trial.truth),
                             .cell = static_cast<int>(cell)});
      out.patches.push_back({.kelvin = shown.kelvin,
                             .contrast_k = trial.delta_t_k,
                             .noise_k = shown.noise_k.value_or(session.noise_k),
                             .size_samples = trial.size_px,
                             .samples_per_pitch = session.samples_per_pitch});
    }
  }
  return out;
}

std::string folders_of(const std::vector<AnsweredSession>& sessions, const std::vector<std::size_t>& own) {
  std::string text;
  for (const std::size_t s : own) text += (text.empty() ? "" : ", ") + label_of(sessions[s]);
  return text;
}

/// The observer at the display of these sessions, which must be one.
Result<TemplateObserverSpec> seen_by(const std::vector<AnsweredSession>& sessions, const std::vector<std::size_t>& own,
                                     TemplateObserverSpec observer) {
  if (!observer.eye) return observer;
  for (const std::size_t s : own) {
    const auto refuse = [&](const std::string& why) {
      return fail(ErrorCode::invalid_input, label_of(sessions[s]) + ": " + why);
    };
    if (!sessions[s].display)
      return refuse("the plan has no section [display], which observer " + observer.name + " needs");
    if (observer.display && *observer.display != *sessions[s].display)
      return refuse("the person viewed another display than in the sessions before");
    observer.display = sessions[s].display;
  }
  return observer;
}

Result<FittedPerson> fitted_person(const std::vector<AnsweredSession>& sessions, std::vector<std::size_t> own,
                                   const PeopleFitOptions& options, std::stop_token stop) {
  PersonQuestion question = question_of(sessions, own);
  TODBENCH_TRY(auto seeing, seen_by(sessions, own, options.from));
  auto lattice = AnswerLattice::create(seeing, triangle_alternatives(), std::move(question.patches),
                                       {.draws = options.draws, .seed = options.seed});
  const bool first = std::ranges::all_of(own, [&](std::size_t s) { return sessions[s].number == 1; });
  const std::string where = folders_of(sessions, own) + (first ? ": shown_human.csv" : ": shown pictures");
  if (!lattice) return fail(where, lattice.error());
  const PersonFitOptions how{.start = start_values(options.from), .free = options.free};
  auto fit = fit_person(*lattice, question.answers, how);
  if (!fit) return fail(where, fit.error());
  TODBENCH_TRY(auto goodness, goodness_of(*lattice, question.answers, *fit,
                                          {.replicates = options.replicates, .seed = options.seed}, std::move(stop)));
  return FittedPerson{std::move(own), *std::move(fit), std::move(goodness), std::move(question.cells)};
}

/// Returns a sentence if the answers of one person do not determine a parameter.
std::optional<std::string> left_open(const PeopleFitOptions& options, const PersonFit& fit, std::size_t k) {
  if (!fit.free[k]) return std::nullopt;
  const std::string name = options.parameter(k);
  if (!fit.ci95[k].low && !fit.ci95[k].high) return "the answers do not determine " + name;
  const bool harmless = fit.values[k] <= observer_limits(options.kind()).least[k] * 1.0001 && fit.ci95[k].high &&
                        all_observer_keys[k] != ObserverKey::blur_sigma_samples;
  if (fit.at_limit[k] && !harmless) return name + " lies at the end of its search range, " + number_text(fit.values[k]);
  if (!fit.ci95[k].high) return "the interval of " + name + " has no upper limit";
  return std::nullopt;
}

void find_left_open(PeopleFit& out) {
  for (const FittedPerson& person : out.people) {
    const std::string who = folders_of(out.sessions, person.sessions) + ": ";
    for (std::size_t k = 0; k < observer_key_count; ++k) {
      if (const auto open = left_open(out.options, person.fit, k)) out.not_identified.push_back(who + *open);
    }
    const auto free = static_cast<std::size_t>(std::count(person.fit.free.begin(), person.fit.free.end(), true));
    if (!person.fit.covariance) out.not_identified.push_back(who + "the answers do not separate the parameters");
    if (person.fit.answers < 10 * free) {
      out.not_identified.push_back(who + fmt::format("{} answers are too few for {} {}: each needs at least ten",
                                                     person.fit.answers, free, free == 1 ? "parameter" : "parameters"));
    }
  }
}

void put_together(PeopleFit& out) {
  if (out.people.size() == 1) {
    out.values = out.people.front().fit.values;
    out.ci95 = out.people.front().fit.ci95;
    return;
  }
  std::vector<PersonFit> fits;
  for (const FittedPerson& person : out.people) fits.push_back(person.fit);
  out.values = fits.front().values;
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (!out.options.free[k]) continue;
    out.spread[k] = people_spread(fits, k);
    if (!out.spread[k].mean) {
      out.not_identified.push_back(out.options.parameter(k) + ": fewer than two people have a standard error");
      continue;
    }
    const ObserverLimits limits = observer_limits(out.options.kind());
    out.values[k] = std::clamp(*out.spread[k].mean, limits.least[k], limits.most[k]);
    out.ci95[k] = out.spread[k].mean_ci95;
  }
}

}  // namespace

std::string label_of(const AnsweredSession& session) {
  if (session.sittings < 2) return session.folder;
  return session.folder + ", person " + (session.person.empty() ? std::to_string(session.number) : session.person);
}

Result<std::vector<AnsweredSession>> answered_sessions(const std::filesystem::path& folder, const Session& session,
                                                       const std::optional<std::string>& person) {
  TODBENCH_TRY(auto people, read_people(folder));
  const auto refuse = [&](const std::string& why) {
    return fail(ErrorCode::invalid_input, folder.string() + ": " + why);
  };
  if (std::ranges::all_of(people, [](const PersonRecord& one) { return one.record.trials.empty(); }))
    return refuse("this session has no answers of a person");
  SensorSpec sensor = session.parts.sensor;
  sensor.microscan = session.plan.simulation.microscan;
  const auto whole = std::filesystem::absolute(folder).lexically_normal();
  std::vector<AnsweredSession> out;
  std::vector<std::string> known;
  for (std::size_t i = 0; i < people.size(); ++i) {
    const std::string name = people[i].person.code.empty() ? std::to_string(i + 1) : people[i].person.code;
    if (std::ranges::find(known, name) == known.end()) known.push_back(name);
    if (people[i].record.trials.empty() || (person && *person != name)) continue;
    const std::string file = shown_file_of_person(i + 1);
    if (people[i].record.shown.empty()) return refuse("the shown pictures were not kept: there is no " + file);
    TODBENCH_TRY(auto sum, sha256_of_file(folder / file));
    out.push_back({.folder = (whole.has_filename() ? whole : whole.parent_path()).filename().string(),
                   .person = people[i].person.code,
                   .number = i + 1,
                   .sittings = people.size(),
                   .manifest_sha256 = session.manifest_sha256,
                   .shown_sha256 = std::move(sum),
                   .samples_per_pitch = sensor.samples_per_pitch(),
                   .noise_k = session.provenance.run ? session.provenance.run->temporal_noise_k : 0,
                   .display = has_display(session.plan) ? std::optional(session.plan.display) : std::nullopt,
                   .human = std::move(people[i].record)});
  }
  if (out.empty())
    return refuse("no answers of person '" + one_line(person.value_or("")) + "' (answers of: " + quoted_list(known) +
                  ")");
  return out;
}

namespace {

/// Indices of the sessions of every person.
Result<std::vector<std::vector<std::size_t>>> sessions_of_people(const std::vector<AnsweredSession>& sessions,
                                                                 PersonsAre persons) {
  std::vector<std::vector<std::size_t>> people;
  std::map<std::string, std::size_t> by_code;
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    const std::string& code = sessions[s].person;
    if (persons == PersonsAre::one) {
      if (people.empty()) people.emplace_back();
      for (const std::size_t other : people.front()) {
        const AnsweredSession& before = sessions[other];
        if (!code.empty() && !before.person.empty() && before.person != code)
          return fail(ErrorCode::invalid_input, label_of(before) + " and " + label_of(sessions[s]) +
                                                    " state the people '" + one_line(before.person) + "' and '" +
                                                    one_line(code) + "'; choose one with --person");
      }
      people.front().push_back(s);
      continue;
    }
    const auto [place, added] =
        code.empty() ? std::pair(by_code.end(), true) : by_code.try_emplace(code, people.size());
    if (added) people.emplace_back();
    people[added ? people.size() - 1 : place->second].push_back(s);
  }
  return people;
}

}  // namespace

Result<PeopleFit> fit_people(std::vector<AnsweredSession> sessions, const PeopleFitOptions& options,
                             std::stop_token stop) {
  PeopleFit out;
  out.options = options;
  out.sessions = std::move(sessions);
  std::map<std::string, std::string> seen;
  for (const AnsweredSession& session : out.sessions) {
    const auto [first, added] = seen.try_emplace(session.shown_sha256, label_of(session));
    if (!added)
      return fail(ErrorCode::invalid_input, label_of(session) + " and " + first->second + " contain the same answers");
  }
  TODBENCH_TRY(auto people, sessions_of_people(out.sessions, options.persons));
  for (auto& own : people) {
    TODBENCH_TRY(auto person, fitted_person(out.sessions, std::move(own), options, stop));
    out.least_p = std::min(out.least_p, person.goodness.p);
    out.people.push_back(std::move(person));
    if (options.on_progress) options.on_progress(out.people.size(), people.size());
  }
  out.accepted = out.least_p > options.least_p / static_cast<double>(out.people.size());
  find_left_open(out);
  put_together(out);
  return out;
}

ObserverValues start_values(const TemplateObserverSpec& from) {
  if (from.eye) return {1, from.eye->contrast_noise, from.sensor_noise_factor, 0};
  return {from.blur_sigma_samples, from.internal_noise, from.sensor_noise_factor, 0};
}

std::optional<double> spreads_from_default(const PeopleFit& fit, std::size_t key) {
  const auto range = open_parameter_range(fit.options.from);
  if (!range || !fit.options.free[key]) return std::nullopt;
  const double value = fit.values[key], before = start_values(fit.options.from)[key];
  switch (all_observer_keys[key]) {
    case ObserverKey::blur_sigma_samples:  // the gain
      return 2 * std::log(value) / std::log(range->best.eye->sensitivity / range->worst.eye->sensitivity);
    case ObserverKey::internal_noise:  // the contrast noise
      return 2 * (value - before) / (range->worst.eye->contrast_noise - range->best.eye->contrast_noise);
    case ObserverKey::sensor_noise_factor:
      return 2 * std::log(value / before) /
             std::log(range->worst.sensor_noise_factor / range->best.sensor_noise_factor);
    case ObserverKey::lapse:
      break;
  }
  return std::nullopt;
}

TemplateObserverSpec fitted_observer(const PeopleFit& fit) {
  TemplateObserverSpec spec = fit.options.from;
  spec.name = fit.options.name;
  spec.sensor_noise_factor = fit.values[2];
  if (spec.eye) {
    spec.eye->sensitivity *= fit.values[0];
    spec.eye->contrast_noise = fit.values[1];
    return spec;
  }
  spec.blur_sigma_samples = fit.values[0];
  spec.internal_noise = fit.values[1];
  return spec;
}

}  // namespace todbench
