// What is wrong with the description of a GenICam camera.
#pragma once

#include <string>

namespace todbench {

/// Why a description, or a feature of it, is not given to the client that would evaluate it.
enum class DescriptionFaultKind {
  not_xml,          ///< not well-formed, or no RegisterDescription
  entities,         ///< has a document type, which may declare entities
  too_large,        ///< more elements or text than any camera needs
  two_of_one_name,  ///< which of the two a reference means is not defined
  cycle,            ///< a value that is needed to find itself
  too_deep,         ///< a chain of references that is longer than any camera needs
  too_expensive,    ///< a value that takes more evaluations than any camera needs
  register_length,  ///< a register of no, negative or immense length
  formula,          ///< longer than any camera needs
  division,         ///< a whole number divided such that a processor may trap
  dangling,         ///< a reference to a node that does not exist
};

struct DescriptionFault {
  DescriptionFaultKind kind = DescriptionFaultKind::not_xml;
  std::string node;      ///< its name, printable; empty: the description as a whole
  std::string sentence;  ///< for people, printable, without the node of its beginning: "its length is -1 bytes"
};

}  // namespace todbench
