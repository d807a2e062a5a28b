// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/frame_buffers.h"

#include <algorithm>
#include <cstdlib>

#include "acquisition/aravis/image_layout.h"

namespace todbench {
namespace {

/// An id that is invalid in both numberings.
constexpr std::uint64_t no_frame_id = ~std::uint64_t{0};

FrameStatus status_of(ArvBuffer* buffer, const StreamFormat& format) {
  switch (arv_buffer_get_status(buffer)) {
    case ARV_BUFFER_STATUS_SUCCESS: {
      // Aravis also reports success for a frame whose leader it rejected: the buffer then holds an older leader.
      if (!frame_id_of(buffer)) return FrameStatus::incomplete;
      const auto type = arv_buffer_get_payload_type(buffer);
      // Chunks follow the image.
      const bool image = type == ARV_BUFFER_PAYLOAD_TYPE_IMAGE || type == ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA;
      const bool as_negotiated = image && arv_buffer_get_image_width(buffer) == format.width &&
                                 arv_buffer_get_image_height(buffer) == format.height &&
                                 arv_buffer_get_image_pixel_format(buffer) == pfnc_code(format.pixel_format);
      return as_negotiated ? FrameStatus::complete : FrameStatus::wrong_size;
    }
    case ARV_BUFFER_STATUS_SIZE_MISMATCH:
      return FrameStatus::wrong_size;
    default:
      return FrameStatus::incomplete;
  }
}

ChunkLayout chunk_layout(ArvBuffer* buffer, const StreamFormat& format) {
  const bool chunks = arv_buffer_has_chunks(buffer) != 0 ||
                      arv_buffer_get_payload_type(buffer) == ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA;
  if (!chunks) return ChunkLayout::none;
  return format.transport == AravisTransport::usb3_vision ? ChunkLayout::little_endian : ChunkLayout::big_endian;
}

}  // namespace

int buffer_count(double frame_rate_hz, std::size_t payload_bytes) {
  const double two_seconds = frame_rate_hz > 0 ? 2 * frame_rate_hz : 64;
  const double affordable = static_cast<double>(256U << 20U) / static_cast<double>(payload_bytes);
  return static_cast<int>(std::max(4.0, std::min({std::max(16.0, two_seconds), affordable, 512.0})));
}

std::size_t buffer_bytes(const StreamFormat& format) {
  return format.payload_bytes + (format.transport == AravisTransport::gige_vision ? 1 : 0);
}

GObjectPtr<ArvBuffer> new_frame_buffer(std::size_t bytes) {
  void* memory = std::calloc(1, bytes);
  GObjectPtr<ArvBuffer> buffer(arv_buffer_new_full(bytes, memory, memory, std::free));
  clear_frame_id(buffer.get());
  return buffer;
}

void clear_frame_id(ArvBuffer* buffer) {
  arv_buffer_set_frame_id(buffer, no_frame_id);
}

std::optional<std::uint64_t> frame_id_of(ArvBuffer* buffer) {
  const auto id = arv_buffer_get_frame_id(buffer);
  return id != no_frame_id ? std::optional<std::uint64_t>(id) : std::nullopt;
}

cv::Size size_of_leader(ArvBuffer* buffer) {
  if (!frame_id_of(buffer)) return {};
  const auto type = arv_buffer_get_payload_type(buffer);
  if (type != ARV_BUFFER_PAYLOAD_TYPE_IMAGE && type != ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA) return {};
  return {arv_buffer_get_image_width(buffer), arv_buffer_get_image_height(buffer)};
}

bool holds_exposure(ArvBuffer* buffer) {
  const auto status = arv_buffer_get_status(buffer);
  return status != ARV_BUFFER_STATUS_ABORTED && status != ARV_BUFFER_STATUS_CLEARED;
}

Frame frame_from_buffer(ArvBuffer* buffer, const StreamFormat& format) {
  Frame frame;
  frame.status = status_of(buffer, format);
  frame.significant_bits = format.significant_bits;
  // Without a leader the buffer still holds the time of an older frame.
  if (frame_id_of(buffer)) frame.device_time_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer));
  StatedImage image{.format = format.pixel_format, .width = format.width, .height = format.height};
  std::size_t bytes = 0;
  const auto* data = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &bytes));
  std::optional<std::span<const std::uint8_t>> pixels = std::span(data, data != nullptr ? bytes : 0);
  if (frame.status == FrameStatus::complete) {
    arv_buffer_get_image_padding(buffer, &image.x_padding, &image.y_padding);
    pixels = image_bytes(*pixels, image, chunk_layout(buffer, format));
  }
  if (!pixels) {
    frame.status = FrameStatus::wrong_size;
    frame.counts = cv::Mat1w(format.height, format.width, std::uint16_t{0});
    return frame;
  }
  auto counts = decode_pixels(*pixels, {.format = format.pixel_format,
                                        .order = format.big_endian ? ByteOrder::big_endian : ByteOrder::little_endian,
                                        .width = format.width,
                                        .height = format.height,
                                        .row_bytes = row_bytes(image)});
  if (counts) {
    frame.counts = std::move(*counts);
    return frame;
  }
  if (frame.status == FrameStatus::complete) frame.status = FrameStatus::wrong_size;
  frame.counts = cv::Mat1w(format.height, format.width, std::uint16_t{0});
  return frame;
}

}  // namespace todbench
