// SPDX-License-Identifier: GPL-3.0-or-later
// An observer fitted to people, short form of observer_fit_study.cpp.
#include <gmock/gmock.h>

#include "tests/tod/observer_fit/simulated_people.h"
#include "tod/observer_fit/goodness.h"
#include "tod/observer_fit/people.h"
#include "tod/observer_fit/person_likelihood.h"

namespace todbench::testing {
namespace {

constexpr std::array<bool, 4> blur_and_noise{true, true, false, false};
const ObserverValues someone{0.6, 0.07, 1, 0};

/// 48 patches at two contrasts.
ShownSession short_session(int per_size = 8) {
  return shown_session({{16.9, {1.0, 1.3, 1.7}}, {0.5, {1.2, 1.7, 2.3}}}, per_size, 3);
}

AnswerLattice lattice_of(const ShownSession& session, int draws = 32) {
  return std::move(*AnswerLattice::create({}, triangle_alternatives(), session.patches, {.draws = draws}));
}

TEST(AnswerLattice, SaysWhatTheObserverItselfSays) {
  const ShownSession session = short_session(4);
  AnswerLattice lattice = lattice_of(session, 384);
  for (const ObserverValues& person :
       {someone, ObserverValues{0.52, 0.031, 1.6, 0}, ObserverValues{0.85, 0.2, 1.2, 0}}) {
    TemplateObserver observer({.name = "person",
                               .blur_sigma_samples = person[0],
                               .internal_noise = person[1],
                               .sensor_noise_factor = person[2]},
                              triangle_alternatives());
    double square = 0, bias = 0;
    for (std::size_t i = 0; i < session.patches.size(); ++i) {
      const AnsweredPatch& shown = session.patches[i];
      const auto prepared = *observer.prepare(shown.size_samples, 1);

      const auto judged = prepared->judge({.kelvin = cv::Mat1d(shown.kelvin), .phase = {}, .noise_k = shown.noise_k},
                                          shown.contrast_k, RandomStream(5, i), 4000);
      const auto shares = answer_shares(lattice, i, person);

      EXPECT_NEAR(shares[0] + shares[1] + shares[2] + shares[3], 1, 1e-9);
      for (std::size_t o = 0; o < 4; ++o) {
        const double off = shares[o] - judged.answers.probability[o];
        square += off * off;
        if (static_cast<int>(o) == session.truths[i]) bias += off;
      }
    }
    const auto patches = static_cast<double>(session.patches.size());
    // 384 draws, the part along the main direction exact: 0.5 / sqrt(384) at most, half of it and less found. Patches
    // of a size share their draws, six sizes are independent.
    EXPECT_LT(std::sqrt(square / (4 * patches)), 0.02) << person[0];
    EXPECT_NEAR(bias / patches, 0, 4 * 0.02 / std::sqrt(6.0)) << person[0];
  }
}

/// 48 patches at two contrasts, for an eye.
ShownSession short_session_for_an_eye(int per_size) {
  return shown_session({{3, {1.0, 1.4, 2.0}}, {0.5, {1.8, 2.6, 3.6}}}, per_size, 3);
}

TEST(AnswerLattice, SaysWhatTheObserverWithAnEyeItselfSays) {
  const ShownSession session = short_session_for_an_eye(4);
  AnswerLattice lattice = std::move(
      *AnswerLattice::create(eye_at_display(), triangle_alternatives(), session.patches, {.draws = 384, .seed = 1}));
  for (const ObserverValues& person :
       {ObserverValues{1, 0.03, 1.75, 0}, ObserverValues{0.7, 0.06, 1.2, 0}, ObserverValues{1.5, 0.01, 2.5, 0}}) {
    TemplateObserver observer(person_of(person, FittedKind::eye), triangle_alternatives());
    double square = 0, bias = 0;
    for (std::size_t i = 0; i < session.patches.size(); ++i) {
      const AnsweredPatch& shown = session.patches[i];
      const auto prepared = *observer.prepare(shown.size_samples, 1);

      const auto judged = prepared->judge({.kelvin = cv::Mat1d(shown.kelvin), .phase = {}, .noise_k = shown.noise_k},
                                          shown.contrast_k, RandomStream(5, i), 4000);
      const auto shares = answer_shares(lattice, i, person);

      for (std::size_t o = 0; o < 4; ++o) {
        const double off = shares[o] - judged.answers.probability[o];
        square += off * off;
        if (static_cast<int>(o) == session.truths[i]) bias += off;
      }
    }
    const auto patches = static_cast<double>(session.patches.size());
    // As for the blurred observer: draws of 384, shared by the patches of a size.
    EXPECT_LT(std::sqrt(square / (4 * patches)), 0.02) << person[0];
    EXPECT_NEAR(bias / patches, 0, 4 * 0.02 / std::sqrt(6.0)) << person[0];
  }
}

TEST(AnswerLattice, RefusesWhatNobodyCanJudge) {
  const ShownSession session = short_session(1);
  const auto refused = [&](auto&& change) {
    auto patches = session.patches;
    change(patches[2]);
    const auto made = AnswerLattice::create({}, triangle_alternatives(), patches, {});
    return made ? std::string("taken") : made.error().message;
  };

  EXPECT_THAT(refused([](AnsweredPatch& p) { p.contrast_k = 0; }), ::testing::HasSubstr("patch 3: a contrast of 0"));
  EXPECT_THAT(refused([](AnsweredPatch& p) { p.kelvin = p.kelvin.colRange(0, 6).clone(); }),
              ::testing::HasSubstr("patch 3: expected a square"));
  EXPECT_THAT(refused([](AnsweredPatch& p) {
                p.kelvin = p.kelvin.clone();
                p.kelvin(1, 1) = std::numeric_limits<float>::quiet_NaN();
              }),
              ::testing::HasSubstr("not finite"));
  EXPECT_THAT(refused([](AnsweredPatch& p) { p.kelvin = p.kelvin(cv::Rect(0, 0, 4, 4)).clone(); }),
              ::testing::HasSubstr("samples on a side"));
  EXPECT_THAT(refused([](AnsweredPatch& p) { p.size_samples = -1; }), ::testing::HasSubstr("positive target size"));
  EXPECT_THAT(refused([](AnsweredPatch& p) { p.size_samples = 1e9; }), ::testing::HasSubstr("too large"));
}

TEST(ObserverFit, GradientIsThatOfTheLikelihood) {
  const ShownSession session = short_session();
  AnswerLattice lattice = lattice_of(session);
  const auto answers = answers_of(someone, session, 2);
  const ObserverPlace place = place_of({0.7, 0.11, 1.4, 0.03});

  const auto at = person_likelihood(lattice, answers, place);

  for (std::size_t k = 0; k < 4; ++k) {
    // The derivatives of the expansion are differences over 0.2 in ln; the lapse's is exact.
    const double step = k == 3 ? 1e-5 : 0.1;
    ObserverPlace less = place, more = place;
    less[k] -= step;
    more[k] += step;
    const double slope =
        (person_likelihood(lattice, answers, more).value - person_likelihood(lattice, answers, less).value) /
        (2 * step);
    EXPECT_NEAR(at.gradient[k], slope, 0.1 * std::abs(slope) + 1) << k;
    EXPECT_LE(at.hessian[k][k], 0);
  }
}

TEST(ObserverFit, IntervalsHoldTheValuesOfSimulatedPeople) {
  const ShownSession session = short_session();
  AnswerLattice lattice = lattice_of(session);
  std::array<int, 2> held{};
  constexpr int persons = 8;
  for (std::uint64_t person = 0; person < persons; ++person) {
    const auto fit = *fit_person(lattice, answers_of(someone, session, 100 + person), {.free = blur_and_noise});
    for (std::size_t k = 0; k < 2; ++k) {
      held[k] += fit.ci95[k].low.value_or(0) <= someone[k] && fit.ci95[k].high.value_or(1e9) >= someone[k] ? 1 : 0;
      EXPECT_LE(fit.ci95[k].low.value_or(0), fit.values[k]);
      EXPECT_GE(fit.ci95[k].high.value_or(1e9), fit.values[k]);
    }
  }
  // Of 8 intervals of 95 % fewer than 6 hold with probability 0.006.
  EXPECT_GE(held[0], 6);
  EXPECT_GE(held[1], 6);
}

TEST(ObserverFit, IntervalsHoldTheGainAndTheNoiseFactorOfSimulatedEyes) {
  const ShownSession session = short_session_for_an_eye(8);
  AnswerLattice lattice = std::move(
      *AnswerLattice::create(eye_at_display(), triangle_alternatives(), session.patches, {.draws = 32, .seed = 1}));
  const ObserverValues eye{0.8, 0.03, 2, 0};
  std::array<int, 3> held{};
  constexpr int persons = 8;
  for (std::uint64_t person = 0; person < persons; ++person) {
    const auto fit = *fit_person(lattice, answers_of(eye, session, 100 + person, FittedKind::eye),
                                 {.start = {1, 0.03, 1.75, 0}, .free = {true, false, true, false}});
    for (const std::size_t k : {0u, 2u})
      held[k] += fit.ci95[k].low.value_or(0) <= eye[k] && fit.ci95[k].high.value_or(1e9) >= eye[k] ? 1 : 0;
    EXPECT_EQ(fit.values[1], 0.03);
  }
  // Of 8 intervals of 95 % fewer than 6 hold with probability 0.006.
  EXPECT_GE(held[0], 6);
  EXPECT_GE(held[2], 6);
}

TEST(ObserverFit, RefusesSomebodyWhoseWrongAnswersAreAllUpAndTakesTheModelItself) {
  const ShownSession session = short_session(12);
  AnswerLattice lattice = lattice_of(session);
  auto answers = answers_of(someone, session, 4);
  const auto right = *fit_person(lattice, answers, {.free = blur_and_noise});
  const auto taken = goodness_of(lattice, answers, right, {.replicates = 99}, {});
  for (auto& answer : answers) answer.answer = answer.answer == answer.truth ? answer.truth : 0;

  const auto fit = *fit_person(lattice, answers, {.free = blur_and_noise});
  const auto good = goodness_of(lattice, answers, fit, {.replicates = 99}, {});

  EXPECT_GT(taken->p, 0.01);
  EXPECT_LE(good->p, 0.01);
  double total = 0;
  for (const auto& row : good->confusion) total += row[0] + row[1] + row[2] + row[3];
  EXPECT_EQ(total, static_cast<double>(session.patches.size()));
}

TEST(ObserverFit, StopsOnRequestAndRefusesNothingToFit) {
  const ShownSession session = short_session(1);
  AnswerLattice lattice = lattice_of(session);
  const auto answers = answers_of(someone, session, 4);
  std::stop_source stop;
  stop.request_stop();

  EXPECT_EQ(fit_person(lattice, {}, {.free = blur_and_noise}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(fit_person(lattice, answers, {}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(fit_person(lattice, answers, {.start = {9, 0.07, 1, 0}, .free = blur_and_noise}).error().code,
            ErrorCode::invalid_input);
  const auto fit = *fit_person(lattice, answers, {.free = blur_and_noise});
  EXPECT_EQ(goodness_of(lattice, answers, fit, {.replicates = 19}, stop.get_token()).error().code,
            ErrorCode::interrupted);
}

TEST(ObserverFit, NoiseThatNothingShowsIsLeftOpen) {
  // Without sensor noise its factor cannot be told.
  ShownSession session = short_session();
  for (auto& patch : session.patches) patch.noise_k = 0;
  AnswerLattice lattice = lattice_of(session);

  const auto fit = *fit_person(lattice, answers_of(someone, session, 1), {.free = {false, true, true, false}});

  EXPECT_FALSE(fit.ci95[2].high);
  EXPECT_FALSE(fit.covariance);
  EXPECT_FALSE(standard_error(fit, 1));
}

TEST(PeopleSpread, OfEqualStandardErrorsIsTheClosedForm) {
  // With equal se the restricted likelihood has its top at s^2 - se^2, and the mean is the mean.
  const std::vector<PersonEstimate> estimates{{0.1, 0.1}, {0.5, 0.1}, {0.9, 0.1}, {0.2, 0.1}, {0.8, 0.1}};
  double mean = 0, square = 0;
  for (const auto& e : estimates) mean += e.value / 5;
  for (const auto& e : estimates) square += std::pow(e.value - mean, 2) / 4;

  const PeopleSpread found = spread_over(estimates);

  EXPECT_NEAR(*found.mean, mean, 1e-12);
  EXPECT_NEAR(std::pow(*found.between_sd, 2), square - 0.01, 1e-6);
  // Student's t with four degrees, 2.776.
  EXPECT_NEAR(*found.mean_ci95.high - mean, 2.7764 * std::sqrt(square / 5), 1e-4);
  EXPECT_LT(*found.heterogeneity_p, 1e-6);
  // Q profile: 4 s^2 / (se^2 + v) is the quantile, 11.143 and 0.4844.
  EXPECT_NEAR(std::pow(*found.between_sd_ci95.low, 2), 4 * square / 11.1433 - 0.01, 1e-5);
  EXPECT_NEAR(std::pow(*found.between_sd_ci95.high, 2), 4 * square / 0.48442 - 0.01, 1e-3);
}

TEST(PeopleSpread, OfPeopleWhoAgreeIsNothing) {
  const std::vector<PersonEstimate> estimates{{0.5, 0.2}, {0.52, 0.2}, {0.49, 0.3}};

  const PeopleSpread found = spread_over(estimates);

  EXPECT_EQ(*found.between_sd, 0);
  EXPECT_EQ(*found.between_sd_ci95.low, 0);
  EXPECT_GT(*found.heterogeneity_p, 0.9);
  EXPECT_FALSE(spread_over(std::span(estimates).first(1)).mean);
}

}  // namespace
}  // namespace todbench::testing
