// SPDX-License-Identifier: GPL-3.0-or-later
// The command table of an instrument as data: commands, answers and settling. A table describes any black body or plate
// stage and is read from a file (docs/reference/instruments.md).
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
    with_command,   ///< with each command and query; the answer is received before the error report
    after_command,  ///< after the answer to a query
  };
  std::string ending = "\n";               ///< line end after each command
  char answer_ending = '\n';               ///< last character of an answer; a preceding carriage return is removed
  std::uint16_t port = 5025;               ///< default port of an address
  std::optional<double> answer_timeout_s;  ///< replaces the timeout of the caller
  double pause_s = 0;                      ///< minimum time from the end of one exchange to the start of the next
  SerialSettings serial{};

  std::string clear = "*CLS";            ///< sent before the first query; empty: none
  std::string identity_query = "*IDN?";  ///< identity query; empty: the instrument has no identity query
  /// True: the answer is vendor,model,serial,firmware (IEEE 488.2, 10.14); false: the whole line is the model.
  bool identity_of_four = true;
  std::string identity_contains;  ///< text that the identity must contain

  std::string error_query = "SYST:ERR?";  ///< error query; empty: the instrument does not report refusals
  ErrorsAsked errors_asked = ErrorsAsked::with_command;
  /// Answers to the error query that mean no error. Empty: the answer 0,"..." means no error (SCPI-99 volume 1, 21.8).
  std::vector<std::string> no_error;
  std::string acknowledgement;        ///< answer to a command that is not a query; empty: none
  std::vector<std::string> refusals;  ///< an answer that begins with any of these texts is a refusal
};

/// A unit of the file. Value in the units of this program = value in this unit * scale + offset.
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

/// Queries for numbers: one query for all numbers, or one query for each number.
struct NumberQuestion {
  std::vector<std::string> queries;
  /// Form of each answer, with "{}" in place of a number, for example "{} K". Empty: the expected numbers, separated by
  /// commas.
  std::string answer;
  [[nodiscard]] bool asks() const { return !queries.empty(); }
};

/// Conditions for a settled instrument. All stated conditions must hold.
struct SettledRule {
  std::string query;                 ///< query of the settling state; empty: not queried
  std::optional<int> bit;            ///< number of a bit in a 16-bit register; empty: `answers` is used
  bool bit_means_settling = true;    ///< true: the bit is set while settling; false: the bit is set when settled
  std::vector<std::string> answers;  ///< answers that mean settled, if `bit` is empty
  double dwell_s = 0;                ///< time that the value must stay within the tolerance
};

/// Absolute set-point of a black body, in BlackBodyWords::absolute_unit.
struct AbsoluteWords {
  int decimals = 4;          ///< number of decimals in a command
  std::string set;           ///< "SOUR:TEMP:ABS {}"
  NumberQuestion set_point;  ///< query of the set-point; empty: the set-point is commanded each time
  NumberQuestion limits;     ///< lowest and highest; empty: limits_k
  std::array<double, 2> limits_k{0, 0};
  double tolerance_k = 0.002;  ///< largest accepted difference between the reading of the radiator and the set-point
};

/// A differential black body.
struct BlackBodyWords {
  InstrumentUnit unit{"K"};
  int decimals = 4;          ///< number of decimals in a command
  std::string set;           ///< "SOUR:TEMP:DIFF {}"
  NumberQuestion set_point;  ///< query of the set-point; empty: the set-point is commanded each time
  NumberQuestion limits;     ///< lowest and highest; empty: limits_k
  std::array<double, 2> limits_k{0, 0};
  NumberQuestion measured;
  double tolerance_k = 0.002;  ///< largest accepted difference between measured and requested value
  NumberQuestion plate;        ///< temperature of the surround; empty: not reported
  NumberQuestion radiator;     ///< temperature of the black body behind the plate; empty: not reported
  InstrumentUnit absolute_unit{"K"};
  std::optional<AbsoluteWords> absolute{};  ///< absolute set-point; only with a `radiator`
};

/// Positions of a plate in its own plane. If a stage has no positions, the operator shifts the plate by hand.
struct StagePosition {
  InstrumentUnit unit{"mm"};
  int decimals = 4;
  std::vector<std::string> set;  ///< one command for x and y, or one command for each
  NumberQuestion set_point;
  NumberQuestion limits;  ///< x0, x1, y0, y1; empty: limits_mm
  std::array<double, 4> limits_mm{};
  NumberQuestion measured;
  double tolerance_mm = 0.005;
};

/// Runs along x at constant speed. Positions are in the unit of StagePosition, speeds in this unit per second. If the
/// table does not contain this part, the stage cannot run.
struct StageRun {
  std::string set;        ///< "SOUR:SCAN {},{}": destination, speed
  NumberQuestion limits;  ///< lowest and highest speed; empty: limits_mm_s
  std::array<double, 2> limits_mm_s{};
  /// Reported run: from, to, speed, and start in seconds of the camera's clock (above 9e37: unknown).
  NumberQuestion measured;
};

/// Commands that select a plate or a mounting by a word.
struct StageChoice {
  std::string set;        ///< for example "ROUT:PLAT {}"; empty: there is only one plate or mounting
  std::string set_point;  ///< query of the requested word; empty: the word is commanded each time
  std::string measured;   ///< query of the present word; empty: the requested word is assumed after settling
};

/// A stage that moves plates in front of the camera.
struct StageWords {
  StageChoice plate;
  bool quoted = false;                           ///< plates are SCPI string data with doubled quotes
  std::string catalogue;                         ///< query of the names of all plates; empty: `plates`
  std::vector<std::string> plates, plate_words;  ///< names of the plates, and the words of the stage for them
  StageChoice mounting;
  /// Words of the stage, in the order of all_mountings. Empty word: this mounting is not available.
  std::array<std::string, all_mountings.size()> mounting_words;
  std::optional<StagePosition> position;
  std::optional<StageRun> run;  ///< runs; only with a position
};

/// Kind of an instrument.
enum class InstrumentKind { black_body, stage };
[[nodiscard]] std::string_view to_string(InstrumentKind kind);

/// Command table of an instrument.
struct InstrumentTable {
  std::string name;         ///< name of the file
  std::string description;  ///< make and model, shown to the user
  InstrumentKind kind = InstrumentKind::black_body;
  InstrumentSpeech speech;
  SettledRule settled;
  BlackBodyWords black_body;  ///< used if kind is black_body
  StageWords stage;
};

/// Returns the numbers in an answer. In `form`, "{}" is the position of a number. Blanks may differ, but all other
/// characters must agree with `form`. Empty if the answer does not have this form, or if a number is not finite.
[[nodiscard]] std::optional<std::vector<double>> numbers_in(std::string_view answer, std::string_view form);
/// Returns the number of "{}" in a text.
[[nodiscard]] std::size_t places_in(std::string_view form);
/// Returns a command: `form` with each "{}" replaced by the next element of `words`. Precondition: there are as many
/// words as "{}".
[[nodiscard]] std::string command_of(std::string_view form, const std::vector<std::string>& words);
/// Returns `count` times "{}", separated by commas.
[[nodiscard]] std::string comma_form(std::size_t count);

}  // namespace todbench
