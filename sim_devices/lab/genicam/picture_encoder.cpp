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
  if (settings.format == PixelFormat::mono8 && settings.significant_bits > 8) {
    sent = sent.clone();  // the picture before keeps its bits
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
