#include "acquisition/recording/tiff_file.h"

#include <cstdarg>
#include <cstdio>

namespace todbench {
namespace {

/// A row of 65535 pixels and the tables of a page fit many times; a file that wants more is broken or hostile.
constexpr tmsize_t most_memory = tmsize_t{256} << 20;

/// Keeps the first complaint of libtiff about one file.
int keep_message(TIFF*, void* user, const char* /*module*/, const char* format, va_list arguments) {
  auto& message = *static_cast<std::string*>(user);
  if (message.empty()) {
    char text[200];  // libtiff speaks in formats of printf
    std::vsnprintf(text, sizeof text, format, arguments);
    message = text;
  }
  return 1;
}

int keep_quiet(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

}  // namespace

TiffFile::TiffFile(const std::filesystem::path& path, const char* mode) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, most_memory);
  TIFFOpenOptionsSetErrorHandlerExtR(options, keep_message, &message_);
  TIFFOpenOptionsSetWarningHandlerExtR(options, keep_quiet, nullptr);
  tiff_.reset(TIFFOpenExt(path.c_str(), mode, options));
  TIFFOpenOptionsFree(options);
}

TiffPage page_of(const TiffFile& file) {
  TiffPage page;
  TIFFGetField(file.get(), TIFFTAG_IMAGEWIDTH, &page.width);
  TIFFGetField(file.get(), TIFFTAG_IMAGELENGTH, &page.height);
  TIFFGetFieldDefaulted(file.get(), TIFFTAG_BITSPERSAMPLE, &page.bits);
  TIFFGetFieldDefaulted(file.get(), TIFFTAG_SAMPLESPERPIXEL, &page.samples);
  TIFFGetFieldDefaulted(file.get(), TIFFTAG_SAMPLEFORMAT, &page.kind);
  return page;
}

}  // namespace todbench
