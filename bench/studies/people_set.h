// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of an identification experiment for people: a folder of pictures in random order with the truth apart,
// and their answers.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/studies/person_experiment.h"

namespace todbench {

/// Number of an experiment: 12 hexadecimal digits of a hash. The hash covers description, alternatives and trials. It
/// also covers the contrast of one picture at every range, so that another sensor, air, motion or package has another
/// number. Errors: those of PersonExperiment::picture_k().
[[nodiscard]] Result<std::string> people_set_number(const PersonExperiment& experiment);

/// Encodes a grey picture as PNG.
using PngEncoder = std::function<Result<std::string>(const cv::Mat1b& picture)>;
/// Writes show/NUMBER.png, show/targets/NAME.png and show/answers.csv (an empty column `answer`), and for the
/// experimenter truth/truth.csv and truth/experiment.json, into a new folder. Every picture of a range has the same
/// grey scale. Errors: `invalid_input` if the folder exists; `io` with the path.
[[nodiscard]] Result<void> write_people_set(const std::filesystem::path& folder, const PersonExperiment& experiment,
                                            const PngEncoder& png);

/// Reads a filled answers.csv. Errors: `invalid_input` "FILE:LINE: ..." (columns missing, an answer missing or unknown,
/// a picture twice or missing, answers of another experiment).
[[nodiscard]] Result<std::vector<ExperimentAnswer>> read_people_answers(const std::filesystem::path& file,
                                                                        const PersonExperiment& experiment);

/// Answers of all people at one range. The interval is Wilson's for the number of independent answers that gives the
/// scatter between people; for one person, or if people scatter less than chance, for the number of answers.
struct PeopleShare {
  int shown = 0, right = 0;
  Interval ci95;
};
struct PeopleResult {
  std::vector<PersonResult> persons;
  std::vector<PeopleShare> ranges;
  /// Range with 75 % right. One person: as PersonResult. Several: mean over people by logarithms, with Hartung and
  /// Knapp's interval (people.h); empty if fewer than two have a range with an interval.
  SetCriterion r75_m;
  std::optional<double> between_sd;  ///< of ln R75 between people, beyond their own errors
};
/// Precondition: at least one person; every person answered every trial.
[[nodiscard]] PeopleResult people_result(const PersonExperiment& experiment,
                                         const std::vector<std::vector<ExperimentAnswer>>& persons);

/// M75 of a set in a file: whose answers, on whose TOD curve.
struct StatedM75 {
  std::string set, answers_of, curve_of;
  double m75 = 0;
  Interval ci95;
};
/// Errors: `io`.
[[nodiscard]] Result<void> write_m75_file(const std::filesystem::path& file, const StatedM75& m75);
/// Errors: `invalid_input` with the file (no such file, another schema, values beyond 1e-6 to 1e6).
[[nodiscard]] Result<StatedM75> read_m75_file(const std::filesystem::path& file);

}  // namespace todbench
