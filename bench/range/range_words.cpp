// SPDX-License-Identifier: GPL-3.0-or-later
// What a range states of its model, its criterion and its observer.
#include <fmt/format.h>

#include <string>
#include <string_view>

#include "bench/range/range_models.h"

namespace todbench {

std::string_view to_string(RangeModel model) {
  switch (model) {
    case RangeModel::tod:
      return "tod";
    case RangeModel::acquire:
      return "acquire";
    case RangeModel::ttp:
      return "ttp";
    case RangeModel::mtdp:
      return "mtdp";
  }
  return "";
}

std::string criterion_origin(const RangeQuestion& question, RangeModel which) {
  const bool tod = which == RangeModel::tod;
  switch (question.criterion_source) {
    case CriterionSource::published:
      return tod ? "people, small craft in side view: 0.6 V50 with V50 = 8.5 (EO-VISTA, 4.2.3; Krapels et al. "
                   "2006); no interval is published"
                 : "people, small craft in side view: V50 = 8.5 (Krapels et al. 2006, in EO-VISTA, 4.2.3); no interval "
                   "is published";
    case CriterionSource::m75_stated:
      return tod ? "stated by the user" : "stated M75 / 0.6, the ratio of one published pair (EO-VISTA, 4.2.3)";
    case CriterionSource::m75_file:
      return question.m75_observer + (tod ? "" : "; M75 / 0.6, the ratio of one published pair (EO-VISTA, 4.2.3)");
    case CriterionSource::v50_stated:
      return tod ? "0.6 of the stated V50, the ratio of one published pair (EO-VISTA, 4.2.3)" : "stated by the user";
  }
  return "";
}

std::string observers_differ(const RangeQuestion& question) {
  if (question.curve_observer.empty() || question.curve_observer == "human" ||
      question.criterion_source == CriterionSource::m75_stated ||
      question.criterion_source == CriterionSource::m75_file)
    return "";
  return fmt::format(
      "the curve is judged by {}, but M75 = {:.4g} is a criterion of people: in the published experiment their acuity "
      "was 18 % above that of a model observer at high contrast and 35 % below at low contrast (EO-VISTA, figure "
      "10), and the range follows it. 'todbench identify' gives the M75 of {} for a set of targets",
      question.curve_observer, question.m75, question.curve_observer);
}

}  // namespace todbench
