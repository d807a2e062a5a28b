// SPDX-License-Identifier: GPL-3.0-or-later
// Psychometric fits, TOD curves, comparison.
#include "bench/python/bindings.h"
#include "bench/session/fit_record.h"
#include "bench/session/trials_csv.h"
#include "tod/adequacy/adequacy.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {
namespace {

using Whole = py::array_t<int, py::array::c_style | py::array::forcecast>;

FitOptions fit_options_of(PsychometricForm form, std::optional<double> lapse, bool posterior = true) {
  return {.form = form, .fixed_lapse = lapse, .with_posterior = posterior};
}

void check_length(const char* name, py::ssize_t found, py::ssize_t wanted) {
  if (found == wanted) return;
  throw RaisedError{Error{ErrorCode::invalid_input, std::string(name) + ": expected " + std::to_string(wanted) +
                                                        " numbers, found " + std::to_string(found)}};
}

std::vector<Level> levels_of(const Numbers& size, const Numbers& correct, const Numbers& total,
                             const std::optional<Whole>& cluster) {
  check_length("correct", correct.size(), size.size());
  check_length("total", total.size(), size.size());
  if (cluster) check_length("cluster", cluster->size(), size.size());
  std::vector<Level> levels(static_cast<std::size_t>(size.size()));
  for (std::size_t i = 0; i < levels.size(); ++i)
    levels[i] = {size.data()[i], correct.data()[i], total.data()[i], cluster ? cluster->data()[i] : -1};
  return levels;
}

PsychometricFit fitted(const Numbers& size, const Numbers& correct, const Numbers& total,
                       const std::optional<Whole>& cluster, PsychometricForm form, std::optional<double> lapse,
                       bool posterior) {
  const auto levels = levels_of(size, correct, total, cluster);
  const py::gil_scoped_release free;
  return take(fit_psychometric(levels, fit_options_of(form, lapse, posterior)));
}

PsychometricFit fitted_graded(const Numbers& size, const Numbers& probability, const Whole& presentation,
                              const Whole& place, const std::optional<Whole>& set_up, PsychometricForm form,
                              std::optional<double> lapse) {
  check_length("probability_correct", probability.size(), size.size());
  check_length("presentation", presentation.size(), size.size());
  check_length("place", place.size(), size.size());
  if (set_up) check_length("set_up", set_up->size(), size.size());
  std::vector<GradedAnswer> answers(static_cast<std::size_t>(size.size()));
  for (std::size_t i = 0; i < answers.size(); ++i) {
    answers[i] = {size.data()[i], probability.data()[i], presentation.data()[i], place.data()[i],
                  set_up ? set_up->data()[i] : 0};
  }
  const py::gil_scoped_release free;
  return take(fit_graded(answers, fit_options_of(form, lapse)));
}

py::tuple columns_of(const std::vector<Level>& levels) {
  const auto count = static_cast<py::ssize_t>(levels.size());
  Numbers size(count), correct(count), total(count);
  Whole cluster(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    const Level& level = levels[static_cast<std::size_t>(i)];
    size.mutable_data()[i] = level.size, correct.mutable_data()[i] = level.correct;
    total.mutable_data()[i] = level.total, cluster.mutable_data()[i] = level.cluster;
  }
  return py::make_tuple(size, correct, total, cluster);
}

void add_fit(py::module_& module) {
  py::class_<Posterior>(module, "Posterior", "Posterior of a threshold.")
      .def_readonly("median", &Posterior::median, "Median.")
      .def_property_readonly(
          "ci95", [](const Posterior& p) { return py::make_tuple(p.low, p.high); }, "Equal-tailed 95 % interval.")
      // clang-format off
      TODBENCH_READ(Posterior, prior_bound);
  py::class_<PsychometricFit>(module, "PsychometricFit", doc("PsychometricFit"))
      .def_readonly("verdict", &PsychometricFit::verdict, doc("FitVerdict"))
      TODBENCH_READ(PsychometricFit, threshold)
      TODBENCH_READ(PsychometricFit, ci95)
      TODBENCH_READ(PsychometricFit, ci90)
      TODBENCH_READ(PsychometricFit, slope)
      TODBENCH_READ(PsychometricFit, slope_at_cap)
      .def_readonly("lapse", &PsychometricFit::lapse, "Lapse rate, fixed or fitted.")
      TODBENCH_READ(PsychometricFit, log_likelihood)
      .def_readonly("deviance", &PsychometricFit::deviance, "Deviance of the fit; None: not defined.")
      .def_readonly("degrees_of_freedom", &PsychometricFit::degrees_of_freedom, "Degrees of freedom of the deviance.")
      TODBENCH_READ(PsychometricFit, se_ln_threshold)
      .def_readonly("posterior", &PsychometricFit::posterior, "Posterior of the threshold; None: not computed.")
      .def_readonly("trials", &PsychometricFit::trials, "Number of trials.")
      .def_readonly("interval", &PsychometricFit::interval, doc("IntervalKind"))
      TODBENCH_READ(PsychometricFit, clusters)
      TODBENCH_READ(PsychometricFit, variance_inflation)
      TODBENCH_READ(PsychometricFit, dispersion)
      // clang-format on
      .def_property_readonly("usable", &PsychometricFit::usable, doc("PsychometricFit::usable"))
      .def_property_readonly("acuity_per_mrad", &acuity_per_mrad, doc("acuity_per_mrad"))
      .def_property_readonly(
          "acuity_ci95", [](const PsychometricFit& fit) { return acuity_interval(fit.ci95); }, doc("acuity_interval"))
      .def(
          "to_dict", [](const PsychometricFit& fit) { return python_of(fit_json(fit)); }, doc("fit_json"));
  module.def("fit_psychometric", &fitted, py::arg("size"), py::arg("correct"), py::arg("total"),
             py::arg("cluster") = py::none(), py::arg("form") = PsychometricForm::size, py::arg("lapse") = 0.0,
             py::arg("posterior") = true, doc("fit_psychometric"));
  module.def("fit_graded", &fitted_graded, py::arg("size"), py::arg("probability_correct"), py::arg("presentation"),
             py::arg("place"), py::arg("set_up") = py::none(), py::arg("form") = PsychometricForm::size,
             py::arg("lapse") = 0.0, doc("fit_graded"));
  module.def(
      "adequacy",
      [](const Numbers& size, const Numbers& correct, const Numbers& total, const PsychometricFit& fit,
         const std::optional<Whole>& cluster, PsychometricForm form, std::optional<double> lapse) {
        return python_of(
            adequacy_json(adequacy(levels_of(size, correct, total, cluster), fit, fit_options_of(form, lapse))));
      },
      py::arg("size"), py::arg("correct"), py::arg("total"), py::arg("fit"), py::arg("cluster") = py::none(),
      py::arg("form") = PsychometricForm::size, py::arg("lapse") = 0.0, doc("adequacy"));
  module.def(
      "read_levels", [](const std::filesystem::path& file) { return columns_of(take(read_levels(file))); },
      py::arg("file"), "Reads counts from a CSV file: (size, correct, total, cluster); a cluster below 0 is none.");
  module.def(
      "psychometric",
      [](const Numbers& size, double threshold, double slope, PsychometricForm form, double lapse) {
        Numbers proportion(std::vector<py::ssize_t>(size.shape(), size.shape() + size.ndim()));
        std::transform(size.data(), size.data() + size.size(), proportion.mutable_data(),
                       [&](double x) { return psychometric(form, x, threshold, slope, lapse); });
        return proportion;
      },
      py::arg("size"), py::arg("threshold"), py::arg("slope"), py::arg("form") = PsychometricForm::size,
      py::arg("lapse") = 0.0, doc("psychometric"));
}

void add_trials(py::module_& module) {
  py::class_<Trial>(module, "Trial", "One question and its answer.")
      .def(from_keywords<Trial>())
      // clang-format off
      TODBENCH_WRITE(Trial, presentation)
      .def_readwrite("plate", &Trial::plate, "Name of the plate.")
      .def_readwrite("mounting", &Trial::mounting, doc("Mounting"))
      TODBENCH_WRITE(Trial, triangle)
      TODBENCH_WRITE(Trial, set_delta_t_k)
      TODBENCH_WRITE(Trial, delta_t_k)
      .def_readwrite("size_mm", &Trial::size_mm, "Square root of the area.")
      TODBENCH_WRITE(Trial, size_mrad)
      TODBENCH_WRITE(Trial, size_px)
      .def_readwrite("truth", &Trial::truth, "Direction of the apex.")
      .def_readwrite("answer", &Trial::answer, "Answer of the observer.")
      .def_readwrite("scores", &Trial::scores, "Scores of the four alternatives.")
      TODBENCH_WRITE(Trial, phase_x_px)
      .def_readwrite("phase_y_px", &Trial::phase_y_px, doc("Trial::phase_x_px"))
      TODBENCH_WRITE(Trial, frame)
      TODBENCH_WRITE(Trial, probability_correct)
      TODBENCH_WRITE(Trial, frames)
      // clang-format on
      .def_property_readonly("correct", &Trial::correct, "Whether the answer is right.");
  module.def(
      "read_trials", [](const std::filesystem::path& file) { return take(read_trials(file)); }, py::arg("file"),
      py::call_guard<py::gil_scoped_release>(), doc("read_trials"));
}

void add_curve(py::module_& module) {
  // clang-format off
  py::class_<TodPoint>(module, "TodPoint", doc("TodPoint"))
      TODBENCH_READ(TodPoint, set_delta_t_k)
      TODBENCH_READ(TodPoint, delta_t_k)
      TODBENCH_READ(TodPoint, delta_t_se_k)
      TODBENCH_READ(TodPoint, fit)
      TODBENCH_READ(TodPoint, direct_s75_mrad)
      .def_readonly("direct_s75_se_mrad", &TodPoint::direct_s75_se_mrad, "Standard error of direct_s75_mrad.")
      TODBENCH_READ(TodPoint, s75_spread_mrad)
      TODBENCH_READ(TodPoint, saturated_share)
      TODBENCH_READ(TodPoint, noise_counts)
      TODBENCH_READ(TodPoint, lag1_correlation)
              // clang-format on
              .def_property_readonly(
                  "levels", [](const TodPoint& point) { return columns_of(point.levels); },
                  "Data of the fit: (size, correct, total, cluster).")
              .def_property_readonly(
                  "adequacy", [](const TodPoint& point) { return python_of(adequacy_json(point.adequacy)); },
                  doc("TodPoint::adequacy"));
  py::class_<TodCurve>(module, "TodCurve", doc("TodCurve"))
      .def_readonly("observer", &TodCurve::observer, "Name of the observer.")
      .def_readonly("sensor", &TodCurve::sensor, "Name of the sensor or camera.")
      // clang-format off
      TODBENCH_READ(TodCurve, points)
      // clang-format on
      .def(
          "to_dict", [](const TodCurve& curve) { return python_of(take(curve_record(curve))); }, doc("curve_record"));
  module.def(
      "tod_curve",
      [](const std::vector<Trial>& trials, PsychometricForm form, std::optional<double> lapse) {
        return take(tod_curve(trials, fit_options_of(form, lapse)));
      },
      py::arg("trials"), py::arg("form") = PsychometricForm::size, py::arg("lapse") = 0.0,
      py::call_guard<py::gil_scoped_release>(), doc("tod_curve"));
}

void add_comparison(py::module_& module) {
  // clang-format off
  py::class_<RatioOfPairs>(module, "RatioOfPairs", doc("RatioOfPairs"))
      TODBENCH_READ(RatioOfPairs, ratio)
      .def_readonly("ci95", &RatioOfPairs::ci95, "95 % interval.")
      .def_readonly("ci90", &RatioOfPairs::ci90, "90 % interval.")
      .def_readonly("se_ln_ratio", &RatioOfPairs::se_ln_ratio, "Standard error of ln ratio.")
      .def_readonly("degrees_of_freedom", &RatioOfPairs::degrees_of_freedom, "Degrees of freedom of the interval.")
      TODBENCH_READ(RatioOfPairs, p_difference)
      .def_readonly("p_equivalence", &RatioOfPairs::p_equivalence, doc("RatioOfPairs::p_difference"))
      .def_readonly("verdict", &RatioOfPairs::verdict, doc("ComparisonVerdict"))
      TODBENCH_READ(RatioOfPairs, twin_share)
      TODBENCH_READ(RatioOfPairs, answers);
  py::class_<ComparisonPoint>(module, "ComparisonPoint", doc("ComparisonPoint"))
      .def_readonly("set_delta_t_k", &ComparisonPoint::set_delta_t_k, "Set contrast.")
      .def_readonly("delta_t_a_k", &ComparisonPoint::delta_t_a_k, "Effective contrast of A.")
      .def_readonly("delta_t_b_k", &ComparisonPoint::delta_t_b_k, "Effective contrast of B.")
      .def_readonly("ratio", &ComparisonPoint::ratio, "Acuity of A over acuity of B; None: a threshold is missing.")
      .def_readonly("ratio_ci95", &ComparisonPoint::ratio_ci95, "95 % interval of the ratio.")
      .def_readonly("ratio_ci90", &ComparisonPoint::ratio_ci90, "90 % interval of the ratio.")
      TODBENCH_READ(ComparisonPoint, p_difference)
      TODBENCH_READ(ComparisonPoint, p_equivalence)
      .def_readonly("margin_percent", &ComparisonPoint::margin_percent, doc("ComparisonOptions::margin_percent"))
      .def_readonly("verdict", &ComparisonPoint::verdict, doc("ComparisonVerdict"))
      TODBENCH_READ(ComparisonPoint, withheld)
      TODBENCH_READ(ComparisonPoint, paired);
  py::class_<Comparison>(module, "Comparison", "Two curves, contrast by contrast.")
      .def_readonly("points", &Comparison::points, "One contrast each.")
      TODBENCH_READ(Comparison, verdict)
      // clang-format on
      .def(
          "to_dict", [](const Comparison& comparison) { return python_of(comparison_json(comparison)); },
          doc("comparison_json"));
  module.def(
      "compare",
      [](const TodCurve& a, const TodCurve& b, double margin_percent, PsychometricForm form,
         std::optional<double> lapse) {
        return take(compare(a, b, {.margin_percent = margin_percent, .fit = fit_options_of(form, lapse)}));
      },
      py::arg("a"), py::arg("b"), py::arg("margin_percent") = 10.0, py::arg("form") = PsychometricForm::size,
      py::arg("lapse") = 0.0, py::call_guard<py::gil_scoped_release>(), doc("compare"));
}

}  // namespace

void add_fits(py::module_& module) {
  add_fit(module);
  add_trials(module);
  add_curve(module);
  add_comparison(module);
}

}  // namespace todbench
