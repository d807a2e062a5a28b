// SPDX-License-Identifier: GPL-3.0-or-later
// Whole GenICam descriptions: the guard first, then, where it has nothing against them, Aravis itself. Every feature is
// evaluated on a camera whose registers hold anything, as the back end would. What ends or stops Aravis is a hole in
// the guard.
#include <arv.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/description/description.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace todbench;

/// Registers hold numbers at the limits, decided by their address: the same for the same input.
constexpr std::array<std::uint64_t, 8> register_words{
    0, 1, 4, 0x7FFFFFFFFFFFFFFF, 0x8000000000000000, 0xFFFFFFFFFFFFFFFF, 0x0000000080000000, 0x0000002000000010};

gboolean read_memory(ArvDevice*, guint64 address, guint32 size, void* buffer, GError**) {
  for (guint32 at = 0; at < size; ++at) {
    const std::uint64_t word = register_words[(address >> 2U) % register_words.size()];
    static_cast<std::uint8_t*>(buffer)[at] = static_cast<std::uint8_t>(word >> (8 * (at % 8)));
  }
  return TRUE;
}

/// Of what the interface of Aravis takes: in some versions the buffer is const.
template <typename Buffer>
gboolean write_memory(ArvDevice*, guint64, guint32, Buffer, GError**) {
  return TRUE;
}

gboolean read_register(ArvDevice* device, guint64 address, guint32* value, GError** error) {
  return read_memory(device, address, sizeof *value, value, error);
}

gboolean write_register(ArvDevice*, guint64, guint32, GError**) {
  return TRUE;
}

void make_class(void* device_class, void*) {
  auto* calls = static_cast<ArvDeviceClass*>(device_class);
  calls->read_memory = &read_memory;
  calls->write_memory = &write_memory;
  calls->read_register = &read_register;
  calls->write_register = &write_register;
}

ArvDevice* make_camera() {
  GTypeQuery parent;
  g_type_query(ARV_TYPE_DEVICE, &parent);
  const GType type = g_type_register_static_simple(ARV_TYPE_DEVICE, "TodbenchFuzzedCamera", parent.class_size,
                                                   &make_class, parent.instance_size, nullptr, GTypeFlags{});
  return ARV_DEVICE(g_object_new(type, nullptr));
}

void evaluate_number(ArvGcNode* node) {
  if (ARV_IS_GC_INTEGER(node)) {
    ArvGcInteger* integer = ARV_GC_INTEGER(node);
    arv_gc_integer_get_value(integer, nullptr);
    arv_gc_integer_get_min(integer, nullptr);
    arv_gc_integer_get_max(integer, nullptr);
    arv_gc_integer_get_inc(integer, nullptr);
  }
  if (ARV_IS_GC_FLOAT(node)) {
    ArvGcFloat* number = ARV_GC_FLOAT(node);
    arv_gc_float_get_value(number, nullptr);
    arv_gc_float_get_min(number, nullptr);
    arv_gc_float_get_max(number, nullptr);
    arv_gc_float_get_inc(number, nullptr);
  }
  if (ARV_IS_GC_BOOLEAN(node)) arv_gc_boolean_get_value(ARV_GC_BOOLEAN(node), nullptr);
}

void evaluate(ArvGcNode* node) {
  if (!ARV_IS_GC_FEATURE_NODE(node)) return;
  ArvGcFeatureNode* feature = ARV_GC_FEATURE_NODE(node);
  arv_gc_feature_node_is_available(feature, nullptr);
  arv_gc_feature_node_is_implemented(feature, nullptr);
  arv_gc_feature_node_is_locked(feature, nullptr);
  arv_gc_feature_node_get_actual_access_mode(feature);
  evaluate_number(node);
  if (ARV_IS_GC_STRING(node)) {
    arv_gc_string_get_value(ARV_GC_STRING(node), nullptr);
    arv_gc_string_get_max_length(ARV_GC_STRING(node), nullptr);
  }
  if (ARV_IS_GC_ENUMERATION(node)) {
    guint count = 0;
    g_free(arv_gc_enumeration_dup_available_string_values(ARV_GC_ENUMERATION(node), &count, nullptr));
    arv_gc_enumeration_get_string_value(ARV_GC_ENUMERATION(node), nullptr);
  }
  if (ARV_IS_GC_COMMAND(node)) arv_gc_command_execute(ARV_GC_COMMAND(node), nullptr);
}

bool lengths_are_good(const Description& description, const std::string& feature, ArvGc* genicam) {
  for (const auto& name : description.lengths_of(feature)) {
    ArvGcNode* node = arv_gc_get_node(genicam, name.c_str());
    if (!ARV_IS_GC_INTEGER(node)) return false;
    const auto bytes = arv_gc_integer_get_value(ARV_GC_INTEGER(node), nullptr);
    if (bytes < 1 || bytes > longest_register_bytes) return false;
  }
  return true;
}

void quiet(const gchar*, GLogLevelFlags, const gchar*, gpointer) {}

}  // namespace

/// What Aravis does not free is its own affair.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0";
}

#ifdef TODBENCH_FUZZ_MUTATES
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

/// Texts that limits and graphs turn on.
constexpr std::array<std::string_view, 20> telling_texts{"0",
                                                         "-1",
                                                         "1",
                                                         "8",
                                                         "65536",
                                                         "65537",
                                                         "4000000000",
                                                         "0x7FFFFFFFFFFFFFFF",
                                                         "-9223372036854775808",
                                                         "A / B",
                                                         "A % (0 - B)",
                                                         "(1 &lt;&lt; 63) / A",
                                                         "A ? B : A / B",
                                                         "E + E * K",
                                                         "ROUND(A / 3, B)",
                                                         "-A ** B",
                                                         "A",
                                                         "B",
                                                         "R",
                                                         "Signed"};

/// Where a text stands between two tags, or in quotes.
std::vector<std::pair<std::size_t, std::size_t>> texts_of(std::string_view xml) {
  std::vector<std::pair<std::size_t, std::size_t>> found;
  for (std::size_t at = 0; at < xml.size(); ++at) {
    const char end = xml[at] == '>' ? '<' : xml[at] == '"' ? '"' : '\0';
    if (end == '\0') continue;
    const auto close = xml.find(end, at + 1);
    if (close == std::string_view::npos) continue;
    if (close > at + 1 && close - at < 200) found.emplace_back(at + 1, close - at - 1);
    if (end == '"') at = close;
  }
  return found;
}

}  // namespace

/// Most inputs stay descriptions: a text takes the place of another, or of one that tells.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  std::minstd_rand random(seed);
  const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random()) % count; };
  std::string xml(fuzz::text_of(data, size));
  const auto texts = texts_of(xml);
  if (texts.empty() || below(4) == 0) return LLVMFuzzerMutate(data, size, most);
  const auto [at, count] = texts[below(texts.size())];
  const auto [from, length] = texts[below(texts.size())];
  const std::string text =
      below(3) == 0 ? std::string(telling_texts[below(telling_texts.size())]) : xml.substr(from, length);
  xml.replace(at, count, text);
  if (xml.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, xml.data(), xml.size());
  return xml.size();
}
#endif

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static ArvDevice* const camera = [] {
    g_log_set_default_handler(&quiet, nullptr);
    return make_camera();
  }();
  const std::string_view xml = fuzz::text_of(data, size);
  const Description description(xml);
  if (!description.faults().empty()) return 0;
  const auto nodes = parse_description(xml);
  fuzz::require(nodes.has_value());
  ArvGc* genicam = arv_gc_new(camera, xml.data(), xml.size());
  if (genicam == nullptr) return 0;
  std::vector<std::string> names;
  for (const auto& [name, index] : nodes->by_name) names.push_back(name);
  std::sort(names.begin(), names.end());
  for (const auto& name : names) {
    if (!description.faults_of(name).empty() || !lengths_are_good(description, name, genicam)) continue;
    evaluate(arv_gc_get_node(genicam, name.c_str()));
  }
  g_object_unref(genicam);
  return 0;
}
