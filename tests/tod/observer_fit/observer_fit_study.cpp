// SPDX-License-Identifier: GPL-3.0-or-later
// 100 simulated people of known parameters, and people of another kind.
#include <gmock/gmock.h>

#include <cstdio>

#include "tests/tod/observer_fit/simulated_people.h"
#include "tod/observer_fit/goodness.h"

namespace todbench::testing {
namespace {

AnswerLattice lattice_of(const ShownSession& session) {
  return std::move(*AnswerLattice::create({}, triangle_alternatives(), session.patches, {}));
}

TEST(ObserverFitStudy, IntervalsHoldTheValuesOfAHundredPeople) {
  const ShownSession session = shown_session(usual_contrasts(), 12, 3);
  AnswerLattice lattice = lattice_of(session);
  constexpr int persons = 100;
  std::array<int, 3> held{};
  std::array<double, 3> sum{}, square{}, variance{};
  for (std::uint64_t person = 0; person < persons; ++person) {
    // Everyone is another: blur, noise and efficiency spread over the range of the shipped observers.
    const RandomStream own(person, "study.people");
    const ObserverValues truth{0.45 + 0.3 * own.uniform(0), 0.03 * std::exp(std::log(4.0) * own.uniform(1)),
                               1.2 + 0.6 * own.uniform(2), 0};
    const auto fit =
        *fit_person(lattice, answers_of(truth, session, 1000 + person), {.free = {true, true, true, false}});
    for (std::size_t k = 0; k < 3; ++k) {
      held[k] += fit.ci95[k].low.value_or(0) <= truth[k] && fit.ci95[k].high.value_or(1e9) >= truth[k] ? 1 : 0;
      const double off = std::log(fit.values[k] / truth[k]);
      sum[k] += off;
      square[k] += off * off;
      variance[k] += std::pow(standard_error(fit, k).value_or(0), 2);
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    std::printf("%s: held %d of %d, mean error of ln %+.3f, scatter %.3f, stated %.3f\n",
                std::string(to_string(all_observer_keys[k])).c_str(), held[k], persons, sum[k] / persons,
                std::sqrt(square[k] / persons), std::sqrt(variance[k] / persons));
    EXPECT_GE(held[k], 90);
  }
}

TEST(ObserverFitStudy, IntervalsHoldTheEyesOfAHundredPeople) {
  const ShownSession session = shown_session(contrasts_for_an_eye(), 12, 3);
  AnswerLattice lattice =
      std::move(*AnswerLattice::create(eye_at_display(), triangle_alternatives(), session.patches, {}));
  constexpr int persons = 100;
  std::array<int, 3> held{};
  std::array<double, 3> sum{}, square{}, variance{};
  for (std::uint64_t person = 0; person < persons; ++person) {
    // Spread over the open parameters of hvs-2: sensitivity +-4 dB, contrast noise, efficiency.
    const RandomStream own(person, "study.eyes");
    const ObserverValues truth{std::exp(0.46 * (2 * own.uniform(0) - 1)), 0.02 + 0.05 * own.uniform(1),
                               1.3 + 1.5 * own.uniform(2), 0};
    const auto fit = *fit_person(lattice, answers_of(truth, session, 1000 + person, FittedKind::eye),
                                 {.start = {1, 0.03, 1.75, 0}, .free = {true, true, true, false}});
    for (std::size_t k = 0; k < 3; ++k) {
      held[k] += fit.ci95[k].low.value_or(0) <= truth[k] && fit.ci95[k].high.value_or(1e9) >= truth[k] ? 1 : 0;
      const double off = std::log(fit.values[k] / truth[k]);
      sum[k] += off;
      square[k] += off * off;
      variance[k] += std::pow(standard_error(fit, k).value_or(0), 2);
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    std::printf("%s: held %d of %d, mean error of ln %+.3f, scatter %.3f, stated %.3f\n",
                std::string(parameter_name(all_observer_keys[k], FittedKind::eye)).c_str(), held[k], persons,
                sum[k] / persons, std::sqrt(square[k] / persons), std::sqrt(variance[k] / persons));
    EXPECT_GE(held[k], 90);
  }
}

/// Changes the answers of the model.
using Change = void (*)(PersonAnswer& answer, const RandomStream& own);

TEST(ObserverFitStudy, PeopleOfAnotherKindAreRefusedAndTheModelIsNot) {
  const ShownSession session = shown_session(usual_contrasts(), 12, 3);
  AnswerLattice lattice = lattice_of(session);
  const ObserverValues person{0.6, 0.07, 1.3, 0};
  struct Kind {
    const char* name;
    Change change;
    int least, most;
  };
  const Kind kinds[] = {
      // 1 % of 40: more than two with probability 0.007.
      {"the model itself", [](PersonAnswer&, const RandomStream&) {}, 0, 2},
      {"a lapse of 12 % that is not free",
       [](PersonAnswer& a, const RandomStream& own) {
         if (own.uniform(0) < 0.12) a.answer = static_cast<int>(own.below(4, 1));
       },
       36, 40},
      {"every second wrong answer up",
       [](PersonAnswer& a, const RandomStream& own) {
         if (a.answer != a.truth && own.uniform(0) < 0.5) a.answer = 0;
       },
       30, 40},
      {"up taken for down and down for up",
       [](PersonAnswer& a, const RandomStream& own) {
         if (own.uniform(0) < 0.2 && a.answer % 2 == 0) a.answer = 2 - a.answer;
       },
       36, 40},
  };
  for (const Kind& kind : kinds) {
    int refused = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      auto answers = answers_of(person, session, 5000 + seed);
      const RandomStream all(seed, "study.kinds");
      for (std::size_t i = 0; i < answers.size(); ++i) kind.change(answers[i], all.sub(i));
      const auto fit = *fit_person(lattice, answers,
                                   {.free = {true, true, true, false}, .intervals = PersonFitOptions::Intervals::none});
      refused += goodness_of(lattice, answers, fit, {.replicates = 99, .seed = seed}, {})->p <= 0.01 ? 1 : 0;
    }
    std::printf("%s: refused %d of 40\n", kind.name, refused);
    EXPECT_GE(refused, kind.least) << kind.name;
    EXPECT_LE(refused, kind.most) << kind.name;
  }
}

}  // namespace
}  // namespace todbench::testing
