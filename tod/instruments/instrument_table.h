// The words of an instrument as data: what is sent to it, what it answers and when it has settled. A black body or a
// plate stage that nobody here has is one such value, read from a file (docs/instruments.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// RS-232 or what a USB adapter makes of it.
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

/// How an instrument is talked to, whatever it is. The defaults are those of IEEE 488.2 and SCPI.
struct InstrumentSpeech {
  /// When the error query is sent.
  enum class ErrorsAsked {
    with_command,   ///< in one go with each command and query: the answer comes before its report
    after_command,  ///< once a query was answered
  };
  std::string ending = "\n";               ///< after each command
  char answer_ending = '\n';               ///< a carriage return before it is taken off
  std::uint16_t port = 5025;               ///< of an address without one
  std::optional<double> answer_timeout_s;  ///< in place of that of the caller
  double pause_s = 0;                      ///< least time from the end of one exchange to the next
  SerialSettings serial{};

  std::string clear = "*CLS";           ///< sent before the first question; empty: nothing
  std::string identity_query = "*IDN?"; /**< empty: it cannot say who it is */
  bool identity_of_four = true;         ///< vendor,model,serial,firmware (IEEE 488.2, 10.14); false: any line, a model
  std::string identity_contains;        ///< part of the identity by which the instrument is known

  std::string error_query = "SYST:ERR?";  ///< empty: it does not say what it refuses
  ErrorsAsked errors_asked = ErrorsAsked::with_command;
  /// Answers that mean no error; empty: 0,"..." does (SCPI-99 volume 1, 21.8).
  std::vector<std::string> no_error;
  std::string acknowledgement;        ///< what a command without a question is answered with; empty: nothing
  std::vector<std::string> refusals;  ///< how an answer begins that refuses
};

/// A unit of the file: in the units of this program a value is value * scale + offset.
struct InstrumentUnit {
  std::string name;
  double scale = 1, offset = 0;
};
/// Of temperature differences, in K: "K", "mK", "degC", "degF".
[[nodiscard]] std::vector<InstrumentUnit> difference_units();
/// Of temperatures, in K: "K", "mK", "degC", "degF".
[[nodiscard]] std::vector<InstrumentUnit> temperature_units();
/// Of positions, in mm: "mm", "um", "m", "in".
[[nodiscard]] std::vector<InstrumentUnit> length_units();

/// What is asked for numbers: one query, or one for each number.
struct NumberQuestion {
  std::vector<std::string> queries;
  std::string answer;  ///< of each, "{}" for a number: "{} K"; empty: numbers with commas, as many as are due
  [[nodiscard]] bool asks() const { return !queries.empty(); }
};

/// What the instrument says of having settled. Several of them have to agree.
struct SettledRule {
  std::string query;                 ///< empty: not asked
  std::optional<int> bit;            ///< of a register of 16 bits ...
  bool bit_means_settling = true;    ///< ... that is set while it settles, or once it has
  std::vector<std::string> answers;  ///< without a bit: answers that mean settled
  double dwell_s = 0;                ///< as long it has to stay within the tolerance
};

/// A differential black body.
struct BlackBodyWords {
  InstrumentUnit unit{"K"};
  int decimals = 4;          ///< of a number that is sent
  std::string set;           ///< "SOUR:TEMP:DIFF {}"
  NumberQuestion set_point;  ///< none: commanded each time
  NumberQuestion limits;     ///< lowest and highest; none: limits_k
  std::array<double, 2> limits_k{0, 0};
  NumberQuestion measured;
  double tolerance_k = 0.002;  ///< measured minus asked that still counts as reached
  NumberQuestion plate;        ///< temperature of the surround; none: it does not say
  NumberQuestion radiator;     ///< of the black body behind the plate; the same
  InstrumentUnit absolute_unit{"K"};
};

/// Places of a plate in its own plane. A stage without it has a plate that hands shift.
struct StagePosition {
  InstrumentUnit unit{"mm"};
  int decimals = 4;
  std::vector<std::string> set;  ///< one command of x and y, or one for each
  NumberQuestion set_point;
  NumberQuestion limits;  ///< x0, x1, y0, y1; none: limits_mm
  std::array<double, 4> limits_mm{};
  NumberQuestion measured;
  double tolerance_mm = 0.005;
};

/// Runs along x at constant speed, in the unit of the position and that per second. A stage without it cannot run.
struct StageRun {
  std::string set;        ///< "SOUR:SCAN {},{}": to where, how fast
  NumberQuestion limits;  ///< lowest and highest speed; none: limits_mm_s
  std::array<double, 2> limits_mm_s{};
  NumberQuestion
      measured;  ///< from, to, speed, and when it began in seconds of the camera's clock; above 9e37: unknown
};

/// Something that is chosen by a word: a plate, a mounting.
struct StageChoice {
  std::string set;        ///< "ROUT:PLAT {}"; empty: there is but one
  std::string set_point;  ///< the word that was asked for; empty: commanded each time
  std::string measured;   ///< the word that is in place; empty: the one asked for, once settled
};

/// A stage that brings plates before the camera.
struct StageWords {
  StageChoice plate;
  bool quoted = false;                           ///< the word of a plate as SCPI string data, quotes doubled
  std::string catalogue;                         ///< answers the names of all plates; empty: `plates`
  std::vector<std::string> plates, plate_words;  ///< names of plates and the words of the stage for them
  StageChoice mounting;
  std::array<std::string, all_mountings.size()> mounting_words;  ///< empty: not in this mounting
  std::optional<StagePosition> position;
  std::optional<StageRun> run;  ///< only with a position
};

enum class InstrumentKind { black_body, stage };
[[nodiscard]] std::string_view to_string(InstrumentKind kind);

/// An instrument.
struct InstrumentTable {
  std::string name;         ///< of the file
  std::string description;  ///< make and model, for people
  InstrumentKind kind = InstrumentKind::black_body;
  InstrumentSpeech speech;
  SettledRule settled;
  BlackBodyWords black_body;  ///< of that kind
  StageWords stage;
};

/// The numbers of an answer that looks like `form`: "{}" stands for a number, blanks may differ, nothing else may.
/// Nothing when it does not fit or a number is not finite.
[[nodiscard]] std::optional<std::vector<double>> numbers_in(std::string_view answer, std::string_view form);
/// How often "{}" stands in a text.
[[nodiscard]] std::size_t places_in(std::string_view form);
/// A command with words in the places of "{}", in their order. Precondition: as many places as words.
[[nodiscard]] std::string command_of(std::string_view form, const std::vector<std::string>& words);
/// "{}" with commas between, `count` times.
[[nodiscard]] std::string comma_form(std::size_t count);

}  // namespace todbench
