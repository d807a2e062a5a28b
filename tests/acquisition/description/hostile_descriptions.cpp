// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/acquisition/description/hostile_descriptions.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cstdint>

namespace todbench::testing_support {
namespace {

std::string reg(const std::string& name, const std::string& content) {
  return "<IntReg Name=\"" + name + "\">" + content + "<pPort>Device</pPort></IntReg>\n";
}

std::string knife(const std::string& name, const std::vector<std::string>& variables, const std::string& formula) {
  std::string out = "<IntSwissKnife Name=\"" + name + "\">";
  for (const auto& variable : variables) out += "<pVariable Name=\"" + variable + "\">" + variable + "</pVariable>";
  return out + "<Formula>" + formula + "</Formula></IntSwissKnife>\n";
}

std::string integer(const std::string& name, const std::string& content) {
  return "<Integer Name=\"" + name + "\">" + content + "</Integer>\n";
}

/// Bad, Bad1, Bad2, ... each made of the next.
template <typename MakeNode>
std::string chain(int links, MakeNode make) {
  std::string out;
  const auto name = [](int k) { return k == 0 ? std::string("Bad") : fmt::format("Bad{}", k); };
  for (int k = 0; k < links; ++k) out += make(name(k), name(k + 1));
  return out + integer(name(links), "<Value>1</Value>");
}

/// Little-endian; bytes beyond the value are 0.
void append(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i, value >>= 8U) out += static_cast<char>(value);
}

}  // namespace

std::vector<HostileDescription> hostile_descriptions() {
  const std::string self = "circular reference";
  return {
      {"ValueOfItself", integer("Bad", "<pValue>Bad</pValue>"), self},
      {"ValueOfAnother", integer("Bad", "<pValue>BadB</pValue>") + integer("BadB", "<pValue>Bad</pValue>"), self},
      {"Address", reg("Bad", "<pAddress>BadB</pAddress><Length>4</Length>") + integer("BadB", "<pValue>Bad</pValue>"),
       self},
      {"Index", reg("Bad", "<Address>0xD300</Address><pIndex>Bad</pIndex><Length>4</Length>"), self},
      {"OffsetOfIndex",
       reg("Bad", "<Address>0xD300</Address><pIndex pOffset=\"Bad\">Height</pIndex><Length>4</Length>"), self},
      {"RegisterLength", reg("Bad", "<Address>0xD300</Address><pLength>Bad</pLength>"), self},
      {"SwissKnife", knife("Bad", {"Bad"}, "Bad + 1"), self},
      {"SwissKnifeInAnAddress",
       reg("Bad", "<Address>0xD300</Address><Length>4</Length>" + knife("Inner", {"Bad"}, "Bad")), self},
      {"Converter",
       "<Converter Name=\"Bad\"><FormulaTo>FROM</FormulaTo><FormulaFrom>TO</FormulaFrom><pValue>Bad</pValue>"
       "</Converter>",
       self},
      {"IntConverter",
       "<IntConverter Name=\"Bad\"><pVariable Name=\"V\">Bad</pVariable><FormulaTo>FROM</FormulaTo>"
       "<FormulaFrom>TO</FormulaFrom><pValue>Height</pValue></IntConverter>",
       self},
      {"StructEntry",
       "<StructReg><pAddress>Bad</pAddress><Length>4</Length><pPort>Device</pPort>"
       "<StructEntry Name=\"Bad\"><LSB>0</LSB><MSB>7</MSB></StructEntry></StructReg>",
       self},
      {"ValueIndexed",
       integer("Bad",
               "<pIndex>Height</pIndex><pValueIndexed Index=\"1\">Bad</pValueIndexed>"
               "<pValueDefault>Bad</pValueDefault>"),
       self},
      {"Availability",
       integer("Bad", "<pIsAvailable>BadB</pIsAvailable><Value>1</Value>") + knife("BadB", {"BadB"}, "BadB"), self},
      {"Maximum", integer("Bad", "<pMax>BadB</pMax><Value>1</Value>") + knife("BadB", {"BadB"}, "BadB"), self},
      {"InAGroup", "<Group Comment=\"g\">" + integer("Bad", "<pValue>Bad</pValue>") + "</Group>", self},
      {"LongChain",
       chain(20000, [](const auto& name, const auto& next) { return integer(name, "<pValue>" + next + "</pValue>"); }),
       "chain of references"},
      {"Doubling",
       chain(60,
             [](const auto& name, const auto& next) {
               return knife(name, {next, next}, next);
             }),
       "evaluations"},
      {"LengthOfMinusOne", reg("Bad", "<Address>0xD300</Address><Length>-1</Length>"), "its length is -1 bytes"},
      {"LengthOfNothing", reg("Bad", "<Address>0xD300</Address><Length>0</Length>"), "its length is 0 bytes"},
      {"ImmenseLength", reg("Bad", "<Address>0xD300</Address><Length>4000000000</Length>"),
       "its length is 4000000000 bytes"},
      {"LengthInTheCamera", reg("Bad", "<Address>0xD300</Address><pLength>Height</pLength>"), "only the camera knows"},
      {"Division", knife("Bad", {}, "(1 &lt;&lt; 63) / (0 - 1)"), "divide the smallest integer"},
      {"DivisionByARegister",
       reg("Wide", "<Address>0xD300</Address><Length>8</Length>") + knife("Bad", {"Wide"}, "(1 &lt;&lt; 63) % Wide"),
       "divide the smallest integer"},
      {"LongFormula", knife("Bad", {}, std::string(40000, '(') + "1" + std::string(40000, ')')), "formula is too long"},
      {"ManyElements",
       [] {
         std::string out = integer("Bad", "<Value>1</Value>");
         for (int i = 0; i < 450'000; ++i) out += "<Group/>";
         return out;
       }(),
       "too many elements"},
      {"DeepElements",
       [] {
         std::string out;
         for (int i = 0; i < 5000; ++i) out += "<Group>";
         for (int i = 0; i < 5000; ++i) out += "</Group>";
         return out;
       }(),
       "not well-formed"},
      {"OpenElement", "<Group>", "not well-formed"},
      {"Description", "<RegisterDescription/>", "second RegisterDescription"},
      {"TwoOfOneName", integer("Bad", "<Value>1</Value>") + integer("Bad", "<Value>2</Value>"), "two nodes"},
      {"Nowhere", integer("Bad", "<pValue>Nowhere</pValue>"), "does not exist"}};
}

std::string with_hostile_nodes(std::string xml, const HostileDescription& hostile) {
  const std::string value = "<pValue>WidthRegister</pValue>";
  xml.replace(xml.find(value), value.size(), "<pValue>Bad</pValue>");
  return xml.insert(xml.find("</RegisterDescription>"), hostile.nodes);
}

std::string zip_archive(const std::string& content, std::uint32_t stated_bytes) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, content.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);

  const std::string name = "camera.xml";
  const auto bytes = stated_bytes != 0 ? std::uint64_t{stated_bytes} : content.size();
  const auto sizes = [&](std::string& out) {
    append(out, 20, 2);  // version needed
    append(out, 0, 2);
    append(out, 8, 2);  // deflated
    append(out, 0, 4);  // time and date
    append(out, crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())), 4);
    append(out, packed.size(), 4);
    append(out, bytes, 4);
    append(out, name.size(), 2);
    append(out, 0, 2);
  };
  std::string out;
  append(out, 0x04034b50, 4);
  sizes(out);
  out += name + packed;
  const std::size_t directory = out.size();
  append(out, 0x02014b50, 4);
  append(out, 20, 2);
  sizes(out);
  append(out, 0, 2 + 2 + 2 + 4);  // comment, disk, attributes
  append(out, 0, 4);              // offset of the local header
  out += name;
  const std::size_t directory_bytes = out.size() - directory;
  append(out, 0x06054b50, 4);
  append(out, 0, 4);
  append(out, 1, 2);
  append(out, 1, 2);
  append(out, directory_bytes, 4);
  append(out, directory, 4);
  append(out, 0, 2);
  return out;
}

}  // namespace todbench::testing_support
