// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of plans, and sessions.
#include <exception>
#include <stop_token>

#include "bench/judgement/verdict_record.h"
#include "bench/python/bindings.h"
#include "bench/run/experiment.h"
#include "bench/run/replay.h"
#include "bench/session/fit_record.h"
#include "bench/session/json_output.h"
#include "bench/session/measures_record.h"
#include "bench/session/open_session.h"
#include "bench/session/session_comparison.h"

namespace todbench {
namespace {

/// Functions of Python that watch a run. One that returns False or raises stops it.
class Watchers {
 public:
  explicit Watchers(const py::kwargs& given) {
    for (const auto& [name, function] : given) {
      const auto key = name.cast<std::string>();
      bool known = false;
      for (const char* one : {"on_phase", "on_progress", "on_note", "on_frame", "on_trial"})
        known = known || key == one;
      if (!known) throw py::type_error("unexpected keyword argument '" + key + "'");
      if (!function.is_none()) functions_[key] = py::reinterpret_borrow<py::object>(function);
    }
  }

  [[nodiscard]] ExperimentListener listener() {
    ExperimentListener listener;
    listener.on_phase = [this](std::string_view phase) { call("on_phase", phase); };
    listener.on_progress = [this](std::size_t done, std::size_t planned) { call("on_progress", done, planned); };
    listener.on_note = [this](std::string_view sentence) { call("on_note", sentence); };
    listener.on_trial = [this](SessionCurve which, const Trial& trial, const Patch& patch) {
      if (functions_.count("on_trial") == 0) return;
      call("on_trial", which == SessionCurve::main ? "main" : "twin", trial, cv::Mat1d(patch.kelvin.clone()));
    };
    // Without a function it asks for Ctrl-C all the same.
    listener.on_frame = [this](const Frame& frame) { call("on_frame", frame); };
    return listener;
  }
  [[nodiscard]] std::stop_token token() const { return stop_.get_token(); }
  /// Raises what a function raised.
  void raise_pending() const {
    if (raised_) std::rethrow_exception(raised_);
  }

 private:
  template <typename... Arguments>
  void call(const char* name, const Arguments&... arguments) {
    const py::gil_scoped_acquire held;
    if (raised_) return;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      const auto found = functions_.find(name);
      if (found == functions_.end()) return;
      const py::object answer = found->second(arguments...);
      if (answer.is(py::bool_(false))) stop_.request_stop();
    } catch (...) {
      raised_ = std::current_exception();
      stop_.request_stop();
    }
  }

  std::map<std::string, py::object> functions_;
  std::stop_source stop_;
  std::exception_ptr raised_;
};

ExistingFolder existing_from(const std::string& word) {
  if (word == "refuse") return ExistingFolder::refuse;
  if (word == "overwrite") return ExistingFolder::overwrite;
  if (word == "number") return ExistingFolder::number;
  throw RaisedError{
      Error{ErrorCode::invalid_input, "existing: expected 'refuse', 'overwrite' or 'number', found '" + word + "'"}};
}

/// Runs without the lock of Python; a function that raised has priority over the result.
template <typename Run>
auto watched(const py::kwargs& given, const Run& run) {
  Watchers watchers(given);
  const ExperimentListener listener = watchers.listener();
  auto outcome = [&] {
    const py::gil_scoped_release free;
    return run(listener, watchers.token());
  }();
  watchers.raise_pending();
  return take(std::move(outcome));
}

ExperimentOptions options_of(const std::filesystem::path& folder, const std::string& existing) {
  return {.folder = folder, .existing = existing_from(existing)};
}

py::object outcome_dict(const ExperimentOutcome& outcome) {
  Json json = curve_json(outcome.curve, outcome.effects, outcome.figures);
  json["verdict"] = to_string(outcome.verdict.decision);
  json["judgement"] = verdict_json(outcome.verdict);
  return python_of(json);
}

void add_outcome(py::module_& module) {
  // clang-format off
  py::class_<ExperimentOutcome>(module, "Outcome", doc("ExperimentOutcome"))
      .def_readonly("folder", &ExperimentOutcome::folder, "Folder of the session.")
      TODBENCH_READ(ExperimentOutcome, curve)
      TODBENCH_READ(ExperimentOutcome, twin)
      .def_readonly("comparison", &ExperimentOutcome::comparison, "Of camera and twin; None without a twin.")
      TODBENCH_READ(ExperimentOutcome, effects)
      // clang-format on
      .def_property_readonly(
          "verdict", [](const ExperimentOutcome& outcome) { return std::string(to_string(outcome.verdict.decision)); },
          "The decision as a word.")
      .def_property_readonly(
          "judgement", [](const ExperimentOutcome& outcome) { return python_of(verdict_json(outcome.verdict)); },
          doc("verdict_json"))
      .def_property_readonly(
          "measures",
          [](const ExperimentOutcome& outcome) {
            return python_of(measures_json(outcome.measures, outcome.twin_measures));
          },
          "Physical measures of camera and twin, as in measures.json.")
      .def_property_readonly(
          "ended_by",
          [](const ExperimentOutcome& outcome) {
            return outcome.ended_by ? std::optional(outcome.ended_by->message) : std::nullopt;
          },
          doc("ExperimentOutcome::ended_by"))
      .def("to_dict", &outcome_dict, "The curve with the verdict, with the keys of `todbench measure --json`.");
}

void add_run_functions(py::module_& module) {
  module.def(
      "measure",
      [](const Plan& plan, const std::filesystem::path& folder, const std::string& existing, const py::kwargs& watch) {
        const ExperimentOptions options = options_of(folder, existing);
        return watched(watch, [&](const ExperimentListener& listener, const std::stop_token& stop) {
          return measure_plan(plan, options, listener, stop);
        });
      },
      py::arg("plan"), py::arg("folder"), py::arg("existing") = "refuse",
      "Measures with the devices of the plan, simulates its twin and compares, into a session folder. `existing` is "
      "what\n"
      "to do with a folder that is not empty: 'refuse', 'overwrite' or 'number'. Functions that watch: "
      "on_phase(phase),\n"
      "on_progress(done, planned), on_note(sentence), on_frame(frame), on_trial(curve, trial, patch). One that "
      "returns\n"
      "False stops the run; one that raises stops it too, and its exception is raised here. They are called from the\n"
      "thread of this call, which releases the lock of Python in between.");
  module.def(
      "simulate",
      [](const Plan& plan, const std::filesystem::path& folder, const std::string& existing, const py::kwargs& watch) {
        const ExperimentOptions options = options_of(folder, existing);
        return watched(watch, [&](const ExperimentListener& listener, const std::stop_token& stop) {
          return simulate_plan(plan, options, listener, stop);
        });
      },
      py::arg("plan"), py::arg("folder"), py::arg("existing") = "refuse",
      "As measure(), with the simulated sensor in place of the camera.");
  module.def(
      "replay",
      [](const std::filesystem::path& session, const std::filesystem::path& folder, const std::string& existing,
         const py::kwargs& watch) {
        const ExperimentOptions options = options_of(folder, existing);
        auto outcome = watched(watch, [&](const ExperimentListener& listener, const std::stop_token& stop) {
          return replay_session(session, options, listener, stop);
        });
        return py::make_tuple(std::move(outcome.run), outcome.same_trials, outcome.same_fits);
      },
      py::arg("session"), py::arg("folder"), py::arg("existing") = "refuse",
      "Measures again from the recorded frames of a session: (outcome, same_trials, same_fits).");
}

void add_session(py::module_& module) {
  // clang-format off
  py::class_<Session>(module, "Session", "A session as values.")
      .def_readonly("plan", &Session::plan, "Plan of the session.")
      TODBENCH_READ(Session, trials)
      .def_readonly("twin_trials", &Session::twin_trials, "Trials of the twin.")
      TODBENCH_READ(Session, curve)
      .def_readonly("twin", &Session::twin, "Curve of the twin; None: there is none.")
      .def_readonly("comparison", &Session::comparison, "Of curve and twin; None: there is none.")
      TODBENCH_READ(Session, accepted_changes)
      TODBENCH_READ(Session, cut_off)
      // clang-format on
      .def_property_readonly("complete", &Session::complete, "Whether the run came to its end.")
      .def_property_readonly(
          "verdict", [](const Session& session) { return std::string(to_string(verdict_of(session).decision)); },
          "The decision as a word.")
      .def_property_readonly(
          "judgement", [](const Session& session) { return python_of(verdict_json(verdict_of(session))); },
          doc("verdict_json"));
  module.def(
      "open_session",
      [](const std::filesystem::path& folder, bool accept_changed, bool accept_cut_off) {
        return take(open_session(folder, {accept_changed, accept_cut_off}));
      },
      py::arg("folder"), py::arg("accept_changed") = false, py::arg("accept_cut_off") = false,
      py::call_guard<py::gil_scoped_release>(), doc("open_session"));
  module.def(
      "compare_sessions",
      [](const Session& a, const Session& b, std::optional<double> margin_percent) {
        return take(compare_sessions(a, b, margin_percent)).comparison;
      },
      py::arg("a"), py::arg("b"), py::arg("margin_percent") = py::none(), py::call_guard<py::gil_scoped_release>(),
      doc("compare_sessions"));
}

}  // namespace

void add_runs(py::module_& module) {
  add_outcome(module);
  add_run_functions(module);
  add_session(module);
}

}  // namespace todbench
