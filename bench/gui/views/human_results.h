// SPDX-License-Identifier: GPL-3.0-or-later
// Results of a person for the page Human observer, as HTML.
#pragma once

#include <QString>

namespace todbench {

class HumanPresenter;
class MeasurePresenter;
class NakedEyePresenter;
class PersonPresenter;

/// Summary of the answers to targets or bars, and their folder. Precondition: a finished experiment.
[[nodiscard]] QString result_of_a_person(const PersonPresenter& person);
/// S75 of each source, and its acuity over that of the first. Precondition: a blind result.
[[nodiscard]] QString result_of_sources(const HumanPresenter& human);
/// S75 beside the prediction with its spread. Precondition: a finished session.
[[nodiscard]] QString result_of_naked_eye(const NakedEyePresenter& naked_eye);
/// S75 of the person beside that of the model, and the mean over people. Precondition: a record.
[[nodiscard]] QString result_of_triangles(const HumanPresenter& human, const MeasurePresenter& model);

}  // namespace todbench
