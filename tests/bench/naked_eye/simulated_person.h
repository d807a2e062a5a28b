// SPDX-License-Identifier: GPL-3.0-or-later
// People who are observers with an eye of known parameters, in naked-eye sessions.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "acquisition/base/rng.h"
#include "bench/naked_eye/naked_eye_session.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/resources.h"
#include "tests/support/temporary_folder.h"
#include "tod/plate/test_pattern.h"

namespace todbench::testing {

/// A screen with a sample of 1 arcmin.
inline ViewedDisplay calibrated_screen() {
  return {.pixel_pitch_mm = 0.27,
          .viewing_distance_m = 1.8564,
          .luminance_white_cd_m2 = 200,
          .luminance_black_cd_m2 = 0.3,
          .zoom = 2};
}

inline TemplateObserverSpec hvs_2_at(const ViewedDisplay& display) {
  TemplateObserverSpec spec = parse_observer(*find_resource(ResourceKind::observer, "hvs-2")).value();
  spec.display = display;
  return spec;
}

/// Lets the person answer all pictures, and writes the session.
inline void answer_all(NakedEyeSession& session, const TemplateObserverSpec& person, std::uint64_t seed) {
  TemplateObserver observer(person, triangle_alternatives());
  const RandomStream numbers(seed, "test.naked-eye");
  while (!session.complete()) {
    const NakedEyeTrial trial = session.trial();
    const auto prepared = observer.prepare(trial.size_samples, 1);
    ASSERT_TRUE(prepared) << prepared.error().message;
    const Patch patch{
        .kelvin = cv::Mat1d(session.picture().contrast), .phase = trial.centroid, .noise_k = session.picture().noise};
    const Choice choice = (*prepared)->choose(patch, trial.contrast, numbers.sub(trial.number));
    session.answer(static_cast<Apex>(choice.alternative), 1.0, std::nullopt);
  }
  const auto finished = session.finish({});
  ASSERT_TRUE(finished) << finished.error().message;
}

}  // namespace todbench::testing
