// SPDX-License-Identifier: GPL-3.0-or-later
// Results of a person for the page Human observer, as HTML.
#pragma once

#include <QString>

namespace todbench {

class HumanPresenter;
class MeasurePresenter;
class NakedEyePresenter;
class PersonPresenter;

/// Returns a summary of the answers to targets or bars, and their folder. Precondition: a finished experiment.
[[nodiscard]] QString result_of_a_person(const PersonPresenter& person);
/// Returns S75 of each source, and the ratio of its acuity to the acuity of the first source. Precondition: a blind
/// result.
[[nodiscard]] QString result_of_sources(const HumanPresenter& human);
/// Returns S75 of the person, and the prediction with its spread. Precondition: a finished session.
[[nodiscard]] QString result_of_naked_eye(const NakedEyePresenter& naked_eye);
/// Returns S75 of the person and of the model, and the mean over people. Precondition: a record.
[[nodiscard]] QString result_of_triangles(const HumanPresenter& human, const MeasurePresenter& model);

}  // namespace todbench
