// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the Python module. Each source file adds the classes and functions of a few folders, and contains no
// computations.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "bench/python/casters.h"

namespace todbench {

namespace py = pybind11;

/// Array of numbers as an argument. A contiguous array of doubles is not copied.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Returns the comment of a declaration ("PsychometricFit::threshold", "fit_psychometric") as the build read it from
/// the headers; empty if there is none.
[[nodiscard]] const char* doc(std::string_view name);

// NOLINTBEGIN(cppcoreguidelines-macro-usage)
/// Bind a member with the comment of its declaration: read only, or readable and writable.
#define TODBENCH_READ(Type, member) .def_readonly(#member, &Type::member, doc(#Type "::" #member))
#define TODBENCH_WRITE(Type, member) .def_readwrite(#member, &Type::member, doc(#Type "::" #member))
// NOLINTEND(cppcoreguidelines-macro-usage)

/// Returns a constructor whose keyword arguments set members: SensorSpec(netd_k=0.05). An unknown name raises
/// AttributeError.
template <typename T>
auto from_keywords() {
  return py::init([](const py::kwargs& values) {
    auto made = std::make_unique<T>();
    const py::object view = py::cast(made.get(), py::return_value_policy::reference);
    for (const auto& [name, value] : values) py::setattr(view, name, value);
    return made;
  });
}

/// Returns a JSON document as Python dictionaries, lists, texts and numbers.
[[nodiscard]] py::object python_of(const Json& json);

/// Pictures from an array of three dimensions, or from a sequence of pictures. Pictures that already have the pixel
/// type are not copied. `kept` keeps the arrays alive.
template <typename Pixel>
struct GivenPictures {
  std::vector<py::object> kept;
  std::vector<cv::Mat_<Pixel>> pictures;
};
/// Returns the pictures of an argument. Raises `invalid_input` for other values.
template <typename Pixel>
GivenPictures<Pixel> given_pictures(const py::sequence& frames) {
  GivenPictures<Pixel> given;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    // A sequence may create its elements on access.
    const py::object frame = frames[i];
    using Array = py::array_t<Pixel, py::array::c_style | py::array::forcecast>;
    auto array = Array::ensure(frame);
    if (!array || array.ndim() != 2) {
      PyErr_Clear();
      throw RaisedError{Error{ErrorCode::invalid_input, "expected pictures: arrays of two dimensions of numbers"}};
    }
    given.pictures.emplace_back(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)),
                                const_cast<Pixel*>(array.data()));
    given.kept.push_back(std::move(array));
  }
  return given;
}

/// Add the parts to the module. Call them in this order, because a signature can only name classes that are already
/// added.
void add_observers(py::module_& module);
void add_plates(py::module_& module);
void add_sensors(py::module_& module);
void add_fits(py::module_& module);
void add_measures(py::module_& module);
void add_judgement(py::module_& module);
void add_plans(py::module_& module);
void add_cameras(py::module_& module);
void add_runs(py::module_& module);

}  // namespace todbench
