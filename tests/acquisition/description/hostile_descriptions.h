// SPDX-License-Identifier: GPL-3.0-or-later
// GenICam descriptions that no camera should have, made from that of an emulated one.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

namespace todbench::testing_support {

struct HostileDescription {
  std::string name;   ///< letters
  std::string nodes;  ///< among them one "Bad", which becomes the value of Width
  std::string says;   ///< is in the sentence of the refusal
};

/// Each ends a client that evaluates it, has it wait without end, or has it take what does not exist for 0.
[[nodiscard]] std::vector<HostileDescription> hostile_descriptions();

/// The description of an emulated camera with these nodes.
[[nodiscard]] std::string with_hostile_nodes(std::string xml, const HostileDescription& hostile);

/// An archive of one file, deflated, whose directory states `stated_bytes` for its size; 0: the true one.
[[nodiscard]] std::string zip_archive(const std::string& content, std::uint32_t stated_bytes = 0);

inline void PrintTo(const HostileDescription& hostile, std::ostream* out) {
  *out << hostile.name;
}

}  // namespace todbench::testing_support
