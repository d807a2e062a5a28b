// SPDX-License-Identifier: GPL-3.0-or-later
// Blind judgement: a person judges the pictures of several sources (camera, twin, enhanced, super-resolved) in one
// mixed order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/enhance/package_file.h"
#include "bench/run/experiment.h"
#include "bench/run/judged_trial.h"
#include "bench/session/human_record.h"
#include "bench/text/json.h"
#include "tod/comparison/comparison.h"

namespace todbench {

/// Pictures of one source.
struct BlindSource {
  std::string name;           ///< "camera", "simulated", or the name of a package
  int samples_per_pixel = 1;  ///< samples per pixel and axis of the patches of the source
  std::vector<JudgedTrial> trials;
};

/// Patch as shown to the person. The program does not reveal the source of the patch before the last answer.
struct BlindPatch {
  std::size_t source = 0;
  JudgedTrial judged;  ///< patch, cut to the field that all sources have in common
  /// Samples per pixel and axis. A pixel has the same size on the screen for every source, regardless of its number of
  /// samples.
  int samples_per_pixel = 1;
};

/// Answer to a patch.
struct BlindAnswer {
  std::size_t source = 0;
  Trial trial;  ///< trial with the answer of the person
  ShownPatch shown{};
};

/// Result of each source, and the ratio of its acuity to the acuity of the first source.
struct BlindResult {
  std::vector<std::string> sources;
  std::vector<HumanRecord> records;  ///< one per source
  /// Ratios of the second and later sources to the first. A ratio has no value if why_withheld() returns a reason.
  std::vector<Comparison> ratios;
};

/// Replays the recorded frames of a session without a package and through each package. Returns the sources in this
/// order: camera, its twin if `with_twin`, packages. Writes the sessions of the model observer to `folder`/sources.
/// Errors: those of replay_session() and judge_again(); `invalid_input` (two packages of one name).
[[nodiscard]] Result<std::vector<BlindSource>> blind_sources(const std::filesystem::path& session,
                                                             const std::vector<EnhancementPackage>& packages,
                                                             bool with_twin, const std::filesystem::path& folder,
                                                             const ExperimentListener& listener, std::stop_token stop);

/// Returns `per_size` patches of each source for each contrast and size, all in one random order that follows from the
/// seed. Errors: `invalid_input` (no source, or sources without common contrasts and sizes).
[[nodiscard]] Result<std::vector<BlindPatch>> blind_order(const std::vector<BlindSource>& sources, int per_size,
                                                          std::uint64_t seed);

/// Fits the answers of each source, and compares each source with the first source. Errors: `invalid_input` (a source
/// without answers).
[[nodiscard]] Result<BlindResult> blind_result(const std::vector<std::string>& sources,
                                               const std::vector<BlindAnswer>& answers, const Plan& plan);

/// Returns the reason why the ratio of a source to the first source has no value at a contrast: the threshold of one of
/// the two sources may not be used. Empty: the ratio has a value.
[[nodiscard]] std::string why_withheld(const BlindResult& result, std::size_t source, double set_delta_t_k);
/// Returns the exit code: 0 if every threshold of every source may be used (why_undecided()), otherwise 3.
[[nodiscard]] int exit_code(const BlindResult& result);

/// Returns {"sources": [{"name", "answers", "points": [...]}], "ratios": [{"source", "to", "points": [...]}], ...}.
[[nodiscard]] Json blind_json(const BlindResult& result, const PersonFacts& person, std::uint64_t seed);

/// Writes blind.json and blind.csv, one row per answer in the order of showing. Errors: `io`.
[[nodiscard]] Result<void> write_blind(const std::filesystem::path& folder, const BlindResult& result,
                                       const std::vector<BlindAnswer>& answers, const PersonFacts& person,
                                       std::uint64_t seed);

}  // namespace todbench
