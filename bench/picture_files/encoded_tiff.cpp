// SPDX-License-Identifier: GPL-3.0-or-later
#include <tiffio.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "bench/picture_files/encoded_picture.h"

namespace todbench {
namespace {

/// Memory buffer with the file interface of libtiff.
struct Memory {
  std::string bytes;
  std::size_t at = 0;
};

Memory& memory_of(thandle_t handle) {
  return *static_cast<Memory*>(handle);
}

tmsize_t read_bytes(thandle_t handle, void* to, tmsize_t count) {
  Memory& memory = memory_of(handle);
  const std::size_t there = memory.bytes.size() - std::min(memory.at, memory.bytes.size());
  const std::size_t n = std::min(static_cast<std::size_t>(count), there);
  std::memcpy(to, memory.bytes.data() + memory.at, n);
  memory.at += n;
  return static_cast<tmsize_t>(n);
}

tmsize_t write_bytes(thandle_t handle, void* from, tmsize_t count) {
  Memory& memory = memory_of(handle);
  const auto n = static_cast<std::size_t>(count);
  memory.bytes.resize(std::max(memory.bytes.size(), memory.at + n));
  std::memcpy(memory.bytes.data() + memory.at, from, n);
  memory.at += n;
  return count;
}

toff_t move_in(thandle_t handle, toff_t offset, int from) {
  Memory& memory = memory_of(handle);
  const std::size_t start = from == SEEK_SET ? 0 : from == SEEK_CUR ? memory.at : memory.bytes.size();
  memory.at = start + offset;
  return memory.at;
}

toff_t bytes_of(thandle_t handle) {
  return memory_of(handle).bytes.size();
}

int nothing_to_close(thandle_t) {
  return 0;
}

}  // namespace

Result<std::string> tiff_of(const cv::Mat1f& picture) {
  if (picture.empty()) return fail(ErrorCode::invalid_input, "an empty picture cannot be encoded as TIFF");
  Memory memory;
  {
    // Little-endian on every machine.
    const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(
        TIFFClientOpen("picture", "wl", &memory, read_bytes, write_bytes, move_in, nothing_to_close, bytes_of, nullptr,
                       nullptr),
        TIFFClose);
    bool well = tiff != nullptr && TIFFSetField(tiff.get(), TIFFTAG_IMAGEWIDTH, picture.cols) == 1 &&
                TIFFSetField(tiff.get(), TIFFTAG_IMAGELENGTH, picture.rows) == 1 &&
                TIFFSetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, 32) == 1 &&
                TIFFSetField(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, 1) == 1 &&
                TIFFSetField(tiff.get(), TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP) == 1 &&
                TIFFSetField(tiff.get(), TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK) == 1 &&
                TIFFSetField(tiff.get(), TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == 1 &&
                TIFFSetField(tiff.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE) == 1 &&
                TIFFSetField(tiff.get(), TIFFTAG_ROWSPERSTRIP, picture.rows) == 1;
    for (int y = 0; well && y < picture.rows; ++y) {
      // libtiff may swap bytes in place.
      cv::Mat1f row = picture.row(y).clone();
      well = TIFFWriteScanline(tiff.get(), row.ptr<float>(), static_cast<std::uint32_t>(y), 0) == 1;
    }
    if (!well || TIFFWriteDirectory(tiff.get()) != 1)
      return fail(ErrorCode::internal, "the picture cannot be encoded as TIFF");
  }
  return std::move(memory.bytes);
}

}  // namespace todbench
