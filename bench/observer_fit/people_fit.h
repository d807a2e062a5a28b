// SPDX-License-Identifier: GPL-3.0-or-later
// Fit of an observer to people, from the answers that they gave in sessions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/session/human_record.h"
#include "bench/session/session_folder.h"
#include "tod/observer_fit/goodness.h"
#include "tod/observer_fit/people.h"

namespace todbench {

/// Answers of one person at one sitting of a session.
struct AnsweredSession {
  std::string folder;           ///< name of the session folder, without its parent folders
  std::string person{};         ///< code of the person; empty: not stated
  std::size_t number = 1;       ///< number of the sitting in the session, in the order of the answers
  std::size_t sittings = 1;     ///< number of sittings in the session
  std::string manifest_sha256;  ///< empty: no manifest
  std::string shown_sha256;     ///< SHA-256 of the file with the pictures of this person
  int samples_per_pitch = 1;
  double noise_k = 0;                      ///< temporal noise of the run, for answers without a stated noise
  std::optional<ViewedDisplay> display{};  ///< display of the plan, for an observer with an eye
  HumanRecord human;
};
/// Reads the answers of an opened session: of all people in the order of their sittings, or of `person` only. `person`:
/// code of the person, or the number of the sitting for a person without a code. Errors: `invalid_input` (no answers,
/// no answers of this person, or the shown pictures were not stored).
[[nodiscard]] Result<std::vector<AnsweredSession>> answered_sessions(const std::filesystem::path& folder,
                                                                     const Session& session,
                                                                     const std::optional<std::string>& person);
/// Returns a label for the answers: the folder, and the person if the session has several sittings.
[[nodiscard]] std::string label_of(const AnsweredSession& session);

/// Assignment of sittings to people.
enum class PersonsAre {
  codes,  ///< sittings with the same code belong to one person; every sitting without a code is a person
  one,    ///< one person answered in all sessions
};

/// Options of the fit.
struct PeopleFitOptions {
  TemplateObserverSpec from;
  std::string from_sha256;                      ///< SHA-256 of the text of `from`
  std::string name;                             ///< name of the fitted observer
  std::array<bool, observer_key_count> free{};  ///< parameters to fit; the other parameters keep the values of `from`
  PersonsAre persons = PersonsAre::codes;
  int replicates = 299;  ///< replicates of the bootstrap of the goodness of fit, at least 19
  int draws = 384;       ///< noise vectors per answer probability, an even number
  std::uint64_t seed = 1;
  /// The model is rejected if its p-value is at most this value divided by the number of people (Bonferroni).
  double least_p = 0.01;
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};

  [[nodiscard]] FittedKind kind() const { return from.eye ? FittedKind::eye : FittedKind::blurred; }
  /// Returns the name of a parameter, by ObserverKey.
  [[nodiscard]] std::string parameter(std::size_t key) const {
    return std::string(parameter_name(all_observer_keys[key], kind()));
  }
};

/// Contrast and size of a cell. Cells are ordered by contrast, then by size.
struct ShownSize {
  double set_delta_t_k = 0, size_mrad = 0;
  auto operator<=>(const ShownSize&) const = default;
};

/// Fit of one person.
struct FittedPerson {
  std::vector<std::size_t> sessions;  ///< indices in PeopleFit::sessions
  PersonFit fit;
  Goodness goodness;
  std::vector<ShownSize> cells;  ///< contrasts and sizes; the index is Goodness::cells[].cell
};

/// Fit of all people.
struct PeopleFit {
  PeopleFitOptions options;
  std::vector<AnsweredSession> sessions;
  std::vector<FittedPerson> people;
  std::array<PeopleSpread, observer_key_count> spread{};  ///< spread of the free parameters; empty for one person
  ObserverValues values{};                                ///< values of the person, or means over people
  std::array<Interval, observer_key_count> ci95{};
  double least_p = 1;                       ///< smallest p-value of the goodness of fit among the people
  bool accepted = false;                    ///< the p-value exceeds the limit from `options.least_p` for every person
  std::vector<std::string> not_identified;  ///< sentences: parameters that the answers do not determine
  /// Returns whether the fitted observer may be used.
  [[nodiscard]] bool usable() const { return accepted && not_identified.empty(); }
};

/// Fits the observer. Errors: `invalid_input` (answers that the observer cannot judge, the same answers twice, two
/// codes for one person, a parameter outside the range of the fit), `interrupted`.
[[nodiscard]] Result<PeopleFit> fit_people(std::vector<AnsweredSession> sessions, const PeopleFitOptions& options,
                                           std::stop_token stop);

/// Returns the values of an observer before the fit, by ObserverKey.
[[nodiscard]] ObserverValues start_values(const TemplateObserverSpec& from);

/// Returns the difference between a fitted value and the value of `from`, in units of the spread of hvs-2. The spread
/// is half of the range of the parameter that is consistent with public data (gain +-4 dB, contrast noise 0 to 0.07,
/// sensor-noise factor 1.1 to 3.2). For decibels and factors the range is taken in logarithms. Empty for other
/// parameters, and for an observer without an eye.
[[nodiscard]] std::optional<double> spreads_from_default(const PeopleFit& fit, std::size_t key);

/// Returns the fitted observer.
[[nodiscard]] TemplateObserverSpec fitted_observer(const PeopleFit& fit);

}  // namespace todbench
