// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/python/laboratory.h"

#include "bench/devices/emulation.h"
#include "bench/python/bindings.h"

namespace todbench {

#ifdef TODBENCH_WITH_ARAVIS
void add_laboratory(py::module_& module) {
  py::class_<Laboratory>(module, "Laboratory", doc("Laboratory"))
      .def(py::init([](const Plan& plan, const std::string& camera) {
             EmulationArguments emulation = emulation_for(plan);
             emulation.camera = camera;
             const py::gil_scoped_release free;
             return take(start_laboratory(emulation));
           }),
           py::arg("plan"), py::arg("camera") = "gige",
           "Starts camera, black body and plate stage for the sensor, plates and distance of a plan. Cameras other "
           "than\n"
           "'gige' may need emulated device nodes, which only the program `todbench` sets up.")
      .def_property_readonly("camera_id", &Laboratory::camera_id, doc("Laboratory::camera_id"))
      .def_property_readonly("black_body", &Laboratory::black_body_endpoint, doc("Laboratory::black_body_endpoint"))
      .def_property_readonly("stage", &Laboratory::stage_endpoint, "Address and port of the plate stage.")
      .def_property_readonly("scene", &Laboratory::scene, doc("Laboratory::scene"))
      .def(
          "plan", [](const Laboratory& laboratory, const Plan& plan) { return with_laboratory(plan, laboratory); },
          py::arg("plan"), doc("with_laboratory"));
}
#else
/// This build has no camera libraries: constructing one says so.
class MissingLaboratory {};

void add_laboratory(py::module_& module) {
  py::class_<MissingLaboratory>(module, "Laboratory", "The emulated laboratory, which this build does not have.")
      .def(py::init([](const py::args&, const py::kwargs&) -> std::unique_ptr<MissingLaboratory> {
        throw RaisedError{
            Error{ErrorCode::not_found, "this build has no camera libraries for the emulated laboratory"}};
      }));
}
#endif

}  // namespace todbench
