// An open TIFF file and what libtiff had to say about it.
#pragma once

#include <tiffio.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace todbench {

/// Not moved: libtiff keeps the address of the message. One thread at a time.
class TiffFile {
 public:
  /// `mode` as TIFFOpen() takes it.
  TiffFile(const std::filesystem::path& path, const char* mode);
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  /// Null where the file could not be opened.
  [[nodiscard]] TIFF* get() const { return tiff_.get(); }
  /// The first complaint of libtiff.
  [[nodiscard]] std::string why(const char* otherwise) const { return message_.empty() ? otherwise : message_; }
  void close() { tiff_.reset(); }

 private:
  struct Close {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
  };
  std::string message_;  ///< outlives tiff_
  std::unique_ptr<TIFF, Close> tiff_;
};

/// What the tags of the current page say; 0 and libtiff's defaults where they say nothing.
struct TiffPage {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, samples = 1, kind = SAMPLEFORMAT_UINT;

  /// As large as any picture is.
  [[nodiscard]] bool has_size() const { return width >= 1 && height >= 1 && width <= 65535 && height <= 65535; }
};
[[nodiscard]] TiffPage page_of(const TiffFile& file);

}  // namespace todbench
