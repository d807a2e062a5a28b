// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of the description of a GenICam camera.
#pragma once

#include <string>

namespace todbench {

/// Reason why the client must not evaluate a description or one of its features.
enum class DescriptionFaultKind {
  not_xml,          ///< not well-formed, or no RegisterDescription
  entities,         ///< has a document type, which may declare entities
  too_large,        ///< more elements or text than any camera requires
  two_of_one_name,  ///< two nodes of the same name, which makes references ambiguous
  cycle,            ///< a circular reference
  too_deep,         ///< a chain of references longer than any camera requires
  too_expensive,    ///< a value that needs more evaluations than any camera requires
  register_length,  ///< a register whose length is zero, negative or excessive
  formula,          ///< longer than any camera requires
  division,         ///< an integer division that can raise SIGFPE
  dangling,         ///< a reference to a node that does not exist
};

/// A fault and its location.
struct DescriptionFault {
  DescriptionFaultKind kind = DescriptionFaultKind::not_xml;
  std::string node;      ///< printable name; empty: the description as a whole
  std::string sentence;  ///< printable message without the name of the node: "its length is -1 bytes"
};

}  // namespace todbench
