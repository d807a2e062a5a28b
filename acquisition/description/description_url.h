// Where a GigE Vision camera says that its GenICam description is.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "acquisition/core/result.h"

namespace todbench {

/// Largest description that is read from a camera, also unzipped. Those of real cameras have 20 kB ... 3 MB; the client
/// reserves as much as the camera states before it has read a byte.
inline constexpr std::uint64_t most_description_bytes = 16U << 20U;

struct DescriptionUrl {
  enum class Place {
    camera,  ///< in its memory, at `address`
    file,    ///< on this host, at `path`
  };
  Place place = Place::camera;
  std::uint32_t address = 0;
  std::uint32_t bytes = 0;
  std::string path;     ///< in the camera: the name that tells whether it is zipped
  bool zipped = false;  ///< files are never unzipped
};

/// Reads a URL ("Local:camera.xml;5C000;8A3", numbers hexadecimal; "File:///usr/share/camera.xml"). `not_found` with
/// the reason for one that states more than is accepted, states nothing that can be read, or would have this host fetch
/// the description from somewhere else.
[[nodiscard]] Result<DescriptionUrl> parse_description_url(std::string_view url);

/// The text of a description in a file. `not_found` where it is no regular file with something in it, as devices, pipes
/// and the files of the kernel are, or has more than most_description_bytes.
[[nodiscard]] Result<std::string> read_description_file(const std::string& path);

}  // namespace todbench
