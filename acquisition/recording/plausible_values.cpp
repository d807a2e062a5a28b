// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/plausible_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/core/byte_order.h"

namespace todbench {
namespace {

constexpr int least_pixels = 1000;
/// Counts between the values on either side of the wrap-around: unsigned values of two temperatures do not lie so close
/// to both ends of 65536 counts.
constexpr int most_gap = 256;
/// As for the byte order: noise over the whole range has a ratio of 1.
constexpr double least_ratio = 2.718;
/// Range of scenes of thermal cameras, from the night sky to molten metal.
constexpr double coldest_k = 150, hottest_k = 2000;
constexpr double least_mistaken_k = 250 + 273.15, most_mistaken_k = 350 + 273.15;

/// Sum of the absolute differences of neighbours, horizontal and vertical.
double roughness(const cv::Mat1w& counts) {
  double sum = 0;
  for (int y = 0; y < counts.rows; ++y) {
    for (int x = 0; x < counts.cols; ++x) {
      const int here = counts(y, x);
      if (x > 0) sum += std::abs(here - counts(y, x - 1));
      if (y > 0) sum += std::abs(here - counts(y - 1, x));
    }
  }
  return sum;
}

/// The counts without 1 % at either end, and at least one pixel each if there are three.
std::pair<ushort, ushort> most_counts(const cv::Mat1w& counts) {
  std::vector<ushort> all(counts.begin(), counts.end());
  std::sort(all.begin(), all.end());
  const std::size_t left_out = all.size() < 3 ? 0 : std::max<std::size_t>(1, all.size() / 100);
  return {all[left_out], all[all.size() - 1 - left_out]};
}

/// Whether many pixels lie at an end of the range and few beside it.
bool clipped(const cv::Mat1w& counts) {
  const auto at = [&](int count) { return cv::countNonZero(counts == count); };
  return at(0) > 4 * at(1) + 8 || at(65535) > 4 * at(65534) + 8;
}

std::string counts_above(const cv::Mat1w& counts, int bits, bool are_signed) {
  double most = 0;
  cv::minMaxLoc(counts, nullptr, &most);
  if (bits >= 16 || most < std::exp2(bits)) return "";
  if (are_signed)
    return fmt::format("bits={} is stated, but signed values are raised by 32768 and fill 16 bits: remove bits", bits);
  return fmt::format("bits={} is stated, but a count is {:.0f} and {} bits end at {:.0f}: state the bits of the data",
                     bits, most, bits, std::exp2(bits) - 1);
}

std::string unit_hint(const KnownValues& known) {
  if (known.sign == KnownValues::Sign::of_camera) return "the scale in the file may be wrong";
  if (known.unit == ValueUnit::kelvin)
    return "state unit=celsius if the values are degrees Celsius, or unit=counts if they are counts";
  if (known.unit == ValueUnit::celsius)
    return "state unit=kelvin if the values are kelvin, or unit=counts if they are counts";
  return known.counts_are_signed ? "check kelvin_per_count and offset_k, the temperature of the value 0 in kelvin"
                                 : "check kelvin_per_count, offset_k, in kelvin, and the sign of the values";
}

/// A warning, empty if the temperatures are plausible. Error: they are below 0 K.
Result<std::string> temperature_warning(const cv::Mat1w& counts, const RadiometricScale& scale,
                                        const KnownValues& known) {
  const auto [least, most] = most_counts(counts);
  const auto one = scale.kelvin(least), other = scale.kelvin(most);
  if (!one || !other) return "";
  const double low = std::min(*one, *other), high = std::max(*one, *other);
  const std::string range = fmt::format("The temperatures of the first frame are {:.1f} to {:.1f} K", low, high);
  if (low < 0) return fail(ErrorCode::invalid_input, range + ", below absolute zero: " + unit_hint(known));
  if (low < coldest_k || high > hottest_k)
    return fmt::format("{}, outside {:.0f} to {:.0f} K: {}.", range, coldest_k, hottest_k, unit_hint(known));
  // 250 to 350 K is a scene outdoors or indoors; few scenes are everywhere at 250 to 350 degrees Celsius.
  if (known.unit == ValueUnit::celsius && low > least_mistaken_k && high < most_mistaken_k)
    return range + ", all above 523 K: " + unit_hint(known) + ".";
  return "";
}

/// A warning, empty if the sign is plausible. Error: the sign was only assumed.
Result<std::string> sign_warning(const cv::Mat1w& counts, const KnownValues& known) {
  using Sign = KnownValues::Sign;
  if (known.sign == Sign::of_camera || !looks_wrapped(counts)) return "";
  if (known.counts_are_signed) {
    return std::string(
               "Neighbouring pixels jump between the lowest negative and the highest positive values, as "
               "unsigned values read as signed do: ") +
           (known.sign == Sign::in_file ? "correct the tag SampleFormat of the file." : "remove signed=yes.");
  }
  const std::string jumps =
      "neighbouring pixels jump between both ends of the range of 16 bits, as signed values read as unsigned do: ";
  if (known.sign == Sign::assumed_unsigned)
    return fail(ErrorCode::invalid_input, jumps + "state signed=yes, or signed=no if they are unsigned");
  const std::string sentence =
      jumps + (known.sign == Sign::in_file ? "correct the tag SampleFormat of the file." : "check signed=no.");
  return "N" + sentence.substr(1);
}

}  // namespace

bool looks_wrapped(const cv::Mat1w& counts) {
  if (static_cast<int>(counts.total()) < least_pixels || clipped(counts)) return false;
  cv::Mat1w inverted;
  cv::bitwise_xor(counts, cv::Scalar(0x8000), inverted);
  if (roughness(counts) < least_ratio * roughness(inverted)) return false;
  // Swapped bytes look wrapped too if the low byte crosses 255.
  if (byte_order_evidence(counts, {}).verdict == ByteOrderVerdict::swapped) return false;
  int below = -1, above = 65536;
  for (const ushort count : inverted) {
    if (count < 0x8000) below = std::max<int>(below, count);
    if (count >= 0x8000) above = std::min<int>(above, count);
  }
  const auto [least, most] = most_counts(inverted);
  return below >= 0 && above <= 65535 && above - below <= std::max(most_gap, (most - least) / 20);
}

Result<void> check_values(Recording& recording, const KnownValues& known) {
  const int bits = recording.info.significant_bits;
  if (recording.frame_count > 0) {
    const auto first = recording.read(0);
    if (first && !first->counts.empty()) {
      if (const std::string above = counts_above(first->counts, bits, known.counts_are_signed); !above.empty())
        return fail(ErrorCode::invalid_input, above);
      const bool measured = known.unit == ValueUnit::kelvin || known.unit == ValueUnit::celsius;
      for (const auto& warning : std::array{measured ? Result<std::string>("") : sign_warning(first->counts, known),
                                            temperature_warning(first->counts, recording.info.scale, known)}) {
        if (!warning) return tl::unexpected(warning.error());
        if (!warning->empty()) recording.info.warnings.push_back(*warning);
      }
    }
  }
  if (bits >= 16) return {};
  recording.read = [read = std::move(recording.read), bits, known](std::uint64_t index) -> Result<RecordedFrame> {
    auto frame = read(index);
    if (!frame) return frame;
    const std::string above = counts_above(frame->counts, bits, known.counts_are_signed);
    if (!above.empty()) return fail(ErrorCode::invalid_input, above);
    return frame;
  };
  return {};
}

}  // namespace todbench
