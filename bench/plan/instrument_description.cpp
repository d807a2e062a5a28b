// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/instrument_description.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/try.h"
#include "bench/plan/strict_toml.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

using Texts = std::vector<std::string>;

constexpr std::size_t longest_command = 256;

/// Reader of one file. Each command is checked where it is read.
class InstrumentReader {
 public:
  explicit InstrumentReader(TomlReader file) : file_(std::move(file)) {}

  Result<InstrumentTable> read(const std::string& name) {
    const Texts kinds{"black_body", "stage"};
    table_.name = name;
    table_.kind =
        file_.choice("kind", kinds, std::nullopt) == kinds[0] ? InstrumentKind::black_body : InstrumentKind::stage;
    table_.description = file_.text("description", std::nullopt);
    check_words(file_, "description", table_.description);
    read_line();
    read_serial();
    read_identity();
    read_errors();
    if (table_.kind == InstrumentKind::black_body) read_black_body();
    if (table_.kind == InstrumentKind::stage) read_stage();
    read_settled();
    TODBENCH_TRY_VOID(file_.finish());
    return std::move(table_);
  }

 private:
  static bool is_printable(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
  }
  static void check_words(TomlReader& at, std::string_view key, const std::string& text) {
    if (!is_printable(text) || text.size() > longest_command)
      at.reject(key, "expected at most 256 printable ASCII characters");
  }
  /// Text that can be sent; empty if optional and absent.
  static std::string words(TomlReader& at, std::string_view key, const std::optional<std::string>& fallback) {
    const std::string text = at.text(key, fallback);
    check_words(at, key, text);
    if (at.has(key) && text.empty() && !(fallback && !fallback->empty())) at.reject(key, "expected a text in quotes");
    return text;
  }
  /// Text with `places` placeholders "{}".
  static std::string form(TomlReader& at, std::string_view key, std::size_t places,
                          const std::optional<std::string>& fallback) {
    const std::string text = words(at, key, fallback);
    if (!text.empty() && places_in(text) != places)
      at.reject(key, "expected the placeholder {} " + std::to_string(places) + " times, found it " +
                         std::to_string(places_in(text)) + " times");
    return text;
  }
  static Texts list(TomlReader& at, std::string_view key, const std::optional<Texts>& fallback) {
    const Texts texts = at.texts(key, fallback);
    if (at.has(key) && texts.empty()) at.reject(key, "expected at least one text");
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (texts[i].empty() || texts[i].size() > longest_command || !is_printable(texts[i]))
        at.reject(key, i, "expected 1 to 256 printable ASCII characters");
    }
    return texts;
  }
  static InstrumentUnit unit(TomlReader& at, const std::vector<InstrumentUnit>& units) {
    Texts names;
    for (const auto& known : units) names.push_back(known.name);
    const std::string name = at.choice("unit", names, std::nullopt);
    return units[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())];
  }
  /// One query, or one for each of `count` numbers.
  static NumberQuestion question(TomlReader& at, std::string_view key, std::string_view answer_key, std::size_t count,
                                 const std::optional<Texts>& fallback) {
    NumberQuestion asked{list(at, key, fallback), ""};
    if (asked.queries.empty()) return asked;
    if (asked.queries.size() != 1 && asked.queries.size() != count) {
      at.reject(key, "expected one query for all numbers, or " + std::to_string(count) + " queries");
      return asked;
    }
    asked.answer = form(at, answer_key, count / asked.queries.size(), "");
    return asked;
  }
  static NumberQuestion one_number(TomlReader& at, std::string_view key, const std::string& answer,
                                   const std::optional<std::string>& fallback) {
    const std::string query = words(at, key, fallback);
    return query.empty() ? NumberQuestion{} : NumberQuestion{{query}, answer};
  }

  void read_line() {
    TomlReader line = file_.section("line");
    InstrumentSpeech& speech = table_.speech;
    const std::array<std::pair<std::string, std::string>, 3> endings{{{"LF", "\n"}, {"CR", "\r"}, {"CRLF", "\r\n"}}};
    const Texts names{"LF", "CR", "CRLF"};
    const std::string ending = line.choice("ending", names, names[0]);
    for (const auto& [name, bytes] : endings) {
      if (name == ending) speech.ending = bytes;
    }
    speech.answer_ending = line.choice("answer_ending", names, names[0]) == "CR" ? '\r' : '\n';
    speech.port = static_cast<std::uint16_t>(line.whole("port", 1, 65535, speech.port));
    speech.answer_timeout_s = line.optional_number("answer_timeout_s", NumberRange::between(0.01, 60));
    speech.pause_s = line.number("pause_s", NumberRange::between(0, 10), speech.pause_s);
  }

  void read_serial() {
    TomlReader serial = file_.section("serial");
    SerialSettings& settings = table_.speech.serial;
    settings.baud = static_cast<int>(serial.whole("baud", serial_bauds.front(), serial_bauds.back(), settings.baud));
    if (std::find(serial_bauds.begin(), serial_bauds.end(), settings.baud) == serial_bauds.end())
      serial.reject("baud", "expected 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200 or 230400");
    settings.data_bits = static_cast<int>(serial.whole("data_bits", 7, 8, settings.data_bits));
    settings.stop_bits = static_cast<int>(serial.whole("stop_bits", 1, 2, settings.stop_bits));
    const Texts parities{"none", "even", "odd"}, flows{"none", "hardware", "software"};
    const std::string parity = serial.choice("parity", parities, parities[0]);
    const std::string flow = serial.choice("flow", flows, flows[0]);
    if (parity == "even") settings.parity = SerialSettings::Parity::even;
    if (parity == "odd") settings.parity = SerialSettings::Parity::odd;
    if (flow == "hardware") settings.flow = SerialSettings::Flow::hardware;
    if (flow == "software") settings.flow = SerialSettings::Flow::software;
  }

  void read_identity() {
    TomlReader identity = file_.section("identity");
    InstrumentSpeech& speech = table_.speech;
    speech.clear = words(identity, "clear", "");
    speech.identity_query = words(identity, "query", "");
    const Texts forms{"vendor,model,serial,firmware", "text"};
    speech.identity_of_four = identity.choice("answer", forms, forms[0]) == forms[0];
    speech.identity_contains = words(identity, "contains", "");
    if (speech.identity_query.empty() && !speech.identity_contains.empty())
      identity.reject("contains", "needs a query, because the answer to it must contain this text");
  }

  void read_errors() {
    TomlReader errors = file_.section("errors");
    InstrumentSpeech& speech = table_.speech;
    speech.error_query = words(errors, "query", "");
    const Texts times{"with each command", "after each command"};
    speech.errors_asked = errors.choice("asked", times, times[1]) == times[0]
                              ? InstrumentSpeech::ErrorsAsked::with_command
                              : InstrumentSpeech::ErrorsAsked::after_command;
    speech.no_error = list(errors, "no_error", Texts{});
    speech.acknowledgement = words(errors, "acknowledgement", "");
    speech.refusals = list(errors, "refusals", Texts{});
    const bool together = speech.errors_asked == InstrumentSpeech::ErrorsAsked::with_command;
    if (together && (!speech.no_error.empty() || !speech.acknowledgement.empty() || !speech.refusals.empty()))
      errors.reject("asked", "no_error, acknowledgement and refusals need \"after each command\"");
    if (together && speech.error_query.empty()) errors.reject("asked", "needs the key 'query'");
  }

  void read_black_body() {
    TomlReader at = file_.section("difference");
    BlackBodyWords& words_of = table_.black_body;
    words_of.unit = unit(at, difference_units());
    words_of.decimals = static_cast<int>(at.whole("decimals", 0, 9, words_of.decimals));
    words_of.set = form(at, "set", 1, std::nullopt);
    const std::string answer = form(at, "answer", 1, "");
    words_of.set_point = one_number(at, "set_point", answer, "");
    words_of.measured = one_number(at, "measured", answer, std::nullopt);
    words_of.limits = question(at, "limits", "limits_answer", 2, Texts{});
    words_of.tolerance_k = words_of.unit.scale * at.number("tolerance", NumberRange::above_to(0, 1e6), std::nullopt);
    const auto ends = at.numbers("range", NumberRange::between(-1e6, 1e6), std::vector<double>{});
    if (words_of.limits.asks() != ends.empty()) {
      at.reject(ends.empty() ? "limits" : "range", "expected either limits or range");
    } else if (!ends.empty() && (ends.size() != 2 || !(ends[0] < ends[1]))) {
      at.reject("range", "expected two numbers, the lowest and the highest difference");
    } else if (!ends.empty()) {
      words_of.limits_k = {ends[0] * words_of.unit.scale, ends[1] * words_of.unit.scale};
    }
    TomlReader absolute = file_.section("temperatures");
    if (!absolute.present()) return;
    words_of.absolute_unit = unit(absolute, temperature_units());
    const std::string form_of = form(absolute, "answer", 1, "");
    words_of.plate = one_number(absolute, "plate", form_of, "");
    words_of.radiator = one_number(absolute, "radiator", form_of, "");
    read_absolute(absolute, form_of);
  }

  /// Absolute set-point, in the unit of the temperatures.
  void read_absolute(TomlReader& at, const std::string& answer) {
    BlackBodyWords& words_of = table_.black_body;
    const std::string set = form(at, "set", 1, "");
    AbsoluteWords absolute;
    absolute.set = set;
    absolute.decimals = static_cast<int>(at.whole("decimals", 0, 9, absolute.decimals));
    absolute.set_point = one_number(at, "set_point", answer, "");
    absolute.limits = question(at, "limits", "limits_answer", 2, Texts{});
    const InstrumentUnit& unit_of = words_of.absolute_unit;
    absolute.tolerance_k = unit_of.scale * at.number("tolerance", NumberRange::above_to(0, 1e6), 0.002 / unit_of.scale);
    const auto ends = at.numbers("range", NumberRange::between(-1e6, 1e6), std::vector<double>{});
    if (set.empty()) return;
    if (!words_of.radiator.asks()) at.reject("set", "an absolute set-point needs the reading radiator");
    if (absolute.limits.asks() != ends.empty()) {
      at.reject(ends.empty() ? "limits" : "range", "expected either limits or range");
    } else if (!ends.empty() && (ends.size() != 2 || !(ends[0] < ends[1]))) {
      at.reject("range", "expected two numbers, the lowest and the highest temperature");
    } else if (!ends.empty()) {
      absolute.limits_k = {ends[0] * unit_of.scale + unit_of.offset, ends[1] * unit_of.scale + unit_of.offset};
    }
    words_of.absolute = std::move(absolute);
  }

  /// Choice whose command has a placeholder for a word.
  static StageChoice choice(TomlReader& at) {
    StageChoice choice;
    choice.set = form(at, "set", 1, "");
    choice.set_point = words(at, "set_point", "");
    choice.measured = words(at, "measured", "");
    if (choice.set.empty() && !(choice.set_point.empty() && choice.measured.empty()))
      at.reject("set", "missing, but set_point and measured need it");
    return choice;
  }

  void read_stage() {
    StageWords& stage = table_.stage;
    TomlReader plate = file_.section("plate");
    stage.plate = choice(plate);
    stage.quoted = plate.flag("quoted", false);
    stage.catalogue = words(plate, "catalogue", "");
    stage.plates = list(plate, "names", Texts{});
    stage.plate_words = list(plate, "words", stage.plates);
    if (stage.catalogue.empty() == stage.plates.empty())
      plate.reject(stage.plates.empty() ? "names" : "catalogue", "expected either names or a catalogue");
    if (stage.plate_words.size() != stage.plates.size()) plate.reject("words", "expected one word for each name");
    if (stage.plate.set.empty() && stage.plates.size() > 1)
      plate.reject("names", "expected one name: there is no command to change the plate");
    check_distinct(plate, "names", stage.plates);
    check_distinct(plate, "words", stage.plate_words);
    read_mounting();
    read_position();
    read_run();
  }

  static void check_distinct(TomlReader& at, std::string_view key, Texts texts) {
    std::sort(texts.begin(), texts.end());
    if (std::adjacent_find(texts.begin(), texts.end()) != texts.end())
      at.reject(key, "expected values that all differ");
  }

  void read_mounting() {
    StageWords& stage = table_.stage;
    TomlReader mounting = file_.section("mounting");
    stage.mounting = choice(mounting);
    Texts used;
    for (std::size_t i = 0; i < all_mountings.size(); ++i) {
      stage.mounting_words[i] = words(mounting, to_string(all_mountings[i]), "");
      if (!stage.mounting_words[i].empty()) used.push_back(stage.mounting_words[i]);
    }
    check_distinct(mounting, "identity", used);
    if (!stage.mounting.set.empty() && stage.mounting_words[0].empty())
      mounting.reject("identity", "missing, expected the word of the stage for this mounting");
  }

  void read_position() {
    TomlReader at = file_.section("position");
    if (!at.present()) return;
    StagePosition position;
    position.unit = unit(at, length_units());
    position.decimals = static_cast<int>(at.whole("decimals", 0, 9, position.decimals));
    position.set = list(at, "set", std::nullopt);
    if (!position.set.empty() && position.set.size() > 2) at.reject("set", "expected one or two commands");
    for (std::size_t i = 0; i < position.set.size(); ++i) {
      if (places_in(position.set[i]) * position.set.size() != 2)
        at.reject("set", i, "expected {} for x and {} for y in one command, or one {} in each of two commands");
    }
    position.set_point = question(at, "set_point", "answer", 2, Texts{});
    position.measured = question(at, "measured", "answer", 2, std::nullopt);
    position.limits = question(at, "limits", "limits_answer", 4, Texts{});
    position.tolerance_mm = position.unit.scale * at.number("tolerance", NumberRange::above_to(0, 1e6), std::nullopt);
    const auto ends = at.numbers("range", NumberRange::between(-1e6, 1e6), std::vector<double>{});
    if (position.limits.asks() != ends.empty()) {
      at.reject(ends.empty() ? "limits" : "range", "expected either limits or range");
    } else if (!ends.empty() && (ends.size() != 4 || !(ends[0] <= ends[1] && ends[2] <= ends[3]))) {
      at.reject("range", "expected four numbers: lowest and highest x, lowest and highest y");
    } else if (!ends.empty()) {
      for (std::size_t i = 0; i < 4; ++i) position.limits_mm[i] = ends[i] * position.unit.scale;
    }
    table_.stage.position = std::move(position);
  }

  void read_run() {
    TomlReader at = file_.section("run");
    if (!at.present()) return;
    StageRun run;
    run.set = words(at, "set", std::nullopt);
    if (!run.set.empty() && places_in(run.set) != 2) at.reject("set", "expected {} for x and {} for the speed");
    run.measured = question(at, "measured", "answer", 4, std::nullopt);
    run.limits = question(at, "limits", "limits_answer", 2, Texts{});
    const auto speeds = at.numbers("range", NumberRange::between(1e-6, 1e6), std::vector<double>{});
    if (!table_.stage.position) {
      at.reject("set", "[run] needs a [position]");
    } else if (run.limits.asks() != speeds.empty()) {
      at.reject(speeds.empty() ? "limits" : "range", "expected either limits or range");
    } else if (!speeds.empty() && (speeds.size() != 2 || !(speeds[0] <= speeds[1]))) {
      at.reject("range", "expected two numbers, the lowest and the highest speed");
    } else if (!speeds.empty()) {
      for (std::size_t i = 0; i < 2; ++i) run.limits_mm_s[i] = speeds[i] * table_.stage.position->unit.scale;
    }
    table_.stage.run = std::move(run);
  }

  void read_settled() {
    TomlReader at = file_.section("settled");
    SettledRule& rule = table_.settled;
    rule.query = words(at, "query", "");
    if (at.has("bit")) rule.bit = static_cast<int>(at.whole("bit", 0, 15, std::nullopt));
    const Texts meanings{"settling", "settled"};
    rule.bit_means_settling = at.choice("bit_means", meanings, meanings[0]) == meanings[0];
    rule.answers = list(at, "answers", Texts{});
    rule.dwell_s = at.number("dwell_s", NumberRange::between(0, 3600), 0.0);
    if (rule.query.empty() && (rule.bit || !rule.answers.empty()))
      at.reject("query", "missing, but bit or answers are stated");
    if (!rule.query.empty() && rule.bit.has_value() != rule.answers.empty())
      at.reject("query", "expected either bit or answers, which interpret the answer to the query");
    if (rule.query.empty() && rule.dwell_s <= 0)
      at.reject("dwell_s",
                "expected a query, or a time above 0 s during which the value must stay within the tolerance");
  }

  TomlReader file_;
  InstrumentTable table_;
};

}  // namespace

Result<InstrumentTable> parse_instrument(const Resource& resource) {
  TODBENCH_TRY(auto file, TomlReader::parse(resource.text, resource.origin));
  return InstrumentReader(std::move(file)).read(resource.origin);
}

Result<InstrumentTable> load_instrument(std::string_view reference) {
  Texts known = resource_names(ResourceKind::black_body);
  const Texts stages = resource_names(ResourceKind::stage);
  const bool stage = std::find(stages.begin(), stages.end(), reference) != stages.end();
  known.insert(known.end(), stages.begin(), stages.end());
  if (!is_file_reference(reference) && std::find(known.begin(), known.end(), reference) == known.end())
    return fail(ErrorCode::invalid_input, "unknown instrument '" + one_line(reference) + "'" +
                                              nearest_name_hint(reference, known) + " (known: " + quoted_list(known) +
                                              "; a file needs a slash or the ending .toml)");
  TODBENCH_TRY(const auto resource, find_resource(stage ? ResourceKind::stage : ResourceKind::black_body, reference));
  return parse_instrument(resource);
}

}  // namespace todbench
