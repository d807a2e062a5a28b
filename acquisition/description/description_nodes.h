// SPDX-License-Identifier: GPL-3.0-or-later
// Parses the XML text of a GenICam description into nodes with their references. Does not judge their values.
//
// Uses the parser and the mode of Aravis (libxml2, SAX 1), because both must read the same elements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <unordered_map>
#include <vector>

#include "acquisition/description/description_fault.h"

namespace todbench {

/// Maximum number of elements and text pieces of a description. The largest published description has 29 000 elements.
inline constexpr std::size_t most_description_pieces = 400'000;

/// Kinds of nodes.
enum class NodeKind {
  other,        ///< Category, Port, Command, Converter and all other elements
  reg,          ///< Register, IntReg, MaskedIntReg, FloatReg, StringReg, StructReg
  entry,        ///< StructEntry: bits of its StructReg
  integer,      ///< Integer
  enumeration,  ///< Enumeration
  swiss_knife,
  int_swiss_knife,
};

/// Kinds of references between nodes.
enum class ReferenceKind {
  value,      ///< pValue, pValueIndexed, pValueDefault: the value and, unless stated otherwise, its bounds
  part,       ///< pAddress, pIndex, pOffset, pVariable, pCommandValue: a number from which the value is computed
  length,     ///< pLength: of a register
  bound,      ///< pMin, pMax, pInc
  condition,  ///< pIsImplemented, pIsAvailable, pIsLocked
};

/// A reference to a node.
struct NodeReference {
  ReferenceKind kind = ReferenceKind::value;
  std::string target;  ///< name of a node, as in the text
  std::string name;    ///< name in formulas; only for a pVariable
};

/// A text with its name.
struct NamedText {
  std::string name, text;
};

/// A node of a description.
struct DescriptionNode {
  std::string name;     ///< empty: without name
  std::string element;  ///< "IntReg"
  NodeKind kind = NodeKind::other;
  std::vector<NodeReference> references;
  std::vector<std::size_t> parts;      ///< indices of the nodes inside this register or enumeration that it reads
  std::optional<std::size_t> inside;   ///< register that contains an entry
  std::vector<std::string> lengths;    ///< <Length>, as in the text
  std::vector<std::string> values;     ///< <Value>
  std::vector<std::string> formulas;   ///< Formula, FormulaTo, FormulaFrom
  std::vector<NamedText> expressions;  ///< Expression
  std::vector<NamedText> constants;    ///< Constant
  bool is_signed = false;              ///< <Sign>Signed
};

/// All nodes of a description.
struct DescriptionNodes {
  std::vector<DescriptionNode> nodes;
  std::unordered_map<std::string, std::size_t> by_name;  ///< nodes that references can address
};

/// Returns the nodes. Errors: not_xml, entities, too_large, two_of_one_name. Time and memory are proportional to the
/// length of the text, for any text.
[[nodiscard]] tl::expected<DescriptionNodes, DescriptionFault> parse_description(std::string_view xml);

/// Makes a name from a camera safe for messages: at most 64 characters of printable ASCII.
[[nodiscard]] std::string printable_name(std::string_view name);

}  // namespace todbench
