// SPDX-License-Identifier: GPL-3.0-or-later
// Frames and their sources: cameras, recordings, simulated sensors, the emulated laboratory.
#include <chrono>

#include "acquisition/core/camera_registry.h"
#include "bench/devices/devices.h"
#include "bench/python/bindings.h"
#include "bench/python/laboratory.h"
#include "sim_devices/sensor/simulated_camera.h"

namespace todbench {
namespace {

/// A source with the back ends that opened it.
struct OpenCamera {
  CameraRegistry registry;
  std::unique_ptr<FrameSource> source;
};

/// Waits in steps, so that Ctrl-C is heard.
Result<Frame> next_frame(OpenCamera& camera, double timeout_s) {
  using std::chrono::milliseconds;
  constexpr milliseconds step{200};
  auto left = milliseconds(static_cast<std::int64_t>(1000 * timeout_s));
  for (;;) {
    const milliseconds now = std::min(left, step);
    Result<Frame> frame = [&] {
      const py::gil_scoped_release free;
      return camera.source->next(now);
    }();
    left -= now;
    if (frame || frame.error().code != ErrorCode::timeout || left <= milliseconds{0}) return frame;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

/// The next frame of an iteration; a recording ends.
Frame iterate(OpenCamera& camera) {
  constexpr double patience_s = 10;
  auto frame = next_frame(camera, patience_s);
  if (!frame && frame.error().code == ErrorCode::disconnected && camera.source->info().transport == "recording")
    throw py::stop_iteration();
  return take(std::move(frame));
}

void add_frame(py::module_& module) {
  // clang-format off
  py::class_<Frame>(module, "Frame", doc("Frame"))
      .def_property_readonly("counts", [](const Frame& frame) { return array_of(frame.counts); },
                             "The counts as the camera sent them, row by row from the top, without a copy; read only.")
      TODBENCH_READ(Frame, sequence)
      TODBENCH_READ(Frame, device_time_ns)
      TODBENCH_READ(Frame, host_time_ns)
      .def_readonly("status", &Frame::status, doc("FrameStatus"))
      TODBENCH_READ(Frame, since_correction_s)
      TODBENCH_READ(Frame, significant_bits)
      // clang-format on
      .def_property_readonly(
          "calibrated", [](const Frame& frame) { return frame.scale->calibrated(); },
          "Whether the counts have a temperature.")
      .def(
          "to_kelvin", [](const Frame& frame) { return take(to_kelvin(frame)); },
          py::call_guard<py::gil_scoped_release>(), doc("to_kelvin"));
  // clang-format off
  py::class_<SourceInfo>(module, "SourceInfo", doc("SourceInfo"))
      TODBENCH_READ(SourceInfo, id)
      .def_readonly("vendor", &SourceInfo::vendor, "Vendor of the camera.")
      .def_readonly("model", &SourceInfo::model, "Model of the camera.")
      .def_readonly("serial", &SourceInfo::serial, "Serial number.")
      .def_readonly("firmware", &SourceInfo::firmware, "Version of the firmware.")
      TODBENCH_READ(SourceInfo, transport)
      .def_readonly("width", &SourceInfo::width, "Columns of a frame.")
      .def_readonly("height", &SourceInfo::height, "Rows of a frame.")
      TODBENCH_READ(SourceInfo, pixel_format)
      .def_readonly("significant_bits", &SourceInfo::significant_bits, doc("Frame::significant_bits"))
      TODBENCH_READ(SourceInfo, frame_rate_hz)
      TODBENCH_READ(SourceInfo, settings)
      TODBENCH_READ(SourceInfo, warnings)
      // clang-format on
      .def_property_readonly(
          "scale", [](const SourceInfo& info) { return info.scale.describe(); }, doc("RadiometricScale::describe"));
}

void add_source(py::module_& module) {
  py::class_<OpenCamera>(module, "Camera", doc("FrameSource"))
      .def_property_readonly(
          "info", [](const OpenCamera& camera) { return camera.source->info(); }, doc("SourceInfo"))
      .def(
          "start", [](OpenCamera& camera) { take(camera.source->start()); }, py::call_guard<py::gil_scoped_release>(),
          doc("FrameSource::start"))
      .def(
          "next", [](OpenCamera& camera, double timeout_s) { return take(next_frame(camera, timeout_s)); },
          py::arg("timeout_s") = 10.0, doc("FrameSource::next"))
      .def(
          "stop", [](OpenCamera& camera) { camera.source->stop(); }, py::call_guard<py::gil_scoped_release>(),
          doc("FrameSource::stop"))
      .def(
          "get", [](OpenCamera& camera, const std::string& feature) { return take(camera.source->get(feature)); },
          py::arg("feature"), py::call_guard<py::gil_scoped_release>(), doc("FrameSource::get"))
      .def(
          "set",
          [](OpenCamera& camera, const std::string& feature, const std::string& value) {
            take(camera.source->set(feature, value));
          },
          py::arg("feature"), py::arg("value"), py::call_guard<py::gil_scoped_release>(),
          "Writes one feature by its SFNC (or vendor) name, value as text.")
      .def(
          "correct_nonuniformity", [](OpenCamera& camera) { take(camera.source->correct_nonuniformity()); },
          py::call_guard<py::gil_scoped_release>(), doc("FrameSource::correct_nonuniformity"))
      .def(
          "__iter__",
          [](OpenCamera& camera) -> OpenCamera& {
            const py::gil_scoped_release free;
            take(camera.source->start());
            return camera;
          },
          py::return_value_policy::reference_internal, "Starts the camera.")
      .def("__next__", &iterate, "The next frame; a recording ends the iteration.")
      .def(
          "__enter__", [](OpenCamera& camera) -> OpenCamera& { return camera; },
          py::return_value_policy::reference_internal, "The camera itself.")
      .def(
          "__exit__",
          [](OpenCamera& camera, const py::args& /*reason*/) {
            const py::gil_scoped_release free;
            camera.source->stop();
          },
          "Stops the camera.");
  module.def(
      "open_camera",
      [](const std::string& id) {
        OpenCamera camera{camera_registry(), nullptr};
        camera.source = take(camera.registry.open(id));
        return std::make_unique<OpenCamera>(std::move(camera));
      },
      py::arg("id"), py::call_guard<py::gil_scoped_release>(),
      "Opens a camera by identity ('gige:VENDOR-SERIAL', 'sim:sc2000') or a recording ('file:PATH'). Raises "
      "`not_found`\n"
      "if it is absent or busy, `invalid_input` for an id without a known scheme.");
  py::class_<CameraEntry>(module, "CameraEntry", doc("CameraEntry"))
      // clang-format off
      TODBENCH_READ(CameraEntry, id)
      .def_readonly("vendor", &CameraEntry::vendor, "Vendor of the camera.")
      .def_readonly("model", &CameraEntry::model, "Model of the camera.")
      .def_readonly("serial", &CameraEntry::serial, "Serial number.")
      .def_readonly("transport", &CameraEntry::transport, "Kind of connection.")
      TODBENCH_READ(CameraEntry, address)
      TODBENCH_READ(CameraEntry, note);
  // clang-format on
  module.def(
      "cameras",
      [] {
        auto listing = camera_registry().list();
        return std::pair(std::move(listing.cameras), std::move(listing.warnings));
      },
      py::call_guard<py::gil_scoped_release>(),
      "Cameras that can be opened now, and warnings of back ends that failed.");
}

void add_simulated(py::module_& module) {
  py::class_<SceneHolder, std::shared_ptr<SceneHolder>>(module, "SceneHolder", doc("SceneHolder"))
      .def(py::init<PlateScene>(), py::arg("scene"), "A camera's view, with this scene.")
      .def_property_readonly(
          "scene", [](const SceneHolder& holder) { return *holder.scene(); }, "The present scene.")
      .def("set", &SceneHolder::set, py::arg("scene"), doc("SceneHolder::set"));
  module.def(
      "simulated_camera",
      [](const std::shared_ptr<SensorModel>& model, const std::shared_ptr<SceneHolder>& scene,
         const std::string& serial) {
        return std::make_unique<OpenCamera>(OpenCamera{CameraRegistry{}, simulated_source(model, scene, serial)});
      },
      py::arg("model"), py::arg("scene"), py::arg("serial") = "1",
      "Camera without delay: frame k is model.expose(scene.scene, k).");
}

}  // namespace

void add_cameras(py::module_& module) {
  add_frame(module);
  add_source(module);
  add_simulated(module);
  add_laboratory(module);
}

}  // namespace todbench
