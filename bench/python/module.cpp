// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module todbench._core: errors, version, and the parts of bindings.h.
#include "bench/python/bindings.h"
#include "bench/session/build_info.h"

namespace todbench {
namespace {

std::string_view name_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_input:
      return "invalid_input";
    case ErrorCode::not_found:
      return "not_found";
    case ErrorCode::disconnected:
      return "disconnected";
    case ErrorCode::integrity:
      return "integrity";
    case ErrorCode::timeout:
      return "timeout";
    case ErrorCode::calibration:
      return "calibration";
    case ErrorCode::not_identifiable:
      return "not_identifiable";
    case ErrorCode::io:
      return "io";
    case ErrorCode::interrupted:
      return "interrupted";
    case ErrorCode::internal:
      return "internal";
  }
  return "internal";
}

void raise(const Error& error) {
  const py::object type = py::module_::import("todbench._core").attr("Error");
  const py::object raised = type(error.message);
  raised.attr("code") = std::string(name_of(error.code));
  raised.attr("key") = error.key ? py::object(py::str(error.key->name)) : py::none();
  raised.attr("reason") = error.key ? error.key->reason : error.message;
  PyErr_SetObject(type.ptr(), raised.ptr());
}

void add_error(py::module_& module) {
  py::object type = py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
      "todbench.Error",
      "A failure in one sentence. `code` is one of 'invalid_input', 'not_found', 'disconnected', 'integrity',\n"
      "'timeout', 'calibration', 'not_identifiable', 'io', 'interrupted' and 'internal'. `key` names the subject, a\n"
      "key of a plan or a file, or is None. `reason` is the fault without that name.",
      PyExc_RuntimeError, nullptr));
  module.add_object("Error", type);
  py::register_exception_translator([](std::exception_ptr pending) {
    try {
      if (pending) std::rethrow_exception(pending);
    } catch (const RaisedError& raised) {
      raise(raised.error);
    }
  });
}

}  // namespace

py::object python_of(const Json& json) {
  if (json.is_object()) {
    py::dict object;
    for (const auto& [key, value] : json.items()) object[py::str(key)] = python_of(value);
    return object;
  }
  if (json.is_array()) {
    py::list list;
    for (const Json& value : json) list.append(python_of(value));
    return list;
  }
  if (json.is_boolean()) return py::bool_(json.get<bool>());
  if (json.is_number_unsigned()) return py::int_(json.get<std::uint64_t>());
  if (json.is_number_integer()) return py::int_(json.get<std::int64_t>());
  if (json.is_number()) return py::float_(json.get<double>());
  if (json.is_string()) return py::str(json.get<std::string>());
  return py::none();
}

}  // namespace todbench

PYBIND11_MODULE(_core, module) {
  using namespace todbench;
  // Names in messages and stubs are those of the package that passes everything on.
  const py::object own_name = module.attr("__name__");
  module.attr("__name__") = "todbench";
  module.doc() = "Thermal cameras measured by a model observer; see the package todbench.";
  module.attr("__version__") = std::string(build_info().version);
  module.attr("__commit__") = std::string(build_info().commit);
  add_error(module);
  add_observers(module);
  add_plates(module);
  add_sensors(module);
  add_fits(module);
  add_measures(module);
  add_judgement(module);
  add_plans(module);
  add_cameras(module);
  add_runs(module);
  module.attr("__name__") = own_name;
}
