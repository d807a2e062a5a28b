// SPDX-License-Identifier: GPL-3.0-or-later
// Plates and their place in the picture.
#include "bench/plan/descriptions.h"
#include "bench/python/bindings.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/patch_windows.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

void add_registration(py::module_& module) {
  py::class_<Registration>(module, "Registration", doc("Registration"))
      // clang-format off
      TODBENCH_READ(Registration, residual_px)
      .def_readonly("triangles_used", &Registration::triangles_used, "Number of triangles used.")
      TODBENCH_READ(Registration, scale_px_per_mm)
      TODBENCH_READ(Registration, rotation_deg)
      TODBENCH_READ(Registration, scale_deviation)
      TODBENCH_READ(Registration, contrast_sign)
      TODBENCH_READ(Registration, blur_px)
      .def_readonly("mapping", &Registration::mapping, "How general the mapping is.")
          // clang-format on
          .def_property_readonly(
              "plate_to_pixel",
              [](const Registration& found) { return cv::Mat1d(cv::Mat(found.plate_to_pixel).clone()); },
              doc("Registration::plate_to_pixel"))
          .def("pixel", &Registration::pixel, py::arg("plate_mm"), doc("Registration::pixel"))
          .def("scale_at", &Registration::scale_at, py::arg("plate_mm"), doc("Registration::scale_at"))
          .def("shifted", &Registration::shifted, py::arg("shift_mm"), doc("Registration::shifted"))
          .def("moved", &Registration::moved, py::arg("shift_px"), doc("Registration::moved"));
  py::class_<RegistrationOptions>(module, "RegistrationOptions", "Options of register_plate().")
      .def(from_keywords<RegistrationOptions>())
      // clang-format off
      TODBENCH_WRITE(RegistrationOptions, expected_scale_px_per_mm)
      TODBENCH_WRITE(RegistrationOptions, max_scale_deviation)
      TODBENCH_WRITE(RegistrationOptions, max_stretch)
      .def_readwrite("max_rotation_deg", &RegistrationOptions::max_rotation_deg, "Largest rotation of the plate in the picture.")
      TODBENCH_WRITE(RegistrationOptions, max_residual_px)
      TODBENCH_WRITE(RegistrationOptions, min_triangle_px)
      TODBENCH_WRITE(RegistrationOptions, min_triangles);
  // clang-format on
  module.def(
      "register_plate",
      [](const cv::Mat1d& picture, const TargetPlate& plate, const RegistrationOptions& options) {
        return take(register_plate(picture, plate, options));
      },
      py::arg("picture"), py::arg("mounted_plate"), py::arg("options"), py::call_guard<py::gil_scoped_release>(),
      doc("register_plate"));
  py::class_<EffectiveContrast>(module, "EffectiveContrast", doc("EffectiveContrast"))
      // clang-format off
      TODBENCH_READ(EffectiveContrast, value)
      TODBENCH_READ(EffectiveContrast, standard_error)
      .def_readonly("triangles", &EffectiveContrast::triangles, "Number of triangles used.");
  // clang-format on
  module.def(
      "effective_contrast",
      [](const cv::Mat1d& picture, const TargetPlate& plate, const Registration& found, double min_size_px) {
        return take(effective_contrast(picture, plate, found, min_size_px));
      },
      py::arg("picture"), py::arg("mounted_plate"), py::arg("registration"), py::arg("min_size_px"),
      doc("effective_contrast"));
  py::class_<PatchWindow>(module, "PatchWindow", doc("PatchWindow"))
      .def_readonly("pixels", &PatchWindow::pixels, "(x, y, width, height) in the picture.")
      // clang-format off
      TODBENCH_READ(PatchWindow, phase);
  // clang-format on
  module.def("patch_window", &patch_window, py::arg("centroid_px"), py::arg("side"), doc("patch_window"));
}

}  // namespace

void add_plates(py::module_& module) {
  py::class_<PlateTriangle>(module, "PlateTriangle", doc("PlateTriangle"))
      .def(from_keywords<PlateTriangle>())
      // clang-format off
      TODBENCH_WRITE(PlateTriangle, name)
      TODBENCH_WRITE(PlateTriangle, position_mm)
      TODBENCH_WRITE(PlateTriangle, size_mm)
      .def_readwrite("apex", &PlateTriangle::apex, doc("Apex"));
  py::class_<TargetPlate>(module, "TargetPlate", doc("TargetPlate"))
      .def(from_keywords<TargetPlate>())
      .def_readwrite("name", &TargetPlate::name, "Name of the plate.")
      .def_readwrite("description", &TargetPlate::description, "Sentence about the plate.")
      .def_readwrite("width_mm", &TargetPlate::width_mm, "Width of the plate.")
      .def_readwrite("height_mm", &TargetPlate::height_mm, "Height of the plate.")
      .def_readwrite("triangles", &TargetPlate::triangles, "Triangles of the plate.")
      TODBENCH_READ(TargetPlate, mounting)
      // clang-format on
      .def(
          "mounted", [](const TargetPlate& plate, Mounting mounting) { return mounted(plate, mounting); },
          py::arg("mounting"), "The plate as the camera sees it in a mounting: places and apexes transformed.")
      .def(
          "validate", [](const TargetPlate& plate) { take(validate(plate)); },
          "Raises todbench.Error for an impossible plate.");
  module.def(
      "load_plate", [](const std::string& reference) { return take(load_plate(reference)); }, py::arg("reference"),
      doc("load_plate"));
  add_registration(module);
}

}  // namespace todbench
