// One picture from a TIFF, of any type of sample that a picture of a camera is exported in.
#include <cstring>
#include <limits>
#include <vector>

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

/// How the samples of a page are stored.
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

/// A picture that claims more rows than the file has bytes would only cost memory: its last row is looked at first.
/// Within a compressed strip rows are read in their order only; no lossless compression makes more than 4096 bytes of
/// one.
bool may_hold(const TiffFile& file, const std::filesystem::path& path, std::vector<char>& row, std::uint32_t height) {
  std::uint16_t compression = COMPRESSION_NONE;
  TIFFGetFieldDefaulted(file.get(), TIFFTAG_COMPRESSION, &compression);
  if (compression == COMPRESSION_NONE) return TIFFReadScanline(file.get(), row.data(), height - 1, 0) >= 0;
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(path, unknown);
  return !unknown && row.size() * static_cast<std::uint64_t>(height) / 4096 <= bytes;
}

}  // namespace

Result<PictureFile> read_tiff_picture(const std::filesystem::path& path) {
  const TiffFile file(path, "r");
  if (file.get() == nullptr) return fail(ErrorCode::invalid_input, file.why("not a TIFF file"));
  const TiffPage page = page_of(file);
  const auto [width, height, bits, samples, kind] = page;
  if (!page.has_size()) return fail(ErrorCode::invalid_input, "the picture is empty or too large");
  const auto stored = samples_of(kind, bits);
  if (samples != 1 || !stored) {
    return fail(ErrorCode::invalid_input, "the picture has " + std::to_string(samples) + " samples of " +
                                              std::to_string(bits) +
                                              " bits per pixel, expected one of 8, 16 or 32 bits or floating point");
  }
  if (TIFFIsTiled(file.get()) != 0) return fail(ErrorCode::invalid_input, "the picture is stored in tiles");
  if (TIFFScanlineSize(file.get()) != static_cast<tmsize_t>(width * stored->bytes))
    return fail(ErrorCode::invalid_input, file.why("the picture has rows of another length"));
  if (TIFFLastDirectory(file.get()) == 0) return fail(ErrorCode::invalid_input, "the file holds more than one picture");
  std::vector<char> row(width * stored->bytes);
  if (!may_hold(file, path, row, height)) return fail(ErrorCode::invalid_input, file.why("the picture cannot be read"));
  PictureFile out;
  out.picture.create(static_cast<int>(height), static_cast<int>(width));
  out.counts = stored->counts;
  for (int y = 0; y < out.picture.rows; ++y) {
    if (TIFFReadScanline(file.get(), row.data(), static_cast<std::uint32_t>(y), 0) < 0)
      return fail(ErrorCode::invalid_input, file.why("the picture cannot be read"));
    stored->append(row, out.picture, y);
  }
  return out;
}

}  // namespace todbench
