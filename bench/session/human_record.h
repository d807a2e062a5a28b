// SPDX-License-Identifier: GPL-3.0-or-later
// Answers of a person to the frames of a session, stored next to the answers of the model observer.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/plan.h"
#include "tod/presentation/trial.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

class JsonFields;

/// Presentation of a patch. These values are sufficient to reproduce the picture that the person saw.
struct ShownPatch {
  /// Samples that the model observer judged.
  cv::Mat1f kelvin;
  double black_k = 0, white_k = 0;  ///< levels displayed as black and as white
  int magnification = 1;            ///< screen pixels per sample; bicubic without a display in the plan
  std::optional<int> limit_ms;      ///< maximum display time; empty: until answered
  double response_s = 0;            ///< time from display to answer
  std::optional<double> noise_k{};  ///< temporal noise of a sample, as given to the model; empty in older files
};

/// Answers and the curve fitted to them. The trials have the same format as the trials of the model, with the answers
/// of the person and scores of 0.
struct HumanRecord {
  std::vector<Trial> trials;
  TodCurve curve;
  std::vector<ShownPatch> shown;  ///< one per trial, in order
};

/// Facts about the person who answered. Empty values: not stated.
struct PersonFacts {
  std::string code;  ///< a name, or a code in its place; empty in records of earlier versions
  std::optional<double> age_years, acuity_decimal;
  std::optional<double> distance_m, luminance_cd_m2;  ///< eye to screen; white on the screen
  std::string screen;                                 ///< description in free text
  std::string judged_utc;                             ///< end of the answers
  int training_answers = 0;                           ///< answers with feedback before the first answer that counts
};

/// Describes a person in records of answers.
void person_fields(JsonFields& json, PersonFacts& person);

/// A person with the answers given at one sitting.
struct PersonRecord {
  PersonFacts person;
  HumanRecord record;
};

/// Mean threshold of several people at one contrast: the geometric mean, with each person counted once. The interval
/// includes the scatter between people (Student's t of ln S75).
struct PeopleMean {
  double set_delta_t_k = 0;
  int people = 0;  ///< number of people with an identified threshold
  double s75_mrad = 0;
  std::optional<std::pair<double, double>> ci95_mrad{};  ///< empty: fewer than two people
};

/// Geometric mean of a threshold over people. Sittings with the same code count once, with their geometric mean; a
/// sitting without a code counts as one person. `codes` and `thresholds` have one element for each sitting; thresholds
/// above 0. The interval includes the scatter between people (Student's t of the logarithms); empty: fewer than two
/// people.
struct MeanOverPeople {
  int people = 0;
  double mean = 0;
  std::optional<std::pair<double, double>> ci95{};
};
/// Returns the mean over people of these sittings.
[[nodiscard]] MeanOverPeople mean_over_people(const std::vector<std::string>& codes,
                                              const std::vector<double>& thresholds);

/// Fits the answers in the same way as the answers of the model. Precondition: one patch per answer. Errors:
/// `invalid_input` (no answers).
[[nodiscard]] Result<HumanRecord> human_record(std::vector<Trial> answers, std::vector<ShownPatch> shown,
                                               const Plan& plan);
/// Adds the answers of a person to a finished session and lists the files in the manifest: trials_human.csv,
/// shown_human.csv and fits_human.json for the first person, people/N-trials.csv, people/N-shown.csv and
/// people/N-fits.json for the N-th, and people/people.json with the facts of all people. Earlier answers remain.
/// Errors: `io`; `invalid_input` (no manifest, or files that differ from it), in which case no file is written.
[[nodiscard]] Result<void> add_person(const std::filesystem::path& session, const PersonRecord& person);
/// Reads the record of the first person from a session that open_session() accepted; empty if no person has answered.
/// Errors: `invalid_input` with file and line or key.
[[nodiscard]] Result<std::optional<HumanRecord>> read_human(const std::filesystem::path& session);
/// Reads the records of all people, in the order of their answers. Errors: as read_human().
[[nodiscard]] Result<std::vector<PersonRecord>> read_people(const std::filesystem::path& session);
/// Returns the file with the pictures of the N-th person, counted from 1, relative to the session.
[[nodiscard]] std::string shown_file_of_person(std::size_t number);
/// Returns the mean at every contrast of the people. Several sittings of a person (the same code) count as their
/// geometric mean; each sitting without a code counts as one person.
[[nodiscard]] std::vector<PeopleMean> mean_over_people(const std::vector<PersonRecord>& people);

}  // namespace todbench
