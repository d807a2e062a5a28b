// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated sensors: description, planned effects, frames, direct estimate.
#include "bench/plan/descriptions.h"
#include "bench/python/bindings.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/prediction/effect_planner.h"
#include "sim_devices/sensor/sensor_model.h"

namespace todbench {
namespace {

py::class_<SensorSpec> sensor_spec(py::module_& module) {
  return py::class_<SensorSpec>(module, "SensorSpec", doc("SensorSpec"))
      .def(from_keywords<SensorSpec>())
      // clang-format off
      .def_readwrite("name", &SensorSpec::name, "Name of the sensor.")
      .def_readwrite("description", &SensorSpec::description, "Sentence about the sensor.")
      .def_readwrite("width", &SensorSpec::width, "Detectors in a row.")
      .def_readwrite("height", &SensorSpec::height, "Detectors in a column.")
      TODBENCH_WRITE(SensorSpec, pitch_um)
      TODBENCH_WRITE(SensorSpec, pitch_y_um)
      TODBENCH_WRITE(SensorSpec, detector_um)
      TODBENCH_WRITE(SensorSpec, detector_y_um)
      .def_readwrite("focal_length_mm", &SensorSpec::focal_length_mm, "Focal length of the lens.")
      .def_readwrite("f_number", &SensorSpec::f_number, "Focal length over diameter of the pupil.")
      .def_readwrite("wavelength_min_um", &SensorSpec::wavelength_min_um, "Lower end of the spectral band.")
      .def_readwrite("wavelength_max_um", &SensorSpec::wavelength_max_um, "Upper end of the spectral band.")
      TODBENCH_WRITE(SensorSpec, turbulence_cn2_m_minus_2_3)
      TODBENCH_WRITE(SensorSpec, turbulence_path_m)
      TODBENCH_WRITE(SensorSpec, turbulence_correlation_ms)
      TODBENCH_WRITE(SensorSpec, optics_transmission)
      TODBENCH_WRITE(SensorSpec, aberration_sigma_pitch)
      TODBENCH_WRITE(SensorSpec, halo_share)
      TODBENCH_WRITE(SensorSpec, halo_sigma_pitch)
      TODBENCH_WRITE(SensorSpec, distortion_percent)
      TODBENCH_WRITE(SensorSpec, distortion_r4_percent)
      TODBENCH_WRITE(SensorSpec, netd_k)
      TODBENCH_WRITE(SensorSpec, noise_correlation)
      TODBENCH_WRITE(SensorSpec, fixed_pattern_k)
      TODBENCH_WRITE(SensorSpec, time_constant_ms)
      TODBENCH_WRITE(SensorSpec, exposure_ms)
      TODBENCH_WRITE(SensorSpec, row_time_us)
      TODBENCH_WRITE(SensorSpec, field_delay_ms)
      TODBENCH_WRITE(SensorSpec, row_noise_k)
      TODBENCH_WRITE(SensorSpec, column_noise_k)
      TODBENCH_WRITE(SensorSpec, dead_pixel_share)
      TODBENCH_WRITE(SensorSpec, defective_pixel_share)
      TODBENCH_WRITE(SensorSpec, defect_seed)
      TODBENCH_WRITE(SensorSpec, frames_averaged)
      TODBENCH_WRITE(SensorSpec, super_resolution_frames)
      TODBENCH_WRITE(SensorSpec, display_blur_samples)
      TODBENCH_WRITE(SensorSpec, edge_boost)
      TODBENCH_WRITE(SensorSpec, microscan)
      TODBENCH_WRITE(SensorSpec, bits)
      TODBENCH_WRITE(SensorSpec, kelvin_per_count)
      TODBENCH_WRITE(SensorSpec, offset_k)
      .def_readwrite("frame_rate_hz", &SensorSpec::frame_rate_hz, "Frames per second.")
      TODBENCH_WRITE(SensorSpec, scene_temperature_k)
      // clang-format on
      .def_property_readonly(
          "ifov_mrad", [](const SensorSpec& spec) { return spec.ifov_mrad(); }, "Angle of a detector pitch along x.")
      .def_property_readonly(
          "ifov_y_mrad", [](const SensorSpec& spec) { return spec.ifov_mrad(PitchAxis::y); },
          "Angle of a detector pitch along y.")
      .def_property_readonly("samples_per_pitch", &SensorSpec::samples_per_pitch, doc("SensorSpec::samples_per_pitch"))
      .def(
          "validate", [](const SensorSpec& spec) { take(validate(spec)); },
          "Raises todbench.Error, one sentence, for an impossible sensor.");
}

void add_effects(py::module_& module) {
  py::class_<EffectDecision>(module, "EffectDecision", "Decision about one effect of the sensor chain.")
      .def_readonly("effect", &EffectDecision::effect, doc("Effect"))
      .def_property_readonly(
          "simulated", [](const EffectDecision& one) { return one.decision == Decision::simulate; },
          "Whether the effect is simulated.")
      // clang-format off
      TODBENCH_READ(EffectDecision, reason)
      TODBENCH_READ(EffectDecision, predicted_change_percent);
  py::class_<SensorPlan>(module, "SensorPlan", doc("SensorPlan"))
      .def_readonly("decisions", &SensorPlan::decisions, "One decision for each effect, in the order of the chain.")
      .def("simulates", &SensorPlan::simulates, py::arg("effect"), "Whether the effect is simulated.");
  module.def("full_plan", [](const SensorSpec& spec, const std::vector<Effect>& skip,
                             const std::vector<Effect>& force) { return full_plan(spec, skip, force); },
             py::arg("spec"), py::arg("skip") = std::vector<Effect>{}, py::arg("force") = std::vector<Effect>{},
             doc("full_plan"));
  py::class_<ContrastOutlook>(module, "ContrastOutlook", doc("ContrastOutlook"))
      .def_readonly("delta_t_k", &ContrastOutlook::delta_t_k, "Contrast in kelvin.")
      TODBENCH_READ(ContrastOutlook, q_eff)
      TODBENCH_READ(ContrastOutlook, s75_pitch)
      TODBENCH_READ(ContrastOutlook, noise_exponent)
      TODBENCH_READ(ContrastOutlook, blur_exponent)
      TODBENCH_READ(ContrastOutlook, observer_variance)
      TODBENCH_READ(ContrastOutlook, weibull_slope);
  py::class_<EffectPlan>(module, "EffectPlan", "Effects that a scene needs, with their predicted changes.")
      TODBENCH_READ(EffectPlan, plan)
      TODBENCH_READ(EffectPlan, skipped_change_percent)
      TODBENCH_READ(EffectPlan, requested_change_percent)
      TODBENCH_READ(EffectPlan, outlooks)
      TODBENCH_READ(EffectPlan, warnings);
  // clang-format on
  module.def(
      "plan_effects",
      [](const SensorSpec& spec, TemplateObserver& observer, std::vector<double> delta_t_k, double tolerance_percent,
         std::vector<Effect> skip, std::vector<Effect> force) {
        take(validate(spec));
        return take(plan_effects(spec, observer, {std::move(delta_t_k)},
                                 {tolerance_percent, std::move(skip), std::move(force)}));
      },
      py::arg("spec"), py::arg("observer"), py::arg("delta_t_k"), py::arg("tolerance_percent") = 1.0,
      py::arg("skip") = std::vector<Effect>{}, py::arg("force") = std::vector<Effect>{},
      py::call_guard<py::gil_scoped_release>(), doc("plan_effects"));
}

void add_scene(py::module_& module) {
  py::class_<PlateScene>(module, "PlateScene", doc("PlateScene"))
      .def(from_keywords<PlateScene>())
      // clang-format off
      TODBENCH_WRITE(PlateScene, plate)
      TODBENCH_WRITE(PlateScene, delta_t_k)
      TODBENCH_WRITE(PlateScene, background_k)
      .def_readwrite("distance_m", &PlateScene::distance_m, "From the camera to the plate.")
      TODBENCH_WRITE(PlateScene, shift_mm)
      TODBENCH_WRITE(PlateScene, centre_px)
      TODBENCH_WRITE(PlateScene, rotation_deg);
  // clang-format on
  module.def(
      "scene_pixel",
      [](const PlateScene& scene, cv::Point2d plate_mm, double ifov_mrad, int width, int height) {
        return scene_pixel(scene, plate_mm, ifov_mrad, cv::Size(width, height));
      },
      py::arg("scene"), py::arg("plate_mm"), py::arg("ifov_mrad"), py::arg("width"), py::arg("height"),
      doc("scene_pixel"));
}

void add_model(py::module_& module) {
  py::class_<SensorModel, std::shared_ptr<SensorModel>>(module, "SensorModel", doc("SensorModel"))
      .def(py::init([](const SensorSpec& spec, const std::optional<SensorPlan>& plan, const std::string& accuracy,
                       std::uint64_t seed) {
             take(validate(spec));
             return std::make_shared<SensorModel>(spec, plan ? *plan : full_plan(spec, {}, {}),
                                                  take(Accuracy::named(accuracy)), seed);
           }),
           py::arg("spec"), py::arg("plan") = py::none(), py::arg("accuracy") = "normal", py::arg("seed") = 1,
           "A sensor with the effects of `plan` (all that are not neutral if None) at a named accuracy.")
      .def_property_readonly("spec", &SensorModel::spec, doc("SensorModel::spec"))
      .def_property_readonly("plan", &SensorModel::plan, "Effects that the sensor shows.")
      .def_property_readonly("seed", &SensorModel::seed, "Seed of all noise.")
      .def_property_readonly(
          "shape", [](const SensorModel& model) { return py::make_tuple(model.size().height, model.size().width); },
          doc("SensorModel::size"))
      .def(
          "expose",
          [](const SensorModel& model, const PlateScene& scene, std::uint64_t index) {
            return model.expose(scene, index);
          },
          py::arg("scene"), py::arg("index"), py::call_guard<py::gil_scoped_release>(), doc("SensorModel::expose"))
      .def(
          "picture",
          [](const SensorModel& model, const PlateScene& scene, std::uint64_t index) {
            return model.picture(scene, index);
          },
          py::arg("scene"), py::arg("index"), py::call_guard<py::gil_scoped_release>(), doc("SensorModel::picture"))
      .def(
          "unit_signal", [](const SensorModel& model, const PlateScene& scene) { return *model.unit_signal(scene); },
          py::arg("scene"), py::call_guard<py::gil_scoped_release>(), doc("SensorModel::unit_signal"));
}

void add_direct_estimate(py::module_& module) {
  py::class_<DirectPoint>(module, "DirectPoint", "Size at 75 % of one contrast, without trials.")
      // clang-format off
      .def_readonly("delta_t_k", &DirectPoint::delta_t_k, "Contrast in kelvin.")
      TODBENCH_READ(DirectPoint, seen_delta_t_k)
      TODBENCH_READ(DirectPoint, s75_pitch)
      .def_readonly("standard_error_pitch", &DirectPoint::standard_error_pitch, "Standard error of s75_pitch.")
      TODBENCH_READ(DirectPoint, noise_draws)
      // clang-format on
      .def_property_readonly(
          "sizes_pitch", [](const DirectPoint& point) { return array_of(point.sizes_pitch); },
          "Sizes of the function, in detector pitches.")
      .def_property_readonly(
          "proportion_correct", [](const DirectPoint& point) { return array_of(point.proportion_correct); },
          "Proportion of correct answers at each size.");
  module.def(
      "direct_estimate",
      [](const SensorSpec& spec, TemplateObserver& observer, const std::vector<double>& delta_t_k,
         const std::optional<SensorPlan>& plan, const std::string& accuracy, std::uint64_t seed) {
        take(validate(spec));
        DirectEstimateOptions options;
        options.accuracy = take(Accuracy::named(accuracy));
        options.seed = seed;
        return take(direct_estimate(spec, plan ? *plan : full_plan(spec, {}, {}), observer, delta_t_k, options));
      },
      py::arg("spec"), py::arg("observer"), py::arg("delta_t_k"), py::arg("plan") = py::none(),
      py::arg("accuracy") = "normal", py::arg("seed") = 1, py::call_guard<py::gil_scoped_release>(),
      doc("direct_estimate"));
}

}  // namespace

void add_sensors(py::module_& module) {
  sensor_spec(module);
  module.def(
      "load_sensor", [](const std::string& reference) { return take(load_sensor(reference)); }, py::arg("reference"),
      doc("load_sensor"));
  add_effects(module);
  add_scene(module);
  add_model(module);
  add_direct_estimate(module);
}

}  // namespace todbench
