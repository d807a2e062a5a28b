// From the human runs of sessions to an observer fitted to the people.
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

/// The answers of one session.
struct AnsweredSession {
  std::string folder;           ///< its name, without the folders above it
  std::string manifest_sha256;  ///< empty where nothing vouches for it
  std::string shown_sha256;     ///< of shown_human.csv
  int samples_per_pitch = 1;
  double noise_k = 0;  ///< temporal noise of the run, for answers that do not tell theirs
  HumanRecord human;
};
/// Of a session that open_session() took. `invalid_input`: nobody has answered in it, or what was shown was not kept.
[[nodiscard]] Result<AnsweredSession> answered_session(const std::filesystem::path& folder, const Session& session);

enum class PersonsAre {
  sessions,  ///< every session is a person
  one,       ///< one person answered in all of them
};

struct PeopleFitOptions {
  TemplateObserverSpec from;
  std::string from_sha256;  ///< of the text that `from` was read from
  std::string name;         ///< of the fitted observer
  std::array<bool, observer_key_count> free{};
  PersonsAre persons = PersonsAre::sessions;
  int replicates = 299;
  int draws = 384;
  std::uint64_t seed = 1;
  /// The model is refused where its p is not above this, shared by the people (Bonferroni).
  double least_p = 0.01;
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
};

/// A contrast and a size, in the order of the cells.
struct ShownSize {
  double set_delta_t_k = 0, size_mrad = 0;
  auto operator<=>(const ShownSize&) const = default;
};

struct FittedPerson {
  std::vector<std::size_t> sessions;  ///< index of each
  PersonFit fit;
  Goodness goodness;
  std::vector<ShownSize> cells;  ///< by Goodness::cells[].cell
};

struct PeopleFit {
  PeopleFitOptions options;
  std::vector<AnsweredSession> sessions;
  std::vector<FittedPerson> people;
  std::array<PeopleSpread, observer_key_count> spread{};  ///< of the free ones; empty for one person
  ObserverValues values{};                                ///< of the person, or the means over people
  std::array<Interval, observer_key_count> ci95{};
  double least_p = 1;                       ///< smallest p of the model over people
  bool accepted = false;                    ///< it is above least_p of the options for everyone
  std::vector<std::string> not_identified;  ///< sentences: what the answers do not tell
  [[nodiscard]] bool usable() const { return accepted && not_identified.empty(); }
};

/// `invalid_input`: answers that the observer cannot judge, the same answers twice, a parameter out of what can be
/// fitted. `interrupted`.
[[nodiscard]] Result<PeopleFit> fit_people(std::vector<AnsweredSession> sessions, const PeopleFitOptions& options,
                                           std::stop_token stop);

/// The fitted observer.
[[nodiscard]] TemplateObserverSpec fitted_observer(const PeopleFit& fit);

}  // namespace todbench
