// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/genicam/picture_encoder.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace todbench {
namespace {

std::uint16_t largest(const EncoderSettings& settings) {
  const auto held = static_cast<unsigned>(significant_bits(settings.format));
  const bool cut_below = settings.format == PixelFormat::mono8;
  return static_cast<std::uint16_t>(
      (1U << (cut_below ? settings.significant_bits : std::min(settings.significant_bits, held))) - 1);
}

cv::Mat1w ramp(cv::Size size, std::uint16_t full_scale) {
  cv::Mat1w out(size);
  for (int x = 0; x < size.width; ++x) out.col(x).setTo(static_cast<unsigned>(x) % (full_scale + 1U));
  return out;
}

}  // namespace

CountRange range_of_means(const cv::Mat1w& counts) {
  CountRange range{65535, 0};
  for (int y = 1; y + 1 < counts.rows; ++y) {
    for (int x = 1; x + 1 < counts.cols; ++x) {
      int sum = 0;
      for (int j = -1; j <= 1; ++j) sum += counts(y + j, x - 1) + counts(y + j, x) + counts(y + j, x + 1);
      range.low = std::min(range.low, sum / 9.0);
      range.high = std::max(range.high, sum / 9.0);
    }
  }
  return range;
}

cv::Mat1w gain_controlled(const cv::Mat1w& counts) {
  constexpr double darkest = 26, brightest = 230, most_gain = 4;
  const CountRange range = range_of_means(counts);
  const double gain = std::min(most_gain, (brightest - darkest) / std::max(1e-9, range.high - range.low));
  const double middle = (range.low + range.high) / 2;
  cv::Mat1w levels(counts.size());
  std::transform(counts.begin(), counts.end(), levels.begin(), [&](std::uint16_t count) {
    const double level = (darkest + brightest) / 2 + gain * (count - middle);
    return static_cast<std::uint16_t>(std::clamp(std::nearbyint(level), 0.0, 255.0));
  });
  return levels;
}

void PictureEncoder::update_table(const EncoderSettings& settings) {
  if (!table_.empty() && settings == table_settings_) return;
  table_settings_ = settings;
  table_.assign(65536, 0);
  const auto scale = RadiometricScale::planck(radiometric_);
  for (std::size_t count = 0; count < table_.size(); ++count) {
    const double kelvin = offset_k_ + kelvin_per_count_ * static_cast<double>(count);
    double signal = static_cast<double>(count);
    if (settings.signal == SignalKind::linear) signal = kelvin / settings.kelvin_per_signal;
    if (settings.signal == SignalKind::tenths) signal = std::floor((static_cast<double>(count) + 5) / 10);
    if (settings.signal == SignalKind::radiometric) signal = scale ? scale->counts(kelvin).value_or(0) : 0;
    table_[count] = std::min(cv::saturate_cast<std::uint16_t>(signal), largest(settings));
  }
}

std::vector<std::uint8_t> PictureEncoder::encode(const cv::Mat1w& counts, const EncoderSettings& settings) {
  update_table(settings);
  cv::Mat1w sent(counts.size());
  if (settings.test_ramp) {
    sent = ramp(counts.size(), largest(settings));
  } else {
    std::transform(counts.begin(), counts.end(), sent.begin(), [&](std::uint16_t count) { return table_[count]; });
    if (settings.averages && previous_.size() == sent.size()) {
      auto before = previous_.begin();
      for (auto& count : sent) count = static_cast<std::uint16_t>((count + *before++ + 1) / 2);
    }
    previous_ = sent;
  }
  if (settings.format == PixelFormat::mono8 && settings.gain == GainControl::linear && !settings.test_ramp) {
    sent = gain_controlled(counts);
  } else if (settings.format == PixelFormat::mono8 && settings.significant_bits > 8) {
    sent = sent.clone();  // `previous_` keeps its bits
    for (auto& count : sent) count = static_cast<std::uint16_t>(count >> (settings.significant_bits - 8));
  }
  auto bytes = encode_pixels(sent, {.format = settings.format,
                                    .order = settings.big_endian ? ByteOrder::big_endian : ByteOrder::little_endian,
                                    .width = sent.cols,
                                    .height = sent.rows});
  assert(bytes && "the counts are cut to what the format holds");
  return std::move(*bytes);
}

void swap_bytes(std::vector<std::uint8_t>& data) {
  for (std::size_t i = 0; i + 1 < data.size(); i += 2) std::swap(data[i], data[i + 1]);
}

}  // namespace todbench
