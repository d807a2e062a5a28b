// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/genicam/genicam_description.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>

namespace todbench {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string hex(std::uint32_t value) {
  return fmt::format("0x{:X}", value);
}

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string tag(const std::string& name, const std::string& content) {
  return "    <" + name + ">" + content + "</" + name + ">\n";
}

std::string access_mode(FeatureAccess access) {
  return access == FeatureAccess::read_only ? "RO" : access == FeatureAccess::write_only ? "WO" : "RW";
}

std::string opening(const std::string& element, const CameraFeature& feature) {
  return "  <" + element + " Name=\"" + feature.name + "\" NameSpace=\"Standard\">\n" +
         (feature.about.empty() ? "" : tag("Description", escaped(feature.about)));
}

bool lies_in_chunk(const CameraFeature& f) {
  return f.kind == FeatureKind::chunk_integer || f.kind == FeatureKind::chunk_scaled;
}

/// Node that reads the bytes. Features refer to it by name.
std::string register_node(const CameraFeature& f, std::endian order) {
  const bool floating = f.kind == FeatureKind::ieee_float || f.kind == FeatureKind::formula;
  const bool has_sign = f.kind == FeatureKind::scaled || f.kind == FeatureKind::chunk_scaled;
  const std::string element = floating ? "FloatReg" : f.kind == FeatureKind::bit ? "MaskedIntReg" : "IntReg";
  std::string out = "  <" + element + " Name=\"" + f.name + "Register\" NameSpace=\"Custom\">\n";
  out += tag("Address", hex(f.address)) + tag("Length", std::to_string(register_bytes(f)));
  out += tag("AccessMode", access_mode(f.access)) + tag("pPort", lies_in_chunk(f) ? f.name + "Port" : "Device");
  out += tag("Cachable", "NoCache");
  if (f.kind == FeatureKind::bit) out += tag("Bit", std::to_string(f.bit));
  if (!floating) out += tag("Sign", has_sign ? "Signed" : "Unsigned");
  return out + tag("Endianess", order == std::endian::big ? "BigEndian" : "LittleEndian") + "  </" + element + ">\n";
}

std::string value_node(const CameraFeature& f) {
  return tag("pValue", f.name + "Register");
}

std::string read_only_mark(const CameraFeature& f) {
  return f.access == FeatureAccess::read_only ? tag("ImposedAccessMode", "RO") : "";
}

std::string lock_mark(const CameraFeature& f) {
  return f.locked_while_streaming ? tag("pIsLocked", "TLParamsLocked") : "";
}

std::string integer(const CameraFeature& f) {
  std::string out = opening("Integer", f) + read_only_mark(f) + lock_mark(f) + value_node(f);
  if (f.least != f.most) out += tag("Min", std::to_string(f.least)) + tag("Max", std::to_string(f.most));
  return out + "  </Integer>\n";
}

std::string enumeration(const CameraFeature& f) {
  std::string out = opening("Enumeration", f) + read_only_mark(f) + lock_mark(f);
  for (const auto& [name, value] : f.entries) {
    out += "    <EnumEntry Name=\"" + name + "\" NameSpace=\"Standard\"><Value>" + std::to_string(value) +
           "</Value></EnumEntry>\n";
  }
  return out + value_node(f) + "  </Enumeration>\n";
}

std::string converter(const CameraFeature& f, const std::string& to, const std::string& from) {
  return opening("Converter", f) + tag("FormulaTo", to) + tag("FormulaFrom", from) + value_node(f) + "  </Converter>\n";
}

std::string rate(const CameraFeature& f) {
  CameraFeature period = f;
  period.name += "Converter";
  // The register has the name of the feature.
  return opening("Float", f) + tag("pValue", period.name) + tag("Min", shortest(least_rate_hz)) +
         tag("Max", shortest(most_rate_hz)) + tag("Unit", "Hz") + "  </Float>\n" + opening("Converter", period) +
         tag("FormulaTo", "1000000 / FROM") + tag("FormulaFrom", "1000000 / TO") + value_node(f) + "  </Converter>\n";
}

std::string formula(const CameraFeature& f) {
  return opening("SwissKnife", f) + "    <pVariable Name=\"VALUE\">" + f.name + "Register</pVariable>\n" +
         "    <pVariable Name=\"CHOICE\">" + f.choice + "Register</pVariable>\n" + tag("Formula", escaped(f.formula)) +
         "  </SwissKnife>\n";
}

/// Node that clients use.
std::string feature_node(const CameraFeature& f) {
  const std::string factor = shortest(f.per_raw);
  switch (f.kind) {
    case FeatureKind::integer:
    case FeatureKind::chunk_integer:
      return integer(f);
    case FeatureKind::enumeration:
      return enumeration(f);
    case FeatureKind::command:
      return opening("Command", f) + value_node(f) + tag("CommandValue", std::to_string(f.initial)) + "  </Command>\n";
    case FeatureKind::scaled:
    case FeatureKind::chunk_scaled:
      if (f.offset == 0) return converter(f, "FROM / " + factor, "TO * " + factor);
      return converter(f, "(FROM - " + shortest(f.offset) + ") / " + factor,
                       "TO * " + factor + " + " + shortest(f.offset));
    case FeatureKind::rate:
      return rate(f);
    case FeatureKind::ieee_float:
      return opening("Float", f) + read_only_mark(f) + value_node(f) + "  </Float>\n";
    case FeatureKind::formula:
      return formula(f);
    case FeatureKind::text:
      return opening("StringReg", f) + tag("Address", hex(f.address)) + tag("Length", std::to_string(f.bytes)) +
             tag("AccessMode", access_mode(f.access)) + tag("pPort", "Device") + "  </StringReg>\n";
    case FeatureKind::bit:
      return opening("Boolean", f) + value_node(f) + tag("OnValue", "1") + tag("OffValue", "0") + "  </Boolean>\n";
  }
  return {};
}

std::string chunk_port(const CameraFeature& f) {
  return "  <Port Name=\"" + f.name + "Port\" NameSpace=\"Custom\">\n" +
         tag("ChunkID", fmt::format("{:08X}", f.chunk_id)) + "  </Port>\n";
}

std::string nodes(const CameraFeature& f, std::endian order) {
  return feature_node(f) + (f.kind == FeatureKind::text ? "" : register_node(f, order)) +
         (lies_in_chunk(f) ? chunk_port(f) : "");
}

std::string category(const std::string& name, const std::vector<std::string>& members) {
  std::string out = "  <Category Name=\"" + name + "\" NameSpace=\"Standard\">\n";
  for (const auto& member : members) out += tag("pFeature", member);
  return out + "  </Category>\n";
}

/// Bytes of a number as in memory.
std::vector<std::uint8_t> in_order(std::uint64_t value, std::uint32_t bytes, std::endian order) {
  std::vector<std::uint8_t> out(bytes);
  for (std::uint32_t i = 0; i < bytes; ++i) {
    out[order == std::endian::little ? i : bytes - 1 - i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
  return out;
}

std::vector<std::uint8_t> power_up_bytes(const CameraFeature& f, std::endian order) {
  if (f.kind == FeatureKind::text) {
    std::vector<std::uint8_t> field(f.bytes);
    std::copy_n(f.text.begin(), std::min<std::size_t>(f.text.size(), f.bytes - 1), field.begin());
    return field;
  }
  const bool floating = f.kind == FeatureKind::ieee_float || f.kind == FeatureKind::formula;
  const std::uint64_t value = floating                         ? std::bit_cast<std::uint64_t>(f.real)
                              : f.kind == FeatureKind::command ? 0
                                                               : f.initial;
  return in_order(value, register_bytes(f), order);
}

}  // namespace

bool owns_register(const CameraFeature& f) {
  return !lies_in_chunk(f) && f.kind != FeatureKind::bit;
}

std::uint32_t register_bytes(const CameraFeature& f) {
  return f.kind == FeatureKind::ieee_float || f.kind == FeatureKind::formula ? 8 : f.bytes;
}

std::vector<RegisterContent> power_up_contents(const CameraDescription& description) {
  std::vector<RegisterContent> contents;
  for (const auto& [category, features] : description.categories) {
    for (const auto& f : features) {
      if (owns_register(f)) contents.push_back({f.address, power_up_bytes(f, description.order)});
    }
  }
  return contents;
}

std::string genicam_xml(const CameraDescription& description) {
  std::string out = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<RegisterDescription ModelName=\"" +
                    escaped(description.model) + "\" VendorName=\"" + escaped(description.vendor) +
                    "\" StandardNameSpace=\"" + description.name_space +
                    "\" SchemaMajorVersion=\"1\" SchemaMinorVersion=\"1\" "
                    "SchemaSubMinorVersion=\"0\" MajorVersion=\"1\" MinorVersion=\"0\" SubMinorVersion=\"0\" "
                    "ProductGuid=\"2b0f2c1e-6a7d-4f2e-9d0c-5a1b7c3e8f10\" "
                    "VersionGuid=\"2b0f2c1e-6a7d-4f2e-9d0c-5a1b7c3e8f11\" "
                    "xmlns=\"http://www.genicam.org/GenApi/Version_1_1\">\n";
  std::vector<std::string> names;
  for (const auto& [name, features] : description.categories) names.push_back(name);
  out += category("Root", names);
  for (const auto& [name, features] : description.categories) {
    std::vector<std::string> members;
    for (const auto& f : features) members.push_back(f.name);
    out += category(name, members);
    for (const auto& f : features) out += nodes(f, description.order);
  }
  out += "  <Integer Name=\"TLParamsLocked\" NameSpace=\"Standard\">\n" + tag("Value", "0") + "  </Integer>\n";
  out += "  <Port Name=\"Device\" NameSpace=\"Standard\">\n" + tag("Description", "Registers of the camera") +
         "  </Port>\n";
  return out + "</RegisterDescription>\n";
}

}  // namespace todbench
