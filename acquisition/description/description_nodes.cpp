// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/description/description_nodes.h"

#include <libxml/parser.h>
#include <libxml/parserInternals.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <utility>

namespace todbench {
namespace {

struct ElementKind {
  std::string_view name;
  NodeKind kind;
};
/// Elements that are nodes.
constexpr std::array node_elements{ElementKind{"Category", NodeKind::other},
                                   ElementKind{"Command", NodeKind::other},
                                   ElementKind{"Converter", NodeKind::other},
                                   ElementKind{"IntConverter", NodeKind::other},
                                   ElementKind{"Register", NodeKind::reg},
                                   ElementKind{"IntReg", NodeKind::reg},
                                   ElementKind{"MaskedIntReg", NodeKind::reg},
                                   ElementKind{"FloatReg", NodeKind::reg},
                                   ElementKind{"StringReg", NodeKind::reg},
                                   ElementKind{"StructReg", NodeKind::reg},
                                   ElementKind{"StructEntry", NodeKind::entry},
                                   ElementKind{"String", NodeKind::other},
                                   ElementKind{"Integer", NodeKind::integer},
                                   ElementKind{"Float", NodeKind::other},
                                   ElementKind{"Boolean", NodeKind::other},
                                   ElementKind{"Enumeration", NodeKind::enumeration},
                                   ElementKind{"EnumEntry", NodeKind::other},
                                   ElementKind{"SwissKnife", NodeKind::swiss_knife},
                                   ElementKind{"IntSwissKnife", NodeKind::int_swiss_knife},
                                   ElementKind{"Port", NodeKind::other}};

struct ReferenceElement {
  std::string_view name;
  ReferenceKind kind;
};
/// Elements whose text names a node that is evaluated. The others (pSelected, pInvalidator, pPort, pFeature) are not
/// evaluated, and cameras have cycles of them.
constexpr std::array reference_elements{ReferenceElement{"pValue", ReferenceKind::value},
                                        ReferenceElement{"pValueIndexed", ReferenceKind::value},
                                        ReferenceElement{"pValueDefault", ReferenceKind::value},
                                        ReferenceElement{"pAddress", ReferenceKind::part},
                                        ReferenceElement{"pIndex", ReferenceKind::part},
                                        ReferenceElement{"pVariable", ReferenceKind::part},
                                        ReferenceElement{"pCommandValue", ReferenceKind::part},
                                        ReferenceElement{"pLength", ReferenceKind::length},
                                        ReferenceElement{"pMin", ReferenceKind::bound},
                                        ReferenceElement{"pMax", ReferenceKind::bound},
                                        ReferenceElement{"pInc", ReferenceKind::bound},
                                        ReferenceElement{"pIsImplemented", ReferenceKind::condition},
                                        ReferenceElement{"pIsAvailable", ReferenceKind::condition},
                                        ReferenceElement{"pIsLocked", ReferenceKind::condition}};

/// Other known elements; an unknown element is skipped with its content.
constexpr std::array<std::string_view, 36> plain_elements{"RegisterDescription",
                                                          "Group",
                                                          "pFeature",
                                                          "Value",
                                                          "Address",
                                                          "Description",
                                                          "Visibility",
                                                          "ToolTip",
                                                          "DisplayName",
                                                          "Min",
                                                          "Max",
                                                          "Inc",
                                                          "IsLinear",
                                                          "Slope",
                                                          "Unit",
                                                          "Representation",
                                                          "OnValue",
                                                          "OffValue",
                                                          "pSelected",
                                                          "Length",
                                                          "pPort",
                                                          "ValueIndexed",
                                                          "ValueDefault",
                                                          "Formula",
                                                          "FormulaTo",
                                                          "FormulaFrom",
                                                          "Expression",
                                                          "Constant",
                                                          "AccessMode",
                                                          "ImposedAccessMode",
                                                          "Cachable",
                                                          "PollingTime",
                                                          "Endianess",
                                                          "Sign",
                                                          "pInvalidator",
                                                          "Streamable"};
constexpr std::array<std::string_view, 8> more_plain_elements{
    "LSB", "MSB", "Bit", "CommandValue", "ChunkID", "EventID", "DisplayNotation", "DisplayPrecision"};

template <typename Table>
auto row_of(const Table& table, std::string_view name) {
  return std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.name == name; });
}

bool is_understood(std::string_view element) {
  return row_of(node_elements, element) != node_elements.end() ||
         row_of(reference_elements, element) != reference_elements.end() ||
         std::find(plain_elements.begin(), plain_elements.end(), element) != plain_elements.end() ||
         std::find(more_plain_elements.begin(), more_plain_elements.end(), element) != more_plain_elements.end();
}

std::string_view text_of(const xmlChar* text) {
  return text != nullptr ? std::string_view(reinterpret_cast<const char*>(text)) : std::string_view();
}

/// The value of an attribute; empty if absent.
std::string_view attribute(const xmlChar** attributes, std::string_view name) {
  for (; attributes != nullptr && attributes[0] != nullptr && attributes[1] != nullptr; attributes += 2) {
    if (text_of(attributes[0]) == name) return text_of(attributes[1]);
  }
  return {};
}

/// State of the parsing.
class Reader {
 public:
  explicit Reader(xmlParserCtxtPtr parser) : parser_(parser) {}

  void start(std::string_view element, const xmlChar** attributes);
  void end();
  void characters(std::string_view text);
  void document_type() {
    give_up({DescriptionFaultKind::entities, "", "it has a document type declaration, which is not accepted"});
  }

  [[nodiscard]] const std::optional<DescriptionFault>& fault() const { return fault_; }
  [[nodiscard]] bool has_root() const { return has_root_; }
  [[nodiscard]] DescriptionNodes take() { return std::move(found_); }

 private:
  struct Open {
    std::string element;
    std::optional<std::size_t> node;  ///< index of the node, if this element is one
    std::string name, offset, text;
  };

  void give_up(DescriptionFault fault) {
    if (!fault_) fault_ = std::move(fault);
    xmlStopParser(parser_);
  }
  [[nodiscard]] bool count_piece() {
    if (++pieces_ > most_description_pieces) {
      give_up({DescriptionFaultKind::too_large, "", "it has too many elements"});
    }
    return !fault_;
  }
  [[nodiscard]] std::optional<std::size_t> enclosing_node() const {
    for (auto open = open_.rbegin(); open != open_.rend(); ++open) {
      if (open->node) return open->node;
    }
    return std::nullopt;
  }
  [[nodiscard]] std::size_t add_node(const ElementKind& row, std::string_view name);
  void store(const Open& done);

  xmlParserCtxtPtr parser_;
  DescriptionNodes found_;
  std::optional<DescriptionFault> fault_;
  std::vector<Open> open_;
  std::size_t pieces_ = 0, skipped_depth_ = 0;
  bool has_root_ = false;
};

std::size_t Reader::add_node(const ElementKind& row, std::string_view name) {
  const std::size_t index = found_.nodes.size();
  const auto around = enclosing_node();
  DescriptionNode node;
  node.name = name;
  node.element = row.name;
  node.kind = row.kind;
  if (around) {
    const NodeKind outer = found_.nodes[*around].kind;
    if (row.kind == NodeKind::entry) {
      node.inside = around;
    } else if (outer == NodeKind::reg || outer == NodeKind::enumeration) {
      found_.nodes[*around].parts.push_back(index);
    }
  }
  found_.nodes.push_back(std::move(node));
  // Entries of enumerations have names of their own, to which references never refer.
  if (!name.empty() && row.name != "EnumEntry" && !found_.by_name.emplace(name, index).second) {
    give_up({DescriptionFaultKind::two_of_one_name, printable_name(name), "two nodes have this name"});
  }
  return index;
}

void Reader::start(std::string_view element, const xmlChar** attributes) {
  if (fault_ || !count_piece()) return;
  if (!has_root_) {
    has_root_ = true;
    if (element != "RegisterDescription") {
      return give_up({DescriptionFaultKind::not_xml, "", "its root element is not RegisterDescription"});
    }
  } else if (element == "RegisterDescription") {
    return give_up({DescriptionFaultKind::not_xml, "", "it contains a second RegisterDescription"});
  }
  if (skipped_depth_ > 0 || !is_understood(element)) {
    ++skipped_depth_;
    return;
  }
  Open open;
  open.element = element;
  open.name = attribute(attributes, "Name");
  open.offset = attribute(attributes, "pOffset");
  if (const auto row = row_of(node_elements, element); row != node_elements.end()) {
    open.node = add_node(*row, open.name);
  }
  open_.push_back(std::move(open));
}

void Reader::end() {
  if (fault_) return;
  if (skipped_depth_ > 0) {
    --skipped_depth_;
    return;
  }
  if (open_.empty()) return;
  const Open done = std::move(open_.back());
  open_.pop_back();
  if (!done.node) store(done);
}

void Reader::characters(std::string_view text) {
  if (fault_ || !count_piece() || skipped_depth_ > 0 || open_.empty()) return;
  // Only the text of properties has a meaning and is kept.
  const auto& element = open_.back().element;
  if (open_.back().node || element == "Description" || element == "ToolTip") return;
  open_.back().text += text;
}

void Reader::store(const Open& done) {
  const auto around = enclosing_node();
  if (!around) return;
  DescriptionNode& node = found_.nodes[*around];
  if (const auto row = row_of(reference_elements, done.element); row != reference_elements.end()) {
    node.references.push_back({row->kind, done.text, done.name});
    if (!done.offset.empty()) node.references.push_back({ReferenceKind::part, done.offset, {}});
    return;
  }
  if (done.element == "Length") node.lengths.push_back(done.text);
  if (done.element == "Value" || done.element == "ValueIndexed" || done.element == "ValueDefault") {
    node.values.push_back(done.text);
  }
  if (done.element == "Sign") node.is_signed = node.is_signed || done.text != "Unsigned";
  if (done.element == "Formula" || done.element == "FormulaTo" || done.element == "FormulaFrom") {
    node.formulas.push_back(done.text);
  }
  if (done.element == "Expression") node.expressions.push_back({done.name, done.text});
  if (done.element == "Constant") node.constants.push_back({done.name, done.text});
}

struct FreeParser {
  void operator()(xmlParserCtxtPtr parser) const {
    // The handler belongs to this file.
    parser->sax = nullptr;
    xmlFreeParserCtxt(parser);
  }
};

Reader& reader(void* data) {
  return *static_cast<Reader*>(data);
}

/// Callbacks of the first SAX interface: names with their prefixes, as in the client. No callback loads anything.
xmlSAXHandler handler() {
  xmlSAXHandler calls{};
  calls.startElement = [](void* data, const xmlChar* name, const xmlChar** attributes) {
    reader(data).start(text_of(name), attributes);
  };
  calls.endElement = [](void* data, const xmlChar*) { reader(data).end(); };
  calls.characters = [](void* data, const xmlChar* text, int bytes) {
    reader(data).characters({reinterpret_cast<const char*>(text), static_cast<std::size_t>(bytes)});
  };
  calls.internalSubset = [](void* data, const xmlChar*, const xmlChar*, const xmlChar*) {
    reader(data).document_type();
  };
  return calls;
}

}  // namespace

tl::expected<DescriptionNodes, DescriptionFault> parse_description(std::string_view xml) {
  const auto refused = [](const char* why) {
    return tl::unexpected(DescriptionFault{DescriptionFaultKind::not_xml, "", why});
  };
  if (xml.empty() || xml.size() > std::numeric_limits<int>::max() / 2) return refused("it is empty or too large");
  xmlInitParser();
  const std::unique_ptr<xmlParserCtxt, FreeParser> parser(
      xmlCreateMemoryParserCtxt(xml.data(), static_cast<int>(xml.size())));
  if (!parser) return refused("it cannot be read");
  if (parser->sax != nullptr) xmlFree(parser->sax);
  xmlSAXHandler calls = handler();
  Reader read(parser.get());
  parser->sax = &calls;
  parser->userData = &read;
  xmlParseDocument(parser.get());
  if (read.fault()) return tl::unexpected(*read.fault());
  if (parser->wellFormed == 0) return refused("it is not well-formed XML");
  if (!read.has_root()) return refused("its root element is not RegisterDescription");
  return read.take();
}

std::string printable_name(std::string_view name) {
  std::string out;
  for (const char c : name.substr(0, 64)) out += c > ' ' && c < 0x7F ? c : '?';
  return out;
}

}  // namespace todbench
