#include "sim_devices/lab/gige/genicam_description.h"

#include <fmt/format.h>
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

/// The node that reads the bytes; features refer to it by name.
std::string register_node(const CameraFeature& f, const std::string& port, const std::string& sign) {
  const bool floating = f.kind == FeatureKind::ieee_float;
  const std::string element = floating ? "FloatReg" : f.kind == FeatureKind::bit ? "MaskedIntReg" : "IntReg";
  std::string out = "  <" + element + " Name=\"" + f.name + "Register\" NameSpace=\"Custom\">\n";
  out += tag("Address", hex(f.address)) + tag("Length", std::to_string(f.bytes));
  out += tag("AccessMode", access_mode(f.access)) + tag("pPort", port) + tag("Cachable", "NoCache");
  if (f.kind == FeatureKind::bit) out += tag("Bit", std::to_string(f.bit));
  if (!floating) out += tag("Sign", sign);
  return out + tag("Endianess", "BigEndian") + "  </" + element + ">\n";
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
  if (f.step != 1) out += tag("Inc", std::to_string(f.step));
  return out + "  </Integer>\n" + register_node(f, "Device", "Unsigned");
}

std::string enumeration(const CameraFeature& f) {
  std::string out = opening("Enumeration", f) + read_only_mark(f) + lock_mark(f);
  for (const auto& [name, value] : f.entries) {
    out += "    <EnumEntry Name=\"" + name + "\" NameSpace=\"Standard\"><Value>" + std::to_string(value) +
           "</Value></EnumEntry>\n";
  }
  return out + value_node(f) + "  </Enumeration>\n" + register_node(f, "Device", "Unsigned");
}

std::string command(const CameraFeature& f) {
  return opening("Command", f) + value_node(f) + tag("CommandValue", std::to_string(f.initial)) + "  </Command>\n" +
         register_node(f, "Device", "Unsigned");
}

std::string scaled(const CameraFeature& f, const std::string& port) {
  const std::string factor = shortest(f.per_raw);
  return opening("Converter", f) + tag("FormulaTo", "FROM / " + factor) + tag("FormulaFrom", "TO * " + factor) +
         value_node(f) + "  </Converter>\n" + register_node(f, port, "Signed");
}

std::string text_register(const CameraFeature& f) {
  return opening("StringReg", f) + tag("Address", hex(f.address)) + tag("Length", std::to_string(f.bytes)) +
         tag("AccessMode", access_mode(f.access)) + tag("pPort", "Device") + "  </StringReg>\n";
}

std::string chunk_port(const CameraFeature& f) {
  return "  <Port Name=\"" + f.name + "Port\" NameSpace=\"Custom\">\n" +
         tag("ChunkID", fmt::format("{:08X}", f.chunk_id)) + "  </Port>\n";
}

std::string node(const CameraFeature& f) {
  switch (f.kind) {
    case FeatureKind::integer:
      return integer(f);
    case FeatureKind::enumeration:
      return enumeration(f);
    case FeatureKind::command:
      return command(f);
    case FeatureKind::scaled:
      return scaled(f, "Device");
    case FeatureKind::ieee_float:
      return opening("Float", f) + read_only_mark(f) + value_node(f) + "  </Float>\n" + register_node(f, "Device", "");
    case FeatureKind::text:
      return text_register(f);
    case FeatureKind::bit:
      return opening("Boolean", f) + value_node(f) + tag("OnValue", "1") + tag("OffValue", "0") + "  </Boolean>\n" +
             register_node(f, "Device", "Unsigned");
    case FeatureKind::chunk_integer:
      return opening("Integer", f) + value_node(f) + "  </Integer>\n" + register_node(f, f.name + "Port", "Unsigned") +
             chunk_port(f);
    case FeatureKind::chunk_scaled:
      return scaled(f, f.name + "Port") + chunk_port(f);
  }
  return {};
}

std::string category(const std::string& name, const std::vector<std::string>& members) {
  std::string out = "  <Category Name=\"" + name + "\" NameSpace=\"Standard\">\n";
  for (const auto& member : members) out += tag("pFeature", member);
  return out + "  </Category>\n";
}

}  // namespace

std::string genicam_xml(const CameraDescription& description) {
  std::string out = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<RegisterDescription ModelName=\"" +
                    escaped(description.model) + "\" VendorName=\"" + escaped(description.vendor) +
                    "\" StandardNameSpace=\"GEV\" SchemaMajorVersion=\"1\" SchemaMinorVersion=\"1\" "
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
    for (const auto& f : features) out += node(f);
  }
  out += "  <Integer Name=\"TLParamsLocked\" NameSpace=\"Standard\">\n" + tag("Value", "0") + "  </Integer>\n";
  out += "  <Port Name=\"Device\" NameSpace=\"Standard\">\n" + tag("Description", "Registers of the camera") +
         "  </Port>\n";
  return out + "</RegisterDescription>\n";
}

}  // namespace todbench
