// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/tiff_writer.h"

#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "acquisition/base/try.h"
#include "acquisition/recording/tiff_stack.h"

namespace todbench {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are stored as they lie in memory");

/// Little-endian, BigTIFF, eight bytes per offset; the offset of the first directory follows.
constexpr std::array<std::uint8_t, 16> file_head{'I', 'I', 43, 0, 8, 0, 0, 0};
constexpr std::uint64_t first_link = 8;

/// Types of values (TIFF 6.0, section 2; BigTIFF).
constexpr std::uint16_t of_16_bits = 3, of_32_bits = 4, of_64_bits = 16;

struct Entry {
  std::uint16_t tag = 0, type = 0;
  std::uint64_t value = 0;
};

template <typename Number>
void put(std::vector<std::uint8_t>& to, Number number) {
  const std::size_t at = to.size();
  to.resize(at + sizeof number);
  std::memcpy(to.data() + at, &number, sizeof number);
}

/// The directory of a page whose pixels are at `offset`, in the order of the tags, without a next page.
std::vector<std::uint8_t> directory_of(const cv::Mat1w& counts, std::uint64_t offset) {
  const auto width = static_cast<std::uint64_t>(counts.cols), height = static_cast<std::uint64_t>(counts.rows);
  const std::array entries{Entry{256, of_32_bits, width},
                           Entry{257, of_32_bits, height},
                           Entry{258, of_16_bits, 16},      // bits per sample
                           Entry{259, of_16_bits, 1},       // not compressed
                           Entry{262, of_16_bits, 1},       // zero is black
                           Entry{273, of_64_bits, offset},  // of the one strip
                           Entry{277, of_16_bits, 1},       // samples per pixel
                           Entry{278, of_32_bits, height},  // rows per strip
                           Entry{279, of_64_bits, 2 * width * height},
                           Entry{284, of_16_bits, 1},   // planes follow each other
                           Entry{339, of_16_bits, 1}};  // unsigned
  std::vector<std::uint8_t> out;
  put(out, std::uint64_t{entries.size()});
  for (const Entry& entry : entries) {
    put(out, entry.tag);
    put(out, entry.type);
    put(out, std::uint64_t{1});
    put(out, entry.value);
  }
  put(out, std::uint64_t{0});
  return out;
}

}  // namespace

Result<TiffWriter> TiffWriter::create(const std::filesystem::path& path) {
  TODBENCH_TRY(auto file, WrittenFile::create(path));
  TiffWriter writer(std::move(file));
  TODBENCH_TRY_VOID(writer.file_.append(file_head.data(), file_head.size()));
  writer.link_offset_ = first_link;
  return writer;
}

Result<void> TiffWriter::append_page(const cv::Mat1w& counts) {
  const std::uint64_t pixels_offset = file_.bytes();
  TODBENCH_TRY_VOID(file_.check_present());
  const cv::Mat1w pixels = counts.isContinuous() ? counts : cv::Mat1w(counts.clone());
  if (auto written = file_.append(pixels.data, 2 * pixels.total()); !written) return written;
  // Directories begin at whole words; the padding also aligns 64-bit numbers.
  constexpr std::uint64_t alignment = 8;
  const std::array<std::uint8_t, alignment> filler{};
  const std::uint64_t missing = (alignment - file_.bytes() % alignment) % alignment;
  TODBENCH_TRY_VOID(file_.append(filler.data(), missing));
  const std::uint64_t directory_offset = file_.bytes();
  const auto directory = directory_of(counts, pixels_offset);
  TODBENCH_TRY_VOID(file_.append(directory.data(), directory.size()));
  TODBENCH_TRY_VOID(file_.overwrite(link_offset_, &directory_offset, sizeof directory_offset));
  link_offset_ = file_.bytes() - sizeof directory_offset;
  return {};
}

Result<void> TiffWriter::append(const cv::Mat1w& counts) {
  if (counts.empty())
    return fail(ErrorCode::invalid_input, file_.path().string() + ": a page without pixels cannot be written");
  if (broken_)
    return fail(ErrorCode::io, file_.path().string() + ": the write of an earlier page failed, so no page is appended");
  const std::uint64_t before = file_.bytes();
  auto written = append_page(counts);
  if (written) {
    ++pages_;
    return written;
  }
  broken_ = true;
  const std::uint64_t none = 0;
  static_cast<void>(file_.overwrite(link_offset_, &none, sizeof none));
  file_.cut(before);
  return written;
}

Result<std::uint64_t> TiffWriter::verified_pages() {
  TODBENCH_TRY_VOID(file_.sync());
  if (pages_ == 0) return 0;
  const auto again = open_tiff_stack(file_.path(), {});
  if (!again) return fail("reading the file back", with_code(ErrorCode::io, again.error()));
  if (again->frame_count != pages_) {
    return fail(ErrorCode::io, file_.path().string() + ": holds " + std::to_string(again->frame_count) +
                                   " pages, but " + std::to_string(pages_) + " were written");
  }
  return pages_;
}

}  // namespace todbench
