// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/tiff_stack.h"

#include <tiffio.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "acquisition/base/safe_text.h"
#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/recording/tiff_file.h"

namespace todbench {
namespace {

/// Depth of the samples of a page in OpenCV's names, if a recording may have them.
std::optional<int> depth_of(const TiffPage& page) {
  if (page.samples != 1) return std::nullopt;
  const bool counts = page.kind == SAMPLEFORMAT_UINT || page.kind == SAMPLEFORMAT_VOID;
  if (page.bits == 16 && counts) return CV_16U;
  if (page.bits == 16 && page.kind == SAMPLEFORMAT_INT) return CV_16S;
  if (page.bits == 32 && page.kind == SAMPLEFORMAT_IEEEFP) return CV_32F;
  if (page.bits == 64 && page.kind == SAMPLEFORMAT_IEEEFP) return CV_64F;
  return std::nullopt;
}

/// Size and depth of a page.
struct PageShape {
  cv::Size size;  ///< after its orientation is applied
  int depth = CV_16U;
  bool white_is_zero = false;
  bool operator==(const PageShape&) const = default;
};

/// The shape of the current page, if the page is readable.
Result<PageShape> page_shape(const TiffFile& file) {
  const TiffPage page = page_of(file);
  if (!page.has_size()) return fail(ErrorCode::invalid_input, "a page has no size or is too large");
  const auto depth = depth_of(page);
  if (!depth) {
    const bool floating = page.kind == SAMPLEFORMAT_IEEEFP;
    return fail(ErrorCode::invalid_input,
                "a page has " + std::to_string(page.samples) + (page.samples == 1 ? " sample of " : " samples of ") +
                    std::to_string(page.bits) + " bits" + (floating ? " floating point" : "") +
                    " per pixel, expected one sample of 16 bits (integer) or of 32 or 64 bits (floating point)");
  }
  TODBENCH_TRY_VOID(check_layout(page));
  if (page.white_is_zero() && CV_ELEM_SIZE(*depth) != 2)
    return fail(ErrorCode::invalid_input,
                "the tag PhotometricInterpretation states that 0 is white, which is accepted for 16 bits only");
  if (TIFFScanlineSize(file.get()) != static_cast<tmsize_t>(page.width) * static_cast<tmsize_t>(CV_ELEM_SIZE(*depth)))
    return fail(ErrorCode::invalid_input, file.why("the rows of a page have an unexpected length"));
  const cv::Size size(static_cast<int>(page.width), static_cast<int>(page.height));
  return PageShape{exchanges_axes(page.orientation) ? cv::Size(size.height, size.width) : size, *depth,
                   page.white_is_zero()};
}

/// Applies the tag Orientation and makes the smallest value the darkest.
cv::Mat shown(const cv::Mat& stored, const TiffPage& page) {
  cv::Mat values = oriented(stored, page.orientation);
  if (page.white_is_zero()) cv::bitwise_not(values.clone(), values);
  return values;
}

Result<cv::Mat> read_page(const TiffFile& file) {
  TODBENCH_TRY(const auto shape, page_shape(file));
  const TiffPage page = page_of(file);
  TiffRows rows(file, page, static_cast<std::size_t>(CV_ELEM_SIZE(shape.depth)) * page.width);
  TODBENCH_TRY_VOID(rows.may_hold());
  cv::Mat values(static_cast<int>(page.height), static_cast<int>(page.width), shape.depth);
  for (int y = 0; y < values.rows; ++y) {
    TODBENCH_TRY(const auto row, rows.next());
    std::memcpy(values.ptr(y), row->data(), row->size());
  }
  return shown(values, page);
}

/// Picture `image` of an ImageJ stack whose one directory is the present one.
Result<cv::Mat> read_image(const TiffFile& file, const std::filesystem::path& path, const ImageJStack& stack,
                           std::uint64_t image) {
  TODBENCH_TRY(const auto shape, page_shape(file));
  const TiffPage page = page_of(file);
  cv::Mat values(static_cast<int>(page.height), static_cast<int>(page.width), shape.depth);
  const std::uint64_t bytes = values.total() * values.elemSize();
  std::ifstream stream(path, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(stack.offset + image * bytes));
  stream.read(reinterpret_cast<char*>(values.data), static_cast<std::streamsize>(bytes));
  if (stream.gcount() != static_cast<std::streamsize>(bytes))
    return fail(ErrorCode::io, "the file became shorter after it was opened");
  if (TIFFIsByteSwapped(file.get()) != 0) {
    const auto total = static_cast<tmsize_t>(values.total());
    if (values.elemSize() == 2) TIFFSwabArrayOfShort(values.ptr<std::uint16_t>(), total);
    if (values.elemSize() == 4) TIFFSwabArrayOfLong(reinterpret_cast<std::uint32_t*>(values.data), total);
    if (values.elemSize() == 8) TIFFSwabArrayOfDouble(reinterpret_cast<double*>(values.data), total);
  }
  return shown(values, page);
}

/// One page of one file.
struct Page {
  std::size_t file = 0;
  std::uint64_t offset = 0;            ///< of its directory
  std::optional<ImageJStack> stack{};  ///< set if the directory is that of many pictures
  std::uint64_t image = 0;             ///< of `stack`
};

/// Natural order of names: numbers in them are compared as numbers, f_2 before f_10.
bool naturally_before(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (!digit(a[i]) || !digit(b[k])) {
      if (a[i] != b[k]) return a[i] < b[k];
      ++i, ++k;
      continue;
    }
    const auto number = [&](const std::string& text, std::size_t& at) {
      while (at + 1 < text.size() && text[at] == '0' && digit(text[at + 1])) ++at;
      const std::size_t first = at;
      while (at < text.size() && digit(text[at])) ++at;
      return std::string_view(text).substr(first, at - first);
    };
    const std::string_view one = number(a, i), other = number(b, k);
    if (one.size() != other.size()) return one.size() < other.size();
    if (one != other) return one < other;
  }
  if (i < a.size() || k < b.size()) return i >= a.size();
  return a < b;  // they differ in leading zeros only
}

/// Files of a recording in the order of their exposures.
struct FilesInOrder {
  std::vector<std::filesystem::path> files;
  bool letters_differ = false;  ///< the alphabetical order of their names differs
};

Result<FilesInOrder> files_of(const std::filesystem::path& path) {
  std::error_code problem;
  if (!std::filesystem::is_directory(path, problem)) return FilesInOrder{{path}};
  FilesInOrder found;
  for (const auto& entry : std::filesystem::directory_iterator(path, problem)) {
    if (has_tiff_name(entry.path())) found.files.push_back(entry.path());
  }
  if (problem) return fail(ErrorCode::io, path.string() + ": " + problem.message());
  if (found.files.empty())
    return fail(ErrorCode::invalid_input, path.string() + ": the folder contains no *.tif or *.tiff file");
  std::sort(found.files.begin(), found.files.end(), [](const auto& a, const auto& b) {
    return naturally_before(a.filename().string(), b.filename().string());
  });
  found.letters_differ = !std::is_sorted(found.files.begin(), found.files.end());
  return found;
}

/// Adds the pages of one file; all must have the shape of the first.
Result<void> add_pages(const TiffFile& file, std::size_t number, std::vector<Page>& pages, PageShape& shape) {
  const std::uint64_t directories = TIFFNumberOfDirectories(file.get());
  TODBENCH_TRY(const auto stack, image_j_stack(file, directories));
  do {
    TODBENCH_TRY(const auto page, page_shape(file));
    TODBENCH_TRY_VOID(check_extent(file));
    if (pages.empty()) shape = page;
    if (page.size != shape.size) {
      return fail(ErrorCode::invalid_input,
                  "page " + std::to_string(pages.size() + 1) + " is " + std::to_string(page.size.width) + " x " +
                      std::to_string(page.size.height) + ", but the first page is " + std::to_string(shape.size.width) +
                      " x " + std::to_string(shape.size.height));
    }
    if (page.depth != shape.depth)
      return fail(ErrorCode::invalid_input,
                  "page " + std::to_string(pages.size() + 1) + " has another kind of values than the first page");
    if (page.white_is_zero != shape.white_is_zero)
      return fail(ErrorCode::invalid_input, "page " + std::to_string(pages.size() + 1) +
                                                " has another tag PhotometricInterpretation than the first page");
    const std::uint64_t images = stack ? stack->images : 1;
    for (std::uint64_t k = 0; k < images; ++k) pages.push_back({number, TIFFCurrentDirOffset(file.get()), stack, k});
    if (TIFFLastDirectory(file.get()) != 0) return {};
  } while (TIFFReadDirectory(file.get()) != 0);
  // The last readable page points to another one.
  return fail(ErrorCode::invalid_input,
              "page " + std::to_string(pages.size() + 1) + " is missing: " + file.why("the file is truncated"));
}

/// Reads pages in any order; the file of the last one stays open.
class PageReader {
 public:
  PageReader(std::vector<std::filesystem::path> files, std::vector<Page> pages)
      : files_(std::move(files)), pages_(std::move(pages)) {}

  [[nodiscard]] std::uint64_t count() const { return pages_.size(); }

  Result<cv::Mat> read(std::uint64_t index) {
    const Page& page = pages_[index];
    if (!open_ || number_ != page.file) {
      open_ = std::make_unique<TiffFile>(files_[page.file], "r");
      number_ = page.file;
    }
    if (open_->get() == nullptr) return fail(ErrorCode::io, open_->why("cannot be opened again"));
    if (TIFFSetSubDirectory(open_->get(), page.offset) == 0)
      return fail(ErrorCode::io, open_->why("a page is missing"));
    auto values = page.stack ? read_image(*open_, files_[page.file], *page.stack, page.image) : read_page(*open_);
    if (!values) return fail(files_[page.file].string(), values.error());
    return values;
  }

 private:
  std::vector<std::filesystem::path> files_;
  std::vector<Page> pages_;
  std::unique_ptr<TiffFile> open_;
  std::size_t number_ = 0;
};

Result<RecordedFrame> read_frame(PageReader& pages, const ValueCounts& conversion, std::uint64_t index) {
  TODBENCH_TRY(const auto values, pages.read(index));
  TODBENCH_TRY(auto counts, conversion.counts(values));
  RecordedFrame frame;
  frame.counts = std::move(counts);
  return frame;
}

}  // namespace

bool has_tiff_name(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  return extension == ".tif" || extension == ".tiff";
}

Result<Recording> open_tiff_stack(const std::filesystem::path& path, const TiffFormat& format) {
  if (format.significant_bits < 1 || format.significant_bits > 16)
    return fail(ErrorCode::invalid_input, path.string() + ": significant bits must be 1 ... 16");
  TODBENCH_TRY(auto found, files_of(path));
  std::vector<std::filesystem::path>& files = found.files;
  std::vector<Page> pages;
  PageShape shape;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const TiffFile file(files[i], "r");
    if (file.get() == nullptr)
      return fail(ErrorCode::invalid_input, files[i].string() + ": " + file.why("not a TIFF file"));
    if (auto added = add_pages(file, i, pages, shape); !added) return fail(files[i].string(), added.error());
  }
  // A scale refers to the values in the file, and their order is reversed.
  if (shape.white_is_zero && (shape.depth != CV_16U || format.scale.calibrated() || format.significant_bits < 16))
    return fail(ErrorCode::invalid_input,
                path.string() +
                    ": the tag PhotometricInterpretation states that 0 is white, so the values are "
                    "reversed. Write the file with 0 as black to state their sign, bits or temperature scale");
  const std::string first_name = files.front().filename().string(), last_name = files.back().filename().string();
  auto reader = std::make_shared<PageReader>(std::move(files), std::move(pages));
  const auto values = value_counts(shape.depth, format.unit, format.scale.calibrated(), reader->count(),
                                   [&](std::uint64_t index) { return reader->read(index); });
  if (!values) return fail(path.string(), values.error());
  const auto scale = values->scale(format.scale);
  if (!scale) return fail(path.string(), scale.error());
  Recording recording;
  recording.info.id = camera_id(camera_scheme::file, path.string());
  recording.info.model = path.filename().string();
  recording.info.transport = "recording";
  recording.info.width = shape.size.width;
  recording.info.height = shape.size.height;
  recording.info.pixel_format = "Mono16";
  recording.info.significant_bits = format.significant_bits;
  recording.info.frame_rate_hz = format.frame_rate_hz;
  recording.info.scale = *scale;
  recording.info.settings = {{"Width", std::to_string(shape.size.width)},
                             {"Height", std::to_string(shape.size.height)}};
  if (auto relation = values->describe(); !relation.empty()) recording.info.settings["Counts"] = std::move(relation);
  if (found.letters_differ) {
    recording.info.warnings.push_back("The files are read in the order of the numbers in their names: " + first_name +
                                      " first, " + last_name + " last. Their alphabetical order differs.");
  }
  recording.frame_count = reader->count();
  recording.read = [reader, conversion = *values](std::uint64_t index) {
    return read_frame(*reader, conversion, index);
  };
  return recording;
}

}  // namespace todbench
