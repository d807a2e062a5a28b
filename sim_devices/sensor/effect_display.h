// SPDX-License-Identifier: GPL-3.0-or-later
// Edge filter of the camera, and reconstruction and blur of the display, as one filter on samples.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the taps -8 ... 8 of the symmetric filter whose response at f cycles per sample is `response`(f). A tap is
/// an integral over |f| <= 1/2; the taps are normalised to sum 1.
[[nodiscard]] std::vector<double> taps_of(const std::function<double(double)>& response);

/// Returns the response of edge filter and display along one axis, (1 + 4 b sin^2(pi f)) exp(-2 pi^2 s^2 f^2) with b =
/// edge_boost and s = display_blur_samples; times sinc(f) if bilinear. Observers assume the sample-and-hold.
[[nodiscard]] double display_response(const SensorSpec& spec, double f_per_sample);
/// Returns whether the display differs from sample-and-hold, or the camera boosts edges.
[[nodiscard]] bool has_display(const SensorSpec& spec);

/// Returns the standard deviation, after the display, of white noise that has standard deviation 1 before it.
[[nodiscard]] double display_noise_gain(const SensorSpec& spec);

/// Filters rows and columns with the taps. The picture is mirrored at its edges, so pixels closer to an edge than half
/// the taps depend on where the picture is cut.
[[nodiscard]] cv::Mat1f filtered(const cv::Mat1f& picture, const std::vector<double>& taps);

}  // namespace todbench
