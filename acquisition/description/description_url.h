// SPDX-License-Identifier: GPL-3.0-or-later
// Location of a GigE Vision camera's GenICam description.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "acquisition/base/result.h"

namespace todbench {

/// Largest description that is read from a camera, also after unzipping. Real cameras have 20 kB ... 3 MB. The client
/// allocates the stated size before it reads the first byte.
inline constexpr std::uint64_t most_description_bytes = 16U << 20U;

/// Location of a description.
struct DescriptionUrl {
  enum class Place {
    camera,  ///< the description is in the camera's memory, at `address`
    file,    ///< the description is on this host, at `path`
  };
  Place place = Place::camera;
  std::uint32_t address = 0;
  std::uint32_t bytes = 0;
  std::string path;     ///< path of the file; for the camera only the file name, whose extension shows whether the
                        ///< content is zipped
  bool zipped = false;  ///< always false for files
};

/// Parses a URL ("Local:camera.xml;5C000;8A3", numbers hexadecimal; "File:///usr/share/camera.xml"). Error: `not_found`
/// with the reason if a number exceeds its limit, the URL is unreadable, or it refers to neither the camera nor a file.
[[nodiscard]] Result<DescriptionUrl> parse_description_url(std::string_view url);

/// Returns the text of a description file. Error: `not_found` if it is not a regular file (a device, a pipe, a kernel
/// file), is empty, or has more than most_description_bytes.
[[nodiscard]] Result<std::string> read_description_file(const std::string& path);

}  // namespace todbench
