// SPDX-License-Identifier: GPL-3.0-or-later
// JPEG-LS through libcharls. Its C interface, because no exception crosses an interface of the project.
#include <charls/charls.h>

#include <memory>
#include <string>

#include "acquisition/base/try.h"
#include "acquisition/compression/compressed_picture.h"

namespace todbench {
namespace {

struct DestroyDecoder {
  void operator()(const charls_jpegls_decoder* decoder) const { charls_jpegls_decoder_destroy(decoder); }
};

tl::unexpected<Error> not_decoded(charls::jpegls_errc code) {
  return fail(ErrorCode::invalid_input,
              std::string("the JPEG-LS picture cannot be decoded: ") + charls_get_error_message(code));
}

std::string size_text(cv::Size size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

using Decoder = std::unique_ptr<charls_jpegls_decoder, DestroyDecoder>;

/// A decoder that has read the header; the bytes live as long as it.
Result<Decoder> opened(std::string_view bytes) {
  Decoder decoder(charls_jpegls_decoder_create());
  if (!decoder) return fail(ErrorCode::internal, "no memory for a JPEG-LS decoder");
  auto code = charls_jpegls_decoder_set_source_buffer(decoder.get(), bytes.data(), bytes.size());
  if (code == charls::jpegls_errc::success) code = charls_jpegls_decoder_read_header(decoder.get());
  if (code != charls::jpegls_errc::success) return not_decoded(code);
  return decoder;
}

/// Whether the picture is one component of as many pixels as the record states.
Result<void> check(const charls_jpegls_decoder* decoder, cv::Size expected) {
  charls_frame_info frame{};
  if (const auto code = charls_jpegls_decoder_get_frame_info(decoder, &frame); code != charls::jpegls_errc::success)
    return not_decoded(code);
  const cv::Size size(static_cast<int>(frame.width), static_cast<int>(frame.height));
  if (size != expected)
    return fail(ErrorCode::invalid_input,
                "the JPEG-LS picture is " + size_text(size) + ", but its record states " + size_text(expected));
  if (frame.component_count != 1 || frame.bits_per_sample <= 8)
    return fail(ErrorCode::invalid_input, "the JPEG-LS picture has " + std::to_string(frame.component_count) +
                                              " components of " + std::to_string(frame.bits_per_sample) +
                                              " bits, expected one of 9 to 16 bits");
  return {};
}

}  // namespace

Result<cv::Mat1w> decode_jpeg_ls(std::string_view bytes, cv::Size expected) {
  if (expected.width < 1 || expected.height < 1 ||
      static_cast<std::size_t>(expected.width) * static_cast<std::size_t>(expected.height) > most_compressed_pixels)
    return fail(ErrorCode::invalid_input, "a compressed picture of " + size_text(expected) + " is too large");
  // CharLS 2.4.1 reads 2^31 bits behind a stream that is cut off, which takes 6 s; a marker ends it at once.
  const std::string ended = std::string(bytes) + "\xff\xd9";
  TODBENCH_TRY(const Decoder decoder, opened(ended));
  TODBENCH_TRY_VOID(check(decoder.get(), expected));
  cv::Mat1w counts(expected);
  if (const auto code =
          charls_jpegls_decoder_decode_to_buffer(decoder.get(), counts.data, counts.total() * counts.elemSize(), 0);
      code != charls::jpegls_errc::success)
    return not_decoded(code);
  return counts;
}

Result<int> largest_jpeg_ls_error(std::string_view bytes) {
  TODBENCH_TRY(const Decoder decoder, opened(bytes));
  int32_t largest = 0;
  if (const auto code = charls_jpegls_decoder_get_near_lossless(decoder.get(), 0, &largest);
      code != charls::jpegls_errc::success)
    return not_decoded(code);
  return largest;
}

}  // namespace todbench
