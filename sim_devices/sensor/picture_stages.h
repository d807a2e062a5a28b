// The stages of the sensor chain that work on pictures of samples: line noise, dead pixels, display. Each is a free
// function that leaves the picture as it is, bit for bit, at its neutral value.
#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/core/rng.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// The sub-exposure of a microscan cycle in which a sample is taken, and its detector: sample = detector * n + phase.
/// Adds the offsets of rows and columns to a picture with `samples_per_pitch` samples per detector; every sub-exposure
/// has its own. `weight` multiplies them (averaging over exposures).
void add_line_noise(cv::Mat1f& picture, const SensorSpec& spec, const RandomStream& rows, const RandomStream& columns,
                    double weight);

/// Which detectors are dead, a byte each, at the share of the sensor; the same numbers for every share.
[[nodiscard]] cv::Mat1b dead_detectors(cv::Size detectors, double share, const RandomStream& stream);

/// Samples of dead detectors become the mean of the same sub-exposure's samples of the up to four nearest live
/// neighbours; without any they stay.
void replace_dead(cv::Mat1f& picture, const cv::Mat1b& dead, int samples_per_pitch);

/// Taps -r .. r of a symmetric separable filter on samples whose response at f cycles per sample is response(f):
/// integrals over |f| <= 1/2, normalised to sum 1.
[[nodiscard]] std::vector<double> taps_of(const std::function<double(double)>& response);

/// Response of the display beyond the sample and hold that observers assume: exp(-2 pi^2 sigma^2 f^2), times sinc(f)
/// for bilinear interpolation.
[[nodiscard]] double display_response(const SensorSpec& spec, double f_per_sample);
/// Whether the display differs from sample and hold.
[[nodiscard]] bool has_display(const SensorSpec& spec);

/// Filters rows and columns with the taps; beyond its edges a picture is mirrored. The middle of a larger picture is
/// what it would be alone within half the taps of it.
[[nodiscard]] cv::Mat1f filtered(const cv::Mat1f& picture, const std::vector<double>& taps);

}  // namespace todbench
