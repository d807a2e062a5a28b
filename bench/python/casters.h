// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion between values of the libraries and values of Python. Pictures become numpy arrays that share their
// pixels, enumerators become their names, and intervals and points become tuples. Every source file of the module
// includes this header.
#pragma once

#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <string_view>

#include "acquisition/base/interval.h"
#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"
#include "bench/judgement/conformity.h"
#include "bench/plan/plan.h"
#include "bench/text/json.h"
#include "tod/comparison/comparison.h"
#include "tod/measures/slanted_edge.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Error that is thrown to Python, where it becomes todbench.Error.
struct RaisedError {
  Error error;
};

/// Returns the value, or raises the error.
template <typename T>
T take(Result<T> result) {
  if (!result) throw RaisedError{std::move(result.error())};
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// Returns a read-only array of the pixels without a copy. The array keeps the pixels alive.
template <typename Pixel>
pybind11::array array_of(const cv::Mat_<Pixel>& picture) {
  namespace py = pybind11;
  auto held = std::make_unique<cv::Mat_<Pixel>>(picture);
  const cv::Mat_<Pixel>& kept = *held;
  const py::capsule owner(held.release(), [](void* pixels) { delete static_cast<cv::Mat_<Pixel>*>(pixels); });
  const auto step = static_cast<py::ssize_t>(kept.empty() ? sizeof(Pixel) * kept.cols : kept.step[0]);
  py::array array(py::dtype::of<Pixel>(), {kept.rows, kept.cols}, {step, static_cast<py::ssize_t>(sizeof(Pixel))},
                  kept.ptr(), owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// Returns an array with a copy of the values.
template <typename T>
pybind11::array_t<T> array_of(const std::vector<T>& values) {
  return pybind11::array_t<T>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}

/// Returns the enumerators whose names Python may pass; empty: Python only receives values of the enumeration.
template <typename Enum>
constexpr std::span<const Enum> names_taken() {
  return {};
}
template <>
constexpr std::span<const Mounting> names_taken<Mounting>() {
  return all_mountings;
}
template <>
constexpr std::span<const Apex> names_taken<Apex>() {
  return all_apexes;
}
template <>
constexpr std::span<const Effect> names_taken<Effect>() {
  return all_effects;
}
template <>
constexpr std::span<const PsychometricForm> names_taken<PsychometricForm>() {
  return all_psychometric_forms;
}
template <>
constexpr std::span<const ConformityRule> names_taken<ConformityRule>() {
  return conformity_rules;
}
inline constexpr std::array edge_axes{EdgeAxis::x, EdgeAxis::y};
template <>
constexpr std::span<const EdgeAxis> names_taken<EdgeAxis>() {
  return edge_axes;
}

/// Returns the enumerator of a name. Raises `invalid_input` with the known names.
template <typename Enum>
Enum enum_from(std::string_view name) {
  std::string known;
  for (const Enum one : names_taken<Enum>()) {
    if (to_string(one) == name) return one;
    known += (known.empty() ? "'" : ", '") + std::string(to_string(one)) + "'";
  }
  throw RaisedError{
      Error{ErrorCode::invalid_input, "expected one of " + known + ", found '" + std::string(name) + "'"}};
}

}  // namespace todbench

namespace pybind11::detail {

template <typename Enum>
struct TextEnumCaster {
  PYBIND11_TYPE_CASTER(Enum, const_name("str"));
  bool load(handle source, bool /*convert*/) {
    if (!isinstance<str>(source)) return false;
    value = todbench::enum_from<Enum>(source.cast<std::string>());
    return true;
  }
  static handle cast(Enum one, return_value_policy /*policy*/, handle /*parent*/) {
    return str(std::string(todbench::to_string(one))).release();
  }
};
// NOLINTBEGIN(cppcoreguidelines-macro-usage)
#define TODBENCH_AS_TEXT(Enum) \
  template <>                  \
  struct type_caster<todbench::Enum> : TextEnumCaster<todbench::Enum> {};
// NOLINTEND(cppcoreguidelines-macro-usage)
TODBENCH_AS_TEXT(Mounting)
TODBENCH_AS_TEXT(Apex)
TODBENCH_AS_TEXT(Effect)
TODBENCH_AS_TEXT(PsychometricForm)
TODBENCH_AS_TEXT(ConformityRule)
TODBENCH_AS_TEXT(ConformityDecision)
TODBENCH_AS_TEXT(EdgeAxis)
TODBENCH_AS_TEXT(FitVerdict)
TODBENCH_AS_TEXT(IntervalKind)
TODBENCH_AS_TEXT(ComparisonVerdict)
TODBENCH_AS_TEXT(FrameStatus)
TODBENCH_AS_TEXT(FindingKind)
TODBENCH_AS_TEXT(PlateMapping)
TODBENCH_AS_TEXT(BudgetDistribution)
#undef TODBENCH_AS_TEXT

template <>
struct type_caster<todbench::Interval> {
  using Pair = std::pair<std::optional<double>, std::optional<double>>;
  PYBIND11_TYPE_CASTER(todbench::Interval, const_name("Tuple[Optional[float], Optional[float]]"));
  bool load(handle source, bool convert) {
    make_caster<Pair> pair;
    if (!pair.load(source, convert)) return false;
    const Pair ends = cast_op<Pair>(pair);
    value = {ends.first, ends.second};
    return true;
  }
  static handle cast(const todbench::Interval& interval, return_value_policy /*policy*/, handle /*parent*/) {
    return pybind11::make_tuple(interval.low, interval.high).release();
  }
};

template <>
struct type_caster<cv::Point2d> {
  PYBIND11_TYPE_CASTER(cv::Point2d, const_name("Tuple[float, float]"));
  bool load(handle source, bool convert) {
    make_caster<std::pair<double, double>> pair;
    if (!isinstance<sequence>(source) || len(source) != 2) return false;
    const auto both = reinterpret_borrow<sequence>(source);
    if (!pair.load(pybind11::make_tuple(both[0], both[1]), convert)) return false;
    const auto place = cast_op<std::pair<double, double>>(pair);
    value = {place.first, place.second};
    return true;
  }
  static handle cast(cv::Point2d place, return_value_policy /*policy*/, handle /*parent*/) {
    return pybind11::make_tuple(place.x, place.y).release();
  }
};

template <>
struct type_caster<cv::Rect> {
  PYBIND11_TYPE_CASTER(cv::Rect, const_name("Tuple[int, int, int, int]"));
  bool load(handle /*source*/, bool /*convert*/) { return false; }
  static handle cast(const cv::Rect& area, return_value_policy /*policy*/, handle /*parent*/) {
    return pybind11::make_tuple(area.x, area.y, area.width, area.height).release();
  }
};

/// Conversion of pictures. A picture from Python is not copied for the call if its numbers have the pixel type and its
/// rows are contiguous.
template <typename Pixel>
struct type_caster<cv::Mat_<Pixel>> {
  using Array = array_t<Pixel, array::c_style | array::forcecast>;
  PYBIND11_TYPE_CASTER(cv::Mat_<Pixel>, const_name("numpy.ndarray"));
  bool load(handle source, bool convert) {
    if (!convert && !Array::check_(source)) return false;
    kept_ = Array::ensure(source);
    if (!kept_ || kept_.ndim() != 2) {
      PyErr_Clear();
      return false;
    }
    value = cv::Mat_<Pixel>(static_cast<int>(kept_.shape(0)), static_cast<int>(kept_.shape(1)),
                            const_cast<Pixel*>(kept_.data()));
    return true;
  }
  static handle cast(const cv::Mat_<Pixel>& picture, return_value_policy /*policy*/, handle /*parent*/) {
    return todbench::array_of(picture).release();
  }

 private:
  Array kept_;
};

}  // namespace pybind11::detail
