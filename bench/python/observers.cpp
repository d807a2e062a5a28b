// SPDX-License-Identifier: GPL-3.0-or-later
// Observers, random streams, shapes.
#include "acquisition/base/rng.h"
#include "bench/plan/descriptions.h"
#include "bench/python/bindings.h"
#include "hvs/observer/template_observer.h"
#include "hvs/shape/polygon.h"
#include "hvs/shape/polygon_coverage.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// Patches of a batch: one after the other, all of one contrast or each of its own.
struct Batch {
  Numbers patches, contrast_k, phase;
  double noise_k = 0;
  int side = 0;
  py::ssize_t count = 0;

  [[nodiscard]] Patch patch(py::ssize_t i) const {
    const double* at = phase.size() > 2 ? phase.data() + 2 * i : phase.data();
    return {cv::Mat1d(side, side, const_cast<double*>(patches.data()) + i * side * side), {at[0], at[1]}, noise_k};
  }
  [[nodiscard]] double contrast(py::ssize_t i) const { return contrast_k.data()[contrast_k.size() > 1 ? i : 0]; }
};

Batch batch_of(const PreparedObserver& observer, Numbers patches, Numbers contrast_k, std::optional<Numbers> phase,
               double noise_k) {
  const auto wrong = [](std::string sentence) {
    throw RaisedError{Error{ErrorCode::invalid_input, std::move(sentence)}};
  };
  const int side = observer.window_samples();
  if (patches.ndim() != 3 || patches.shape(1) != side || patches.shape(2) != side) {
    wrong("patches: expected an array of N x " + std::to_string(side) + " x " + std::to_string(side) +
          " numbers, the observer's window");
  }
  const py::ssize_t count = patches.shape(0);
  if (contrast_k.size() != 1 && contrast_k.size() != count)
    wrong("contrast_k: expected one number, or one for each patch");
  if (!phase) {
    phase = Numbers(2);
    std::fill_n(phase->mutable_data(), 2, 0.0);
  }
  if (phase->size() != 2 && phase->size() != 2 * count) wrong("phase: expected two numbers, or two for each patch");
  return {std::move(patches), std::move(contrast_k), std::move(*phase), noise_k, side, count};
}

/// Answers and scores of a batch. Trial i draws from noise.sub(first + i).
struct BatchAnswers {
  py::array_t<int> alternative;
  Numbers scores, probability;
  BatchAnswers(py::ssize_t count, bool graded)
      : alternative(count), scores({count, py::ssize_t{4}}), probability({graded ? count : 0, py::ssize_t{4}}) {}
};

py::tuple choose_batch(const PreparedObserver& observer, const Numbers& patches, const Numbers& contrast_k,
                       const RandomStream& noise, const std::optional<Numbers>& phase, double noise_k,
                       std::uint64_t first) {
  const Batch batch = batch_of(observer, patches, contrast_k, phase, noise_k);
  BatchAnswers answers(batch.count, false);
  int* alternative = answers.alternative.mutable_data();
  double* scores = answers.scores.mutable_data();
  {
    const py::gil_scoped_release free;
    for (py::ssize_t i = 0; i < batch.count; ++i) {
      const Choice choice =
          observer.choose(batch.patch(i), batch.contrast(i), noise.sub(first + static_cast<std::uint64_t>(i)));
      alternative[i] = choice.alternative;
      std::copy_n(choice.scores.begin(), 4, scores + 4 * i);
    }
  }
  return py::make_tuple(answers.alternative, answers.scores);
}

py::tuple judge_batch(const PreparedObserver& observer, const Numbers& patches, const Numbers& contrast_k,
                      const RandomStream& noise, const std::optional<Numbers>& phase, double noise_k,
                      std::uint64_t first, int draws) {
  const Batch batch = batch_of(observer, patches, contrast_k, phase, noise_k);
  BatchAnswers answers(batch.count, true);
  int* alternative = answers.alternative.mutable_data();
  double *scores = answers.scores.mutable_data(), *probability = answers.probability.mutable_data();
  {
    const py::gil_scoped_release free;
    for (py::ssize_t i = 0; i < batch.count; ++i) {
      const GradedChoice graded =
          observer.judge(batch.patch(i), batch.contrast(i), noise.sub(first + static_cast<std::uint64_t>(i)), draws);
      alternative[i] = graded.choice.alternative;
      std::copy_n(graded.choice.scores.begin(), 4, scores + 4 * i);
      std::copy_n(graded.answers.probability.begin(), 4, probability + 4 * i);
    }
  }
  return py::make_tuple(answers.alternative, answers.scores, answers.probability);
}

void add_streams(py::module_& module) {
  py::class_<RandomStream>(module, "RandomStream", doc("RandomStream"))
      .def(py::init<std::uint64_t, std::string_view>(), py::arg("seed"), py::arg("name"),
           "The stream of a name, e.g. 'observer'.")
      .def(py::init<std::uint64_t, std::uint64_t>(), py::arg("seed"), py::arg("stream"), "The stream of a number.")
      .def("sub", &RandomStream::sub, py::arg("index"), doc("RandomStream::sub"))
      .def("uniform", &RandomStream::uniform, py::arg("index"), doc("RandomStream::uniform"))
      .def("normal", &RandomStream::normal, py::arg("index"), doc("RandomStream::normal"))
      .def_property_readonly("seed", &RandomStream::seed, "Seed of the stream.")
      .def_property_readonly("stream", &RandomStream::stream, "Number of the stream.");
}

}  // namespace

void add_observers(py::module_& module) {
  add_streams(module);
  py::class_<TemplateObserverSpec>(module, "ObserverSpec", doc("TemplateObserverSpec"))
      .def(from_keywords<TemplateObserverSpec>())
      // clang-format off
      .def_readwrite("name", &TemplateObserverSpec::name, "Versioned name of the parameter set.")
      TODBENCH_WRITE(TemplateObserverSpec, blur_sigma_samples)
      TODBENCH_WRITE(TemplateObserverSpec, internal_noise)
      TODBENCH_WRITE(TemplateObserverSpec, sensor_noise_factor)
      TODBENCH_WRITE(TemplateObserverSpec, search_range_samples)
      .def_readwrite("search_step_samples", &TemplateObserverSpec::search_step_samples, "Distance of neighbouring places of the search.")
      TODBENCH_WRITE(TemplateObserverSpec, window_size_factor)
      TODBENCH_WRITE(TemplateObserverSpec, sample_aspect)
      .def_readwrite("window_margin_pitch", &TemplateObserverSpec::window_margin_pitch, "Margin of the window beyond the target, in detector pitches.");
  // clang-format on
  module.def(
      "load_observer", [](const std::string& reference) { return take(load_observer(reference)); },
      py::arg("reference"), doc("load_observer"));

  py::class_<PreparedObserver, std::shared_ptr<PreparedObserver>>(module, "PreparedObserver", doc("PreparedObserver"))
      .def_property_readonly("window_samples", &PreparedObserver::window_samples,
                             doc("PreparedObserver::window_samples"))
      .def_property_readonly("search_samples", &PreparedObserver::search_samples,
                             doc("PreparedObserver::search_samples"))
      .def("choose", &choose_batch, py::arg("patches"), py::arg("contrast_k"), py::arg("noise"),
           py::arg("phase") = py::none(), py::arg("noise_k") = 0.0, py::arg("first") = 0,
           "Answers N patches of N x window_samples x window_samples kelvin: (alternative, scores). contrast_k and\n"
           "phase are for all patches or one for each. Trial i draws from noise.sub(first + i). The patches are read "
           "in\n"
           "place if they are float64 in C order.")
      .def("judge", &judge_batch, py::arg("patches"), py::arg("contrast_k"), py::arg("noise"),
           py::arg("phase") = py::none(), py::arg("noise_k") = 0.0, py::arg("first") = 0,
           py::arg("draws") = MeasurementOptions::graded_draws,
           "As choose(), with the probability of every answer: (alternative, scores, probability). Where the\n"
           "probability is not exact it is the mean over `draws` of the observer's noise.");

  py::class_<TemplateObserver>(
      module, "Observer",
      "The template observer: correlation with ideal shapes behind the viewing filter, and search for the position.\n"
      "Thread-safe.")
      .def(py::init([](const TemplateObserverSpec& spec) {
             take(validate(spec));
             return std::make_unique<TemplateObserver>(spec, triangle_alternatives());
           }),
           py::arg("spec") = TemplateObserverSpec{}, "The observer of the four triangles with these parameters.")
      .def(py::init([](const std::string& reference) {
             return std::make_unique<TemplateObserver>(take(load_observer(reference)), triangle_alternatives());
           }),
           py::arg("reference"), "The observer of a name ('hvs-1') or a file.")
      .def_property_readonly("name", &TemplateObserver::name, doc("Observer::name"))
      .def_property_readonly("spec", &TemplateObserver::spec, "Parameters of the observer.")
      .def(
          "prepare",
          [](TemplateObserver& observer, double size_samples, int samples_per_pitch) {
            // Immutable: Python has no const.
            return std::const_pointer_cast<PreparedObserver>(take(observer.prepare(size_samples, samples_per_pitch)));
          },
          py::arg("size_samples"), py::arg("samples_per_pitch") = 1, py::call_guard<py::gil_scoped_release>(),
          doc("Observer::prepare"));

  module.def("area", &area, py::arg("polygon"), doc("area"));
  module.def("centroid", &centroid, py::arg("polygon"), doc("centroid"));
  module.def(
      "pixel_coverage",
      [](const Polygon& polygon, int width, int height) {
        return pixel_coverage(polygon, {width, height});
      },
      py::arg("polygon"), py::arg("width"), py::arg("height"), doc("pixel_coverage"));
  module.def("triangle", &triangle, py::arg("size"), py::arg("apex"), py::arg("centroid") = cv::Point2d{},
             doc("triangle"));
}

}  // namespace todbench
