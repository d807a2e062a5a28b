// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of an exposure before it is sent: scale, processing, test pattern, bits and bytes.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/core/radiometric_scale.h"
#include "acquisition/pixel_formats/pixel_formats.h"

namespace todbench {

/// Meaning of a count on the wire.
enum class SignalKind {
  linear,       ///< kelvin / `kelvin_per_signal`
  radiometric,  ///< by the Planck-like formula
  as_exposed,   ///< unchanged counts of the exposure
  tenths,       ///< counts of the exposure divided by ten, rounded
};

/// Conversion of counts to eight bits.
enum class GainControl {
  none,    ///< the highest eight bits
  linear,  ///< range_of_means() to grey levels 26 ... 230, at most four grey levels per count
};

/// Lowest and highest mean over 3 x 3 counts in the picture: the range of the scene for a gain control.
struct CountRange {
  double low = 0, high = 0;
};
/// Returns the range of a picture.
[[nodiscard]] CountRange range_of_means(const cv::Mat1w& counts);
/// Returns the grey levels of a linear gain control, clipped at 0 and 255.
[[nodiscard]] cv::Mat1w gain_controlled(const cv::Mat1w& counts);

/// Settings of the conversion.
struct EncoderSettings {
  SignalKind signal = SignalKind::as_exposed;
  double kelvin_per_signal = 0.04;
  unsigned significant_bits = 14;            ///< larger values are clipped, also to the range of the format
  PixelFormat format = PixelFormat::mono16;  ///< mono8: the highest eight of the significant bits
  GainControl gain = GainControl::none;      ///< gain control for mono8, applied to the counts of the exposure
  bool test_ramp = false;  ///< replaces the picture: pixel x of a row has the count x, modulo full scale
  bool averages = false;   ///< averages with the previous picture, as noise reduction does
  bool big_endian = false;
  bool operator==(const EncoderSettings&) const = default;
};

/// Conversion of exposures to bytes. One thread at a time.
class PictureEncoder {
 public:
  /// Creates the encoder. `kelvin_per_count` and `offset_k` are the scale of the exposures.
  PictureEncoder(double kelvin_per_count, double offset_k, PlanckScale radiometric)
      : kelvin_per_count_(kelvin_per_count), offset_k_(offset_k), radiometric_(radiometric) {}

  /// Returns the bytes of an exposure with these settings.
  [[nodiscard]] std::vector<std::uint8_t> encode(const cv::Mat1w& counts, const EncoderSettings& settings);

 private:
  void update_table(const EncoderSettings& settings);

  double kelvin_per_count_, offset_k_;
  PlanckScale radiometric_;
  EncoderSettings table_settings_;
  std::vector<std::uint16_t> table_;  ///< signal for every count; empty: not yet computed
  cv::Mat1w previous_;
};

/// Exchanges the two bytes of every pair.
void swap_bytes(std::vector<std::uint8_t>& data);

}  // namespace todbench
