// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/picture_file.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <system_error>

#include "acquisition/base/npy_header.h"
#include "acquisition/base/safe_file.h"
#include "acquisition/core/byte_order.h"

namespace todbench {
namespace {

constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 31;

/// Whether the bytes of 16-bit samples are exchanged: the byte order that a file states may be wrong.
bool is_byte_swapped(const PictureFile& file) {
  if (!file.counts || file.counts->second - file.counts->first != 65535) return false;
  cv::Mat1w counts;
  cv::Mat1d(file.picture - file.counts->first).convertTo(counts, CV_16U);
  // Undoes the offset of signed samples: only the sign bit differs.
  if (file.counts->first < 0) cv::bitwise_xor(counts, cv::Scalar(0x8000), counts);
  return byte_order_evidence(counts, {}).verdict == ByteOrderVerdict::swapped;
}

}  // namespace

Result<PictureFile> read_picture(const std::filesystem::path& path) {
  const auto wrong = [&](const std::string& sentence) {
    return fail(ErrorCode::invalid_input, path.string() + ": " + sentence);
  };
  std::error_code problem;
  if (!std::filesystem::is_regular_file(path, problem)) return wrong(no_file_reason(path));
  const std::uintmax_t size = std::filesystem::file_size(path, problem);
  if (problem) return wrong(problem.message());
  if (size == 0) return wrong("the file is empty");
  if (size > most_bytes) return wrong("the file is too large for a picture");
  std::ifstream file(path, std::ios::binary);
  std::string start(6, '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  if (file.gcount() <= 0) return wrong("cannot be read");
  Result<PictureFile> picture;
  if (start == npy_magic) {
    std::string bytes(size, '\0');
    file.clear();
    file.seekg(0);
    file.read(bytes.data(), static_cast<std::streamsize>(size));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
    picture = parse_npy(bytes);
  } else if (start.starts_with("II") || start.starts_with("MM")) {
    picture = read_tiff_picture(path);
  } else {
    return wrong("expected a TIFF or .npy file");
  }
  if (!picture) return fail(path.string(), picture.error());
  if (is_byte_swapped(*picture))
    return fail(ErrorCode::integrity, path.string() + ": the two bytes of its pixels are swapped");
  return picture;
}

}  // namespace todbench
