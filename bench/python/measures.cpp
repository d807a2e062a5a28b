// SPDX-License-Identifier: GPL-3.0-or-later
// Physical measures: noise, slanted edge, signal transfer.
#include "acquisition/recording/picture_file.h"
#include "bench/python/bindings.h"
#include "tod/measures/pixel_noise.h"
#include "tod/measures/signal_transfer.h"
#include "tod/measures/slanted_edge.h"
#include "tod/measures/temporal_noise.h"
#include "tod/measures/three_d_noise.h"

namespace todbench {
namespace {

TemporalNoise temporal_noise_of(const py::sequence& frames, const std::optional<std::vector<std::uint64_t>>& sequence,
                                const std::optional<std::vector<int>>& segment) {
  const auto given = given_pictures<float>(frames);
  std::vector<TimedPicture> pictures;
  for (std::size_t i = 0; i < given.pictures.size(); ++i) {
    pictures.push_back({given.pictures[i], sequence && i < sequence->size() ? (*sequence)[i] : i,
                        segment && i < segment->size() ? (*segment)[i] : 0});
  }
  const py::gil_scoped_release free;
  return take(temporal_noise(pictures));
}

py::dict noise_components_of(const py::sequence& frames) {
  const auto given = given_pictures<double>(frames);
  NoiseTable table;
  {
    const py::gil_scoped_release free;
    NoiseCube cube;
    for (const cv::Mat1d& picture : given.pictures) take(cube.add(picture));
    table = take(cube.table());
  }
  py::dict found;
  for (const NoiseComponent component : noise_components)
    found[py::str(std::string(to_string(component)))] = estimate_of(table, component);
  return found;
}

void add_noise(py::module_& module) {
  // clang-format off
  py::class_<TemporalNoise>(module, "TemporalNoise", "Temporal noise of a sequence, in the unit of the pictures.")
      TODBENCH_READ(TemporalNoise, successive)
      .def_property_readonly("lags", [](const TemporalNoise& noise) { return array_of(noise.lags); },
                             "Lags of the structure function, in exposures.")
      .def_property_readonly("structure", [](const TemporalNoise& noise) { return array_of(noise.structure); },
                             doc("TemporalNoise::lags"))
      TODBENCH_READ(TemporalNoise, whole_to_successive)
      TODBENCH_READ(TemporalNoise, lag1_correlation)
      TODBENCH_READ(TemporalNoise, usable)
      TODBENCH_READ(TemporalNoise, usable_share);
  module.def("temporal_noise", &temporal_noise_of, py::arg("frames"), py::arg("sequence") = py::none(),
             py::arg("segment") = py::none(), doc("temporal_noise"));
  py::class_<ComponentEstimate>(module, "ComponentEstimate", doc("ComponentEstimate"))
      TODBENCH_READ(ComponentEstimate, variance)
      .def_property_readonly("ci95", [](const ComponentEstimate& e) { return py::make_tuple(e.low, e.high); },
                             doc("ComponentEstimate::low"))
      TODBENCH_READ(ComponentEstimate, p_absent);
  module.def("noise_components", &noise_components_of, py::arg("frames"),
             "Variances of t, v, h, tv, th, vh and tvh by name (D'Agostino and Webb 1991), signed and unbiased, of frames\n"
             "without corrections between them.");
  py::class_<PixelNoise>(module, "PixelNoise", doc("PixelNoise"))
      .def_readonly("frames", &PixelNoise::frames, "Number of frames.")
      TODBENCH_READ(PixelNoise, sd_rms)
      TODBENCH_READ(PixelNoise, sd_rms_ci95)
      TODBENCH_READ(PixelNoise, sd_rms_detrended)
      TODBENCH_READ(PixelNoise, sd_frame_differences)
      TODBENCH_READ(PixelNoise, mean_of_pixel_sd)
      TODBENCH_READ(PixelNoise, c4)
      TODBENCH_READ(PixelNoise, mean_of_pixel_sd_corrected)
      TODBENCH_READ(PixelNoise, median_pixel_sd)
      TODBENCH_READ(PixelNoise, fixed_pattern_variance)
      TODBENCH_READ(PixelNoise, pixel_sd)
      TODBENCH_READ(PixelNoise, mean_frame);
  // clang-format on
  module.def(
      "pixel_noise",
      [](const py::sequence& frames) {
        const auto given = given_pictures<double>(frames);
        const py::gil_scoped_release free;
        return take(pixel_noise(given.pictures));
      },
      py::arg("frames"), doc("pixel_noise"));
}

void add_edge(py::module_& module) {
  // clang-format off
  py::class_<SlantedEdge>(module, "SlantedEdge", doc("SlantedEdge"))
      .def_readonly("axis", &SlantedEdge::axis, doc("EdgeAxis"))
      TODBENCH_READ(SlantedEdge, angle_deg)
      TODBENCH_READ(SlantedEdge, edge_at_pitch)
      TODBENCH_READ(SlantedEdge, curvature_pitch)
      TODBENCH_READ(SlantedEdge, step)
      TODBENCH_READ(SlantedEdge, noise_over_step)
      TODBENCH_READ(SlantedEdge, shading_percent)
      TODBENCH_READ(SlantedEdge, window_pitch)
      TODBENCH_READ(SlantedEdge, rows)
      TODBENCH_READ(SlantedEdge, widest_halo_pitch)
      TODBENCH_READ(SlantedEdge, halo_allowance)
      TODBENCH_READ(SlantedEdge, wide_halo_least)
      TODBENCH_READ(SlantedEdge, wide_halo_most)
      TODBENCH_READ(SlantedEdge, sharpened)
      TODBENCH_READ(SlantedEdge, mtf50_per_pitch)
      TODBENCH_READ(SlantedEdge, notes)
      // clang-format on
      .def_property_readonly(
          "frequency_per_pitch", [](const SlantedEdge& edge) { return array_of(edge.frequency_per_pitch); },
          doc("SlantedEdge::frequency_per_pitch"))
      .def_property_readonly(
          "mtf", [](const SlantedEdge& edge) { return array_of(edge.mtf); }, doc("SlantedEdge::mtf"))
      .def_property_readonly(
          "mtf_low", [](const SlantedEdge& edge) { return array_of(edge.mtf_low); },
          "Lower ends of the 95 % intervals; see low_known.")
      .def_property_readonly(
          "mtf_low_in_picture", [](const SlantedEdge& edge) { return array_of(edge.mtf_low_in_picture); },
          doc("SlantedEdge::mtf_low_in_picture"))
      .def_property_readonly(
          "mtf_high", [](const SlantedEdge& edge) { return array_of(edge.mtf_high); },
          "Upper ends of the 95 % intervals.")
      .def_readonly("low_known", &SlantedEdge::low_known, doc("SlantedEdge::low_known"));
  module.def(
      "slanted_edge",
      [](const cv::Mat1d& picture, std::optional<EdgeAxis> axis) {
        SlantedEdgeOptions options;
        options.axis = axis;
        return take(slanted_edge(picture, options));
      },
      py::arg("picture"), py::arg("axis") = py::none(), py::call_guard<py::gil_scoped_release>(), doc("slanted_edge"));
  module.def(
      "read_picture", [](const std::filesystem::path& path) { return take(read_picture(path)).picture; },
      py::arg("path"), py::call_guard<py::gil_scoped_release>(), doc("read_picture"));
}

void add_transfer(py::module_& module) {
  // clang-format off
  py::class_<SignalTransfer>(module, "SignalTransfer", doc("SignalTransfer"))
      TODBENCH_READ(SignalTransfer, slope)
      TODBENCH_READ(SignalTransfer, offset)
      TODBENCH_READ(SignalTransfer, slope_u)
      TODBENCH_READ(SignalTransfer, slope_u_stated)
      TODBENCH_READ(SignalTransfer, slope_u_scatter)
      TODBENCH_READ(SignalTransfer, chi2)
      .def_readonly("degrees_of_freedom", &SignalTransfer::degrees_of_freedom, "Degrees of freedom of chi2.")
      TODBENCH_READ(SignalTransfer, p)
      TODBENCH_READ(SignalTransfer, largest_residual)
      TODBENCH_READ(SignalTransfer, nonlinearity_percent)
      TODBENCH_READ(SignalTransfer, r_squared)
              // clang-format on
              .def_property_readonly(
                  "residuals", [](const SignalTransfer& line) { return array_of(line.residuals); },
                  doc("SignalTransfer::residuals"));
  module.def(
      "signal_transfer",
      [](const std::vector<double>& delta_t_k, const std::vector<double>& signal,
         const std::optional<std::vector<double>>& signal_u) {
        if (signal.size() != delta_t_k.size() || (signal_u && signal_u->size() != signal.size())) {
          throw RaisedError{Error{ErrorCode::invalid_input, "delta_t_k, signal and signal_u: expected equal lengths"}};
        }
        std::vector<TemperatureStep> steps(signal.size());
        for (std::size_t i = 0; i < steps.size(); ++i) {
          steps[i] = {delta_t_k[i], signal[i]};
          if (signal_u) steps[i].signal_u = (*signal_u)[i];
        }
        return take(signal_transfer(steps));
      },
      py::arg("delta_t_k"), py::arg("signal"), py::arg("signal_u") = py::none(), doc("signal_transfer"));
}

}  // namespace

void add_measures(py::module_& module) {
  add_noise(module);
  add_edge(module);
  add_transfer(module);
}

}  // namespace todbench
