// The XML text of a GenICam description as a list of nodes with their references. Says nothing of what they are worth.
//
// Read by the parser and in the mode that Aravis reads it with (libxml2, SAX 1), so that both see the same elements.
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

/// Most elements and pieces of text of a description. The largest published one has 29 000 elements.
inline constexpr std::size_t most_description_pieces = 400'000;

enum class NodeKind {
  other,        ///< Category, Port, Command, Converter and whatever else has no rule of its own
  reg,          ///< Register, IntReg, MaskedIntReg, FloatReg, StringReg, StructReg
  entry,        ///< StructEntry: bits of the StructReg that it is in
  integer,      ///< Integer
  enumeration,  ///< Enumeration
  swiss_knife,
  int_swiss_knife,
};

enum class ReferenceKind {
  value,      ///< pValue, pValueIndexed, pValueDefault: the value and, where nothing else is stated, its bounds
  part,       ///< pAddress, pIndex, pOffset, pVariable, pCommandValue: a part of the value
  length,     ///< pLength: of a register
  bound,      ///< pMin, pMax, pInc
  condition,  ///< pIsImplemented, pIsAvailable, pIsLocked
};

struct NodeReference {
  ReferenceKind kind = ReferenceKind::value;
  std::string target;  ///< name of a node, as it is in the text
  std::string name;    ///< of a pVariable: under which formulas know it
};

struct NamedText {
  std::string name, text;
};

struct DescriptionNode {
  std::string name;     ///< empty: none
  std::string element;  ///< "IntReg"
  NodeKind kind = NodeKind::other;
  std::vector<NodeReference> references;
  std::vector<std::size_t> parts;      ///< nodes inside a register or an enumeration that it asks
  std::optional<std::size_t> inside;   ///< of an entry: the register that it is in
  std::vector<std::string> lengths;    ///< <Length>, as it is in the text
  std::vector<std::string> values;     ///< <Value>
  std::vector<std::string> formulas;   ///< Formula, FormulaTo, FormulaFrom
  std::vector<NamedText> expressions;  ///< Expression
  std::vector<NamedText> constants;    ///< Constant
  bool is_signed = false;              ///< <Sign>Signed
};

struct DescriptionNodes {
  std::vector<DescriptionNode> nodes;
  std::unordered_map<std::string, std::size_t> by_name;  ///< of those that references can mean
};

/// The nodes, or why there are none: not_xml, entities, too_large, two_of_one_name. Takes time and memory in
/// proportion to the text, whatever it is.
[[nodiscard]] tl::expected<DescriptionNodes, DescriptionFault> parse_description(std::string_view xml);

/// A name from a camera as it may stand in a sentence: at most 64 characters, nothing but printable ASCII.
[[nodiscard]] std::string printable_name(std::string_view name);

}  // namespace todbench
