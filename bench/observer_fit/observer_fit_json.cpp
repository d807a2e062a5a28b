// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/observer_fit/observer_fit_json.h"

#include <string>

namespace todbench {
namespace {

Json correlations_json(const PeopleFitOptions& options, const PersonFit& fit) {
  Json out = Json::array();
  for (std::size_t a = 0; a < observer_key_count; ++a) {
    for (std::size_t b = a + 1; b < observer_key_count; ++b) {
      if (fit.free[a] && fit.free[b])
        out.push_back(
            {{"of", {options.parameter(a), options.parameter(b)}}, {"value", json_number(correlation(fit, a, b))}});
    }
  }
  return out;
}

Json estimates_json(const PeopleFitOptions& options, const PersonFit& fit) {
  Json out = Json::object();
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (!fit.free[k]) continue;
    out[options.parameter(k)] = {{"value", json_number(fit.values[k])},
                                 {"ci95", json_interval(fit.ci95[k])},
                                 {"standard_error", json_number(standard_error(fit, k))},
                                 {"at_limit", fit.at_limit[k]}};
  }
  return out;
}

Json goodness_json(const FittedPerson& person) {
  const Goodness& goodness = person.goodness;
  Json tests = Json::array(), residuals = Json::array();
  for (std::size_t k = 0; k < all_misfit_kinds.size(); ++k) {
    tests.push_back({{"kind", to_string(all_misfit_kinds[k])},
                     {"statistic", json_number(goodness.tests[k].statistic)},
                     {"expected", json_number(goodness.tests[k].expected)},
                     {"p", json_number(goodness.tests[k].p)}});
  }
  for (const AnswerCell& cell : goodness.cells) {
    const ShownSize& shown = person.cells[static_cast<std::size_t>(cell.cell)];
    residuals.push_back({{"set_delta_t_k", json_number(shown.set_delta_t_k)},
                         {"size_mrad", json_number(shown.size_mrad)},
                         {"answers", json_number(cell.answers)},
                         {"correct", json_number(cell.correct)},
                         {"expected", json_number(cell.expected)},
                         {"sd", json_number(cell.sd)}});
  }
  return {{"p", json_number(goodness.p)},    {"replicates", goodness.replicates},
          {"tests", std::move(tests)},       {"residuals", std::move(residuals)},
          {"confusion", goodness.confusion}, {"expected_confusion", goodness.expected_confusion}};
}

Json spread_json(const PeopleFit& fit) {
  if (fit.people.size() < 2) return nullptr;
  Json out = Json::object();
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (!fit.options.free[k]) continue;
    const PeopleSpread& spread = fit.spread[k];
    out[fit.options.parameter(k)] = {{"persons", spread.persons},
                                     {"mean", json_number(spread.mean)},
                                     {"mean_ci95", json_interval(spread.mean_ci95)},
                                     {"between_sd", json_number(spread.between_sd)},
                                     {"between_sd_ci95", json_interval(spread.between_sd_ci95)},
                                     {"heterogeneity_p", json_number(spread.heterogeneity_p)}};
  }
  return out;
}

}  // namespace

Json people_fit_json(const PeopleFit& fit) {
  Json estimates = Json::object(), free = Json::array(), people = Json::array();
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (!fit.options.free[k]) continue;
    free.push_back(fit.options.parameter(k));
    estimates[fit.options.parameter(k)] = {{"value", json_number(fit.values[k])}, {"ci95", json_interval(fit.ci95[k])}};
    if (const auto spreads = spreads_from_default(fit, k))
      estimates[fit.options.parameter(k)]["spreads_from_default"] = json_number(*spreads);
  }
  for (const FittedPerson& person : fit.people) {
    Json sessions = Json::array();
    for (const std::size_t s : person.sessions) sessions.push_back(fit.sessions[s].folder);
    const std::string& code = fit.sessions[person.sessions.front()].person;
    people.push_back({{"sessions", std::move(sessions)},
                      {"person", code.empty() ? Json() : Json(code)},
                      {"answers", person.fit.answers},
                      {"estimates", estimates_json(fit.options, person.fit)},
                      {"correlations", correlations_json(fit.options, person.fit)},
                      {"log_likelihood", json_number(person.fit.log_likelihood)},
                      {"goodness", goodness_json(person)}});
  }
  const bool alone = fit.people.size() == 1;
  return {{"observer", fit.options.name},
          {"from", fit.options.from.name},
          {"free", std::move(free)},
          {"estimates", std::move(estimates)},
          {"correlations", alone ? correlations_json(fit.options, fit.people.front().fit) : Json(nullptr)},
          {"goodness", {{"p", json_number(fit.least_p)}, {"limit", json_number(fit.options.least_p)}}},
          {"accepted", fit.accepted},
          {"not_identified", fit.not_identified},
          {"persons", std::move(people)},
          {"between_persons", spread_json(fit)}};
}

}  // namespace todbench
