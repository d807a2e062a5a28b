// An open TIFF file and what libtiff had to say about it.
#pragma once

#include <tiffio.h>

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

}  // namespace todbench
