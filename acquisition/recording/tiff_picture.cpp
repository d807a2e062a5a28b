// SPDX-License-Identifier: GPL-3.0-or-later
// Reads one picture from a TIFF, with any type of sample in which cameras' pictures are exported.
#include <cstring>
#include <limits>
#include <vector>

#include "acquisition/base/try.h"
#include "acquisition/recording/picture_file.h"
#include "acquisition/recording/tiff_file.h"

namespace todbench {
namespace {

template <typename Value>
void append(const std::vector<char>& row, cv::Mat1d& picture, int y) {
  for (int x = 0; x < picture.cols; ++x) {
    Value value{};
    std::memcpy(&value, row.data() + static_cast<std::size_t>(x) * sizeof(Value), sizeof(Value));
    picture(y, x) = static_cast<double>(value);
  }
}

/// Storage of a page's samples.
struct Samples {
  void (*append)(const std::vector<char>& row, cv::Mat1d& picture, int y);
  std::size_t bytes;
  std::optional<std::pair<double, double>> counts;
};

template <typename Value>
Samples samples_of() {
  Samples samples{append<Value>, sizeof(Value), {}};
  using Limits = std::numeric_limits<Value>;
  if (Limits::is_integer) samples.counts = {static_cast<double>(Limits::lowest()), static_cast<double>(Limits::max())};
  return samples;
}

std::optional<Samples> samples_of(std::uint16_t kind, std::uint16_t bits) {
  if (kind == SAMPLEFORMAT_VOID) kind = SAMPLEFORMAT_UINT;
  if (kind == SAMPLEFORMAT_UINT && bits == 8) return samples_of<std::uint8_t>();
  if (kind == SAMPLEFORMAT_UINT && bits == 16) return samples_of<std::uint16_t>();
  if (kind == SAMPLEFORMAT_UINT && bits == 32) return samples_of<std::uint32_t>();
  if (kind == SAMPLEFORMAT_INT && bits == 8) return samples_of<std::int8_t>();
  if (kind == SAMPLEFORMAT_INT && bits == 16) return samples_of<std::int16_t>();
  if (kind == SAMPLEFORMAT_INT && bits == 32) return samples_of<std::int32_t>();
  if (kind == SAMPLEFORMAT_IEEEFP && bits == 32) return samples_of<float>();
  if (kind == SAMPLEFORMAT_IEEEFP && bits == 64) return samples_of<double>();
  return std::nullopt;
}

}  // namespace

Result<PictureFile> read_tiff_picture(const std::filesystem::path& path) {
  const TiffFile file(path, "r");
  if (file.get() == nullptr) return fail(ErrorCode::invalid_input, file.why("not a TIFF file"));
  const TiffPage page = page_of(file);
  const auto width = page.width, height = page.height;
  const auto bits = page.bits, samples = page.samples;
  if (!page.has_size()) return fail(ErrorCode::invalid_input, "the picture is empty or too large");
  const auto stored = samples_of(page.kind, bits);
  if (samples != 1 || !stored) {
    return fail(ErrorCode::invalid_input, "the picture has " + std::to_string(samples) + " samples of " +
                                              std::to_string(bits) +
                                              " bits per pixel, expected one integer sample of 8, 16 or 32 bits or one "
                                              "floating-point sample of 32 or 64 bits");
  }
  TODBENCH_TRY_VOID(check_layout(page));
  if (page.white_is_zero() && !stored->counts)
    return fail(ErrorCode::invalid_input,
                "the tag PhotometricInterpretation states that 0 is white, which is accepted for integer values only");
  if (TIFFScanlineSize(file.get()) != static_cast<tmsize_t>(width * stored->bytes))
    return fail(ErrorCode::invalid_input, file.why("the rows of the picture have an unexpected length"));
  if (TIFFLastDirectory(file.get()) == 0) return fail(ErrorCode::invalid_input, "the file holds more than one picture");
  TODBENCH_TRY(const auto stack, image_j_stack(file, 1));
  if (stack) return fail(ErrorCode::invalid_input, "the file holds more than one picture");
  TiffRows rows(file, page, width * stored->bytes);
  const auto unreadable = [](const Error& error) { return fail(ErrorCode::invalid_input, error.message); };
  if (auto holds = rows.may_hold(); !holds) return unreadable(holds.error());
  PictureFile out;
  out.picture.create(static_cast<int>(height), static_cast<int>(width));
  out.counts = stored->counts;
  for (int y = 0; y < out.picture.rows; ++y) {
    const auto row = rows.next();
    if (!row) return unreadable(row.error());
    stored->append(**row, out.picture, y);
  }
  // Inverts the values, because the largest one is the darkest.
  if (page.white_is_zero()) out.picture = out.counts->first + out.counts->second - out.picture;
  out.picture = oriented(out.picture, page.orientation);
  return out;
}

}  // namespace todbench
