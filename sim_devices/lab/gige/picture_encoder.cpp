#include "sim_devices/lab/gige/picture_encoder.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace todbench {
namespace {

std::uint16_t largest(const EncoderSettings& settings) {
  return static_cast<std::uint16_t>((1U << settings.significant_bits) - 1);
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
    if (settings.signal == SignalKind::radiometric) signal = scale ? scale->counts(kelvin).value_or(0) : 0;
    table_[count] = std::min(cv::saturate_cast<std::uint16_t>(signal), largest(settings));
  }
}

Bytes PictureEncoder::encode(const cv::Mat1w& counts, const EncoderSettings& settings) {
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
  const std::size_t pixels = sent.total();
  if (settings.bits_per_pixel == 8) {
    Bytes data(pixels);
    const unsigned shift = settings.significant_bits > 8 ? settings.significant_bits - 8 : 0;
    std::transform(sent.begin(), sent.end(), data.begin(),
                   [&](std::uint16_t count) { return static_cast<std::uint8_t>(count >> shift); });
    return data;
  }
  static_assert(std::endian::native == std::endian::little, "pixels are copied as they lie in memory");
  Bytes data(2 * pixels);
  std::memcpy(data.data(), sent.data, data.size());
  if (settings.big_endian) swap_bytes(data);
  return data;
}

void swap_bytes(Bytes& data) {
  for (std::size_t i = 0; i + 1 < data.size(); i += 2) std::swap(data[i], data[i + 1]);
}

}  // namespace todbench
