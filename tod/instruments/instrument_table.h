// SPDX-License-Identifier: GPL-3.0-or-later
// The command table of an instrument as data: commands, answers and settling. One value of this type describes any
// black body or plate stage; it is read from a file (docs/reference/instruments.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Settings of an RS-232 port or USB serial adapter.
struct SerialSettings {
  enum class Parity { none, even, odd };
  enum class Flow { none, hardware, software };
  int baud = 9600;  ///< one of serial_bauds
  int data_bits = 8;
  Parity parity = Parity::none;
  int stop_bits = 1;
  Flow flow = Flow::none;
  bool operator==(const SerialSettings&) const = default;
};
inline constexpr std::array serial_bauds{1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400};

/// Protocol of an instrument. The defaults are those of IEEE 488.2 and SCPI.
struct InstrumentSpeech {
  /// Time at which the error query is sent.
  enum class ErrorsAsked {
    with_command,   ///< together with each command and query: the answer precedes the error report
    after_command,  ///< after a query was answered
  };
  std::string ending = "\n";               ///< line end after each command
  char answer_ending = '\n';               ///< last character of an answer; a preceding carriage return is removed
  std::uint16_t port = 5025;               ///< default port of an address
  std::optional<double> answer_timeout_s;  ///< replaces the timeout of the caller
  double pause_s = 0;                      ///< minimum time from the end of one exchange to the start of the next
  SerialSettings serial{};

  std::string clear = "*CLS";            ///< sent before the first query; empty: none
  std::string identity_query = "*IDN?";  ///< empty: the instrument has none
  bool identity_of_four = true;   ///< vendor,model,serial,firmware (IEEE 488.2, 10.14); false: any line is the model
  std::string identity_contains;  ///< text that the identity must contain

  std::string error_query = "SYST:ERR?";  ///< empty: the instrument does not report refusals
  ErrorsAsked errors_asked = ErrorsAsked::with_command;
  /// Answers that mean no error; if empty, 0,"..." means no error (SCPI-99 volume 1, 21.8).
  std::vector<std::string> no_error;
  std::string acknowledgement;        ///< answer to a command that is not a query; empty: none
  std::vector<std::string> refusals;  ///< beginnings of answers that mean a refusal
};

/// A unit of the file: value in this program's units = value * scale + offset.
struct InstrumentUnit {
  std::string name;
  double scale = 1, offset = 0;
};
/// Returns the units of temperature differences, in K: "K", "mK", "degC", "degF".
[[nodiscard]] std::vector<InstrumentUnit> difference_units();
/// Returns the units of temperatures, in K: "K", "mK", "degC", "degF".
[[nodiscard]] std::vector<InstrumentUnit> temperature_units();
/// Returns the units of positions, in mm: "mm", "um", "m", "in".
[[nodiscard]] std::vector<InstrumentUnit> length_units();

/// Queries for numbers: one query for all numbers, or one for each.
struct NumberQuestion {
  std::vector<std::string> queries;
  std::string answer;  ///< form of each answer, "{}" for a number: "{} K"; empty: the expected numbers, separated by
                       ///< commas
  [[nodiscard]] bool asks() const { return !queries.empty(); }
};

/// Conditions for a settled instrument. All stated conditions must hold.
struct SettledRule {
  std::string query;                 ///< empty: not queried
  std::optional<int> bit;            ///< number of a bit in a 16-bit register; empty: `answers` applies
  bool bit_means_settling = true;    ///< the bit is set while settling (true) or once settled (false)
  std::vector<std::string> answers;  ///< answers that mean settled, if `bit` is empty
  double dwell_s = 0;                ///< time that the value must stay within the tolerance
};

/// Absolute set-point of a black body, in BlackBodyWords::absolute_unit.
struct AbsoluteWords {
  int decimals = 4;          ///< of the number in a command
  std::string set;           ///< "SOUR:TEMP:ABS {}"
  NumberQuestion set_point;  ///< empty: the set-point is commanded each time
  NumberQuestion limits;     ///< lowest and highest; empty: limits_k
  std::array<double, 2> limits_k{0, 0};
  double tolerance_k = 0.002;  ///< largest difference between the radiator's reading and the set-point that is accepted
};

/// A differential black body.
struct BlackBodyWords {
  InstrumentUnit unit{"K"};
  int decimals = 4;          ///< of the number in a command
  std::string set;           ///< "SOUR:TEMP:DIFF {}"
  NumberQuestion set_point;  ///< empty: the set-point is commanded each time
  NumberQuestion limits;     ///< lowest and highest; empty: limits_k
  std::array<double, 2> limits_k{0, 0};
  NumberQuestion measured;
  double tolerance_k = 0.002;  ///< largest difference between measured and requested value that is accepted
  NumberQuestion plate;        ///< temperature of the surround; empty: not reported
  NumberQuestion radiator;     ///< temperature of the black body behind the plate; empty: not reported
  InstrumentUnit absolute_unit{"K"};
  std::optional<AbsoluteWords> absolute{};  ///< only with a `radiator`
};

/// Positions of a plate in its own plane. Without this table, the operator shifts the plate by hand.
struct StagePosition {
  InstrumentUnit unit{"mm"};
  int decimals = 4;
  std::vector<std::string> set;  ///< one command for x and y, or one for each
  NumberQuestion set_point;
  NumberQuestion limits;  ///< x0, x1, y0, y1; empty: limits_mm
  std::array<double, 4> limits_mm{};
  NumberQuestion measured;
  double tolerance_mm = 0.005;
};

/// Runs along x at constant speed, in the unit of the position and in this unit per second. Without this table the
/// stage cannot run.
struct StageRun {
  std::string set;        ///< "SOUR:SCAN {},{}": destination, speed
  NumberQuestion limits;  ///< lowest and highest speed; empty: limits_mm_s
  std::array<double, 2> limits_mm_s{};
  /// Reported run: from, to, speed, and start in seconds of the camera's clock (above 9e37: unknown).
  NumberQuestion measured;
};

/// A selection by a word, such as a plate or a mounting.
struct StageChoice {
  std::string set;        ///< "ROUT:PLAT {}"; empty: only one exists
  std::string set_point;  ///< query of the requested word; empty: the word is commanded each time
  std::string measured;   ///< query of the word in place; empty: the requested word is assumed once settled
};

/// A stage that moves plates in front of the camera.
struct StageWords {
  StageChoice plate;
  bool quoted = false;                           ///< plates are SCPI string data, quotes doubled
  std::string catalogue;                         ///< query of the names of all plates; empty: `plates`
  std::vector<std::string> plates, plate_words;  ///< names of plates and the stage's words for them
  StageChoice mounting;
  std::array<std::string, all_mountings.size()> mounting_words;  ///< empty: this mounting is not available
  std::optional<StagePosition> position;
  std::optional<StageRun> run;  ///< only with a position
};

/// Kind of an instrument.
enum class InstrumentKind { black_body, stage };
[[nodiscard]] std::string_view to_string(InstrumentKind kind);

/// Command table of an instrument.
struct InstrumentTable {
  std::string name;         ///< of the file
  std::string description;  ///< make and model, for people
  InstrumentKind kind = InstrumentKind::black_body;
  InstrumentSpeech speech;
  SettledRule settled;
  BlackBodyWords black_body;  ///< used if kind is black_body
  StageWords stage;
};

/// Returns the numbers in an answer of the form `form`: "{}" stands for a number, blanks may differ, all other
/// characters must agree. Empty if the answer does not fit or a number is not finite.
[[nodiscard]] std::optional<std::vector<double>> numbers_in(std::string_view answer, std::string_view form);
/// Returns the number of "{}" in a text.
[[nodiscard]] std::size_t places_in(std::string_view form);
/// Returns a command in which `words` replace "{}" in order. Precondition: as many "{}" as words.
[[nodiscard]] std::string command_of(std::string_view form, const std::vector<std::string>& words);
/// Returns `count` times "{}", separated by commas.
[[nodiscard]] std::string comma_form(std::size_t count);

}  // namespace todbench
