// SPDX-License-Identifier: GPL-3.0-or-later
// Plans: read, changed by key, written.
#include <algorithm>
#include <charconv>

#include "bench/devices/emulation.h"
#include "bench/plan/loaded_plan.h"
#include "bench/plan/plan_keys.h"
#include "bench/plan/resources.h"
#include "bench/python/bindings.h"
#include "bench/text/files.h"

namespace todbench {
namespace {

/// The key of a path. Raises `invalid_input` for a path that is not in the table, or in a section that is repeated.
KeyAt key_at(const std::string& path) {
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) {
      if (path_of(section, key) != path) continue;
      if (!section.repeated()) return {&section, &key, 0};
      throw RaisedError{Error{ErrorCode::invalid_input, path + ": this section is repeated; write it in the text of "
                                                               "the plan"}};
    }
  }
  throw RaisedError{Error{ErrorCode::invalid_input, path + ": a plan has no such key (docs/reference/plan-keys.md)",
                          ErrorKey{path, "a plan has no such key"}}};
}

std::string plain_word(const py::handle& value) {
  if (value.is_none()) return "";
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "yes" : "no";
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  // repr() of a float has all its digits.
  if (py::isinstance<py::float_>(value)) return py::repr(py::float_(value.cast<double>()));
  return py::str(value);
}

KeyValue key_value(const KeyAt& at, const std::string& path, const py::handle& value) {
  if (py::isinstance<py::dict>(value)) return value.cast<std::map<std::string, std::string>>();
  std::string text;
  if (py::isinstance<py::sequence>(value) && !py::isinstance<py::str>(value)) {
    for (const py::handle element : py::list(py::reinterpret_borrow<py::object>(value)))
      text += (text.empty() ? "" : ",") + plain_word(element);
  } else {
    text = plain_word(value);
  }
  auto read = value_from_text(at.key->type, text);
  if (!read) {
    throw RaisedError{
        Error{read.error().code, path + ": " + read.error().message, ErrorKey{path, read.error().message}}};
  }
  return *std::move(read);
}

Plan replaced(Plan plan, const py::dict& values) {
  for (const auto& [name, value] : values) {
    const auto path = name.cast<std::string>();
    const KeyAt at = key_at(path);
    at.key->place.set(plan, at.row, key_value(at, path, value));
  }
  plan = with_absolute_references(std::move(plan), "");
  take(validate(plan));
  return plan;
}

std::vector<std::string> key_paths() {
  std::vector<std::string> paths;
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) paths.push_back(path_of(section, key));
  }
  return paths;
}

ResourceKind kind_from(const std::string& name) {
  for (const EmbeddedResource& resource : embedded_resources()) {
    if (to_string(resource.kind) == name) return resource.kind;
  }
  throw RaisedError{Error{ErrorCode::invalid_input, "no descriptions of the kind '" + name + "' are built in"}};
}

}  // namespace

void add_plans(py::module_& module) {
  py::class_<Plan>(module, "Plan", "A measurement plan: equipment, conditions, duration and limits. Immutable.")
      .def(py::init([](const std::string& reference) { return take(load_plan(reference)); }), py::arg("reference"),
           doc("load_plan"))
      .def_static(
          "from_text",
          [](const std::string& text, const std::filesystem::path& folder) {
            return take(parse_plan({"text of the plan", text}, folder));
          },
          py::arg("text"), py::arg("folder") = std::filesystem::path("."), doc("parse_plan"))
      .def_readonly("name", &Plan::name, "Name of the plan.")
      .def_property_readonly("text", &to_toml, doc("to_toml"))
      .def(
          "__getitem__",
          [](const Plan& plan, const std::string& path) {
            const KeyAt at = key_at(path);
            return at.key->place.get(plan, at.row);
          },
          py::arg("path"), "Value of a key by its path: plan['target.delta_t_k'].")
      .def("replaced", &replaced, py::arg("values"),
           "A copy with other values of keys: plan.replaced({'seed': 2, 'target.delta_t_k': [4, 1]}). Raises\n"
           "`invalid_input` about the key.")
      .def(
          "check", [](const Plan& plan) { take(LoadedPlan::load(plan)); }, py::call_guard<py::gil_scoped_release>(),
          "Reads all that the plan names and raises what does not fit together.")
      .def(
          "write",
          [](const Plan& plan, const std::filesystem::path& file) { take(write_file_atomically(file, to_toml(plan))); },
          py::arg("file"), py::call_guard<py::gil_scoped_release>(), "Writes the plan as TOML.")
      .def(
          "__eq__", [](const Plan& a, const Plan& b) { return a == b; }, py::arg("other"),
          "Whether all keys are equal.");
  module.def("plan_keys", &key_paths, "Paths of all keys of a plan.");
  module.def(
      "built_in", [](const std::string& kind) { return resource_names(kind_from(kind)); }, py::arg("kind"),
      "Names of the built-in descriptions of a kind: 'plan', 'sensor', 'observer', 'plate', ...");
  module.def(
      "demonstration_plan", [] { return take(demonstration_plan(DemonstrationLength::quick)); },
      doc("demonstration_plan"));
}

}  // namespace todbench
