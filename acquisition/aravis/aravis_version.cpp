// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/aravis_version.h"

#include <arv.h>

#include <array>

namespace todbench {
namespace {

struct KnownFault {
  AravisVersion mended;  ///< first version without it
  const char* sentence;
};

constexpr std::array known_faults{
    KnownFault{{0, 8, 27}, "the size of packets may be found wrongly: state GevSCPSPacketSize"},
    KnownFault{{0, 8, 28}, "a USB3 Vision camera that stops answering may block the end of a stream"},
    KnownFault{{0, 8, 32},
               "chunks of some GigE Vision cameras are not recognised: this program switches chunk mode off"},
    KnownFault{{0, 9, 1}, "damaged packets of GigE Vision are parsed carelessly: use a network of its own"},
    KnownFault{
        {0, 9, 2},
        "FLIR cameras of the Xsc Series (A6751 and others) fail to open: their registers have the other byte order"},
};

}  // namespace

std::string to_string(const AravisVersion& version) {
  return std::to_string(version.major) + "." + std::to_string(version.minor) + "." + std::to_string(version.micro);
}

AravisVersion running_aravis() {
  return {arv_get_major_version(), arv_get_minor_version(), arv_get_micro_version()};
}

std::vector<std::string> aravis_faults(const AravisVersion& version) {
  std::vector<std::string> sentences;
  for (const KnownFault& fault : known_faults) {
    if (version < fault.mended) sentences.emplace_back(fault.sentence);
  }
  return sentences;
}

}  // namespace todbench
