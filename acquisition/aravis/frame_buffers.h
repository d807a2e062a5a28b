// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of Aravis buffers to frames. Private to the Aravis back end.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "acquisition/aravis/camera_setup.h"
#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/core/frame.h"

namespace todbench {

/// Returns the number of buffers of `payload_bytes` for a stream. The buffers hold two seconds of frames, so no frame
/// is lost while the consumer waits for a fit or a disk. 64 if the rate is unknown; at most 256 MiB.
[[nodiscard]] int buffer_count(double frame_rate_hz, std::size_t payload_bytes);

/// Returns the buffer size with which a frame larger than stated is detected. On a network it is one byte more than the
/// payload, because Aravis silently drops the bytes that do not fit. Over USB it is the payload, because a transfer
/// must end with the payload.
[[nodiscard]] std::size_t buffer_bytes(const StreamFormat& format);

/// Returns a buffer for a stream: without id, and zeroed so that the gaps of an incomplete frame contain no old data.
[[nodiscard]] GObjectPtr<ArvBuffer> new_frame_buffer(std::size_t bytes);

/// Clears the id. Otherwise a frame whose leader packet is lost would have the id of an older frame.
void clear_frame_id(ArvBuffer* buffer);

/// Returns the id of the frame in the buffer; empty if its leader packet was lost.
[[nodiscard]] std::optional<std::uint64_t> frame_id_of(ArvBuffer* buffer);

/// Returns the size of the picture according to the leader; empty without a leader or if the payload is not an image.
[[nodiscard]] cv::Size size_of_leader(ArvBuffer* buffer);

/// Returns whether the buffer was filled. False if Aravis released the buffer only because the stream ended.
[[nodiscard]] bool holds_exposure(ArvBuffer* buffer);

/// Returns the frame in the buffer: pixels copied once, without the padding stated by the leader. The caller fills in
/// sequence, host time and scale. Status `wrong_size` if geometry, format or number of bytes differ from `format`.
[[nodiscard]] Frame frame_from_buffer(ArvBuffer* buffer, const StreamFormat& format);

}  // namespace todbench
