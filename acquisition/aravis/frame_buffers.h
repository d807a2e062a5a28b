// Aravis buffers to frames. Private to the Aravis back end.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "acquisition/aravis/camera_setup.h"
#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/core/frame.h"

namespace todbench {

/// How many buffers of `payload_bytes` a stream gets: two seconds of frames, so that the consumer may pause for a fit
/// or a disk without losing any; 64 when the rate is unknown; at most 256 MiB.
[[nodiscard]] int buffer_count(double frame_rate_hz, std::size_t payload_bytes);

/// How large a buffer must be for a frame that is larger than stated to be seen as such: one byte more on a network,
/// where Aravis drops in silence what does not fit. Over USB a transfer must end where the payload does.
[[nodiscard]] std::size_t buffer_bytes(const StreamFormat& format);

/// A buffer ready for a stream: zeroed, so that the holes of an incomplete frame are never somebody else's memory, and
/// without id.
[[nodiscard]] GObjectPtr<ArvBuffer> new_frame_buffer(std::size_t bytes);

/// Forgets the id, so that a frame whose leader packet is lost does not come back with the id of an older one.
void clear_frame_id(ArvBuffer* buffer);

/// The id of the frame in the buffer; nothing when its leader packet was lost.
[[nodiscard]] std::optional<std::uint64_t> frame_id_of(ArvBuffer* buffer);

/// True unless the buffer came back only because the stream ended.
[[nodiscard]] bool holds_exposure(ArvBuffer* buffer);

/// The frame in the buffer, its pixels copied once, without the padding that its leader states; sequence, host time and
/// scale are the caller's to fill in. `wrong_size` where geometry, format or number of bytes are not what was stated.
[[nodiscard]] Frame frame_from_buffer(ArvBuffer* buffer, const StreamFormat& format);

}  // namespace todbench
