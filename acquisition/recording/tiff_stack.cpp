#include "acquisition/recording/tiff_stack.h"

#include <tiffio.h>

#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

#include "acquisition/core/camera_id.h"
#include "acquisition/recording/tiff_file.h"

namespace todbench {
namespace {

/// Size of the current page, when it is one that can be read.
Result<cv::Size> page_size(const TiffFile& file) {
  const TiffPage page = page_of(file);
  const auto [width, height, bits, samples, kind] = page;
  if (!page.has_size()) return fail(ErrorCode::invalid_input, "a page has no size or is too large");
  if (bits != 16 || samples != 1 || (kind != SAMPLEFORMAT_UINT && kind != SAMPLEFORMAT_VOID)) {
    return fail(ErrorCode::invalid_input, "a page has " + std::to_string(samples) + " samples of " +
                                              std::to_string(bits) +
                                              " bits per pixel, expected one of 16 unsigned bits");
  }
  if (TIFFIsTiled(file.get()) != 0) return fail(ErrorCode::invalid_input, "a page is stored in tiles, expected strips");
  if (TIFFScanlineSize(file.get()) != static_cast<tmsize_t>(width) * 2)
    return fail(ErrorCode::invalid_input, file.why("a page has rows of another length"));
  return cv::Size(static_cast<int>(width), static_cast<int>(height));
}

Result<cv::Mat1w> read_page(const TiffFile& file) {
  const auto size = page_size(file);
  if (!size) return tl::unexpected(size.error());
  // A page that claims more rows than the file has bytes would only cost memory: look at the last row first.
  std::vector<std::uint16_t> last(static_cast<std::size_t>(size->width));
  if (TIFFReadScanline(file.get(), last.data(), static_cast<std::uint32_t>(size->height - 1), 0) < 0)
    return fail(ErrorCode::io, file.why("a page cannot be read"));
  cv::Mat1w counts(*size);
  for (int row = 0; row < size->height; ++row) {
    if (TIFFReadScanline(file.get(), counts.ptr(row), static_cast<std::uint32_t>(row), 0) < 0)
      return fail(ErrorCode::io, file.why("a page cannot be read"));
  }
  return counts;
}

/// One page of one file.
struct Page {
  std::size_t file = 0;
  std::uint64_t offset = 0;  ///< of its directory
};

Result<std::vector<std::filesystem::path>> files_of(const std::filesystem::path& path) {
  std::error_code problem;
  if (!std::filesystem::is_directory(path, problem)) return std::vector{path};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(path, problem)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".tif" || extension == ".tiff") files.push_back(entry.path());
  }
  if (problem) return fail(ErrorCode::io, path.string() + ": " + problem.message());
  if (files.empty()) return fail(ErrorCode::invalid_input, path.string() + ": no file *.tif or *.tiff in it");
  std::sort(files.begin(), files.end());
  return files;
}

/// Adds the pages of one file; all must have the size of the first.
Result<void> add_pages(const TiffFile& file, std::size_t number, std::vector<Page>& pages, cv::Size& size) {
  do {
    const auto page = page_size(file);
    if (!page) return tl::unexpected(page.error());
    if (pages.empty()) size = *page;
    if (*page != size) {
      return fail(ErrorCode::invalid_input, "page " + std::to_string(pages.size() + 1) + " is " +
                                                std::to_string(page->width) + " x " + std::to_string(page->height) +
                                                ", the first one " + std::to_string(size.width) + " x " +
                                                std::to_string(size.height));
    }
    pages.push_back({number, TIFFCurrentDirOffset(file.get())});
    if (TIFFLastDirectory(file.get()) != 0) return {};
  } while (TIFFReadDirectory(file.get()) != 0);
  // The last page that can be read points to another one.
  return fail(ErrorCode::invalid_input,
              "page " + std::to_string(pages.size() + 1) + " is missing: " + file.why("the file is cut off"));
}

/// Reads pages in any order; the file of the last one stays open.
class PageReader {
 public:
  PageReader(std::vector<std::filesystem::path> files, std::vector<Page> pages)
      : files_(std::move(files)), pages_(std::move(pages)) {}

  Result<RecordedFrame> read(std::uint64_t index) {
    const Page& page = pages_[index];
    if (!open_ || number_ != page.file) {
      open_ = std::make_unique<TiffFile>(files_[page.file], "r");
      number_ = page.file;
    }
    if (open_->get() == nullptr) return fail(ErrorCode::io, open_->why("cannot be opened again"));
    if (TIFFSetSubDirectory(open_->get(), page.offset) == 0) return fail(ErrorCode::io, open_->why("a page is gone"));
    auto counts = read_page(*open_);
    if (!counts) return fail(files_[page.file].string(), counts.error());
    RecordedFrame frame;
    frame.counts = *std::move(counts);
    return frame;
  }

 private:
  std::vector<std::filesystem::path> files_;
  std::vector<Page> pages_;
  std::unique_ptr<TiffFile> open_;
  std::size_t number_ = 0;
};

}  // namespace

Result<Recording> open_tiff_stack(const std::filesystem::path& path, const TiffFormat& format) {
  if (format.significant_bits < 1 || format.significant_bits > 16)
    return fail(ErrorCode::invalid_input, path.string() + ": significant bits must be 1 ... 16");
  auto files = files_of(path);
  if (!files) return tl::unexpected(files.error());
  std::vector<Page> pages;
  cv::Size size;
  for (std::size_t i = 0; i < files->size(); ++i) {
    const TiffFile file((*files)[i], "r");
    if (file.get() == nullptr)
      return fail(ErrorCode::invalid_input, (*files)[i].string() + ": " + file.why("not a TIFF file"));
    if (auto added = add_pages(file, i, pages, size); !added) return fail((*files)[i].string(), added.error());
  }
  Recording recording;
  recording.info.id = camera_id(camera_scheme::file, path.string());
  recording.info.model = path.filename().string();
  recording.info.transport = "recording";
  recording.info.width = size.width;
  recording.info.height = size.height;
  recording.info.pixel_format = "Mono16";
  recording.info.significant_bits = format.significant_bits;
  recording.info.frame_rate_hz = format.frame_rate_hz;
  recording.info.scale = format.scale;
  recording.info.settings = {{"Width", std::to_string(size.width)}, {"Height", std::to_string(size.height)}};
  recording.frame_count = pages.size();
  recording.read = [reader = std::make_shared<PageReader>(*std::move(files), std::move(pages))](std::uint64_t index) {
    return reader->read(index);
  };
  return recording;
}

}  // namespace todbench
