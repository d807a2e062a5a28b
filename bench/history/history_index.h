// SPDX-License-Identifier: GPL-3.0-or-later
// SQLite index of sessions by unit. The session folders are the original data, from which the index can be rebuilt.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/history/history_session.h"

struct sqlite3;

namespace todbench {

/// Event of a unit (repair, recalibration, transport, firmware). The charts of the unit restart after the event.
struct HistoryEvent {
  std::string serial, utc, kind, text;
};

/// Result of adding a session.
enum class Adding {
  added,
  known,         ///< same manifest in the same folder, or a copy of a session that still exists
  moved,         ///< same manifest in a different folder; the session no longer exists in the old folder
  judged_again,  ///< not added, because its frames come from an earlier session
};

/// Index of sessions. Session folders do not contain events. The file FILE.events.csv next to the index therefore also
/// stores the events, and a rebuilt index reads this file. One writer at a time; one thread.
class HistoryIndex {
 public:
  /// Opens the index, or creates it and its folder. A write-protected index is opened for reading. Errors:
  /// `invalid_input` (not an index, later version, damaged, or on a network disk, where locks are unreliable), `io`
  /// (locked by another program for longer than `wait`, or refused by the disk). Adding a session takes some
  /// milliseconds. On a busy disk, a dozen programs can add sessions by waiting for each other.
  [[nodiscard]] static Result<HistoryIndex> open(const std::filesystem::path& file,
                                                 std::chrono::milliseconds wait = std::chrono::seconds(20));
  HistoryIndex(HistoryIndex&&) noexcept;
  HistoryIndex& operator=(HistoryIndex&&) noexcept;
  ~HistoryIndex();

  /// Returns whether a session with the manifest of this digest is in the index. False if the index cannot be read.
  [[nodiscard]] bool knows(const std::string& manifest_sha256) const;
  /// Adds the session with the conditions of stated_condition(). If the session resumed an interrupted session, its
  /// values replace the values of the interrupted session, because both contain the same frames.
  [[nodiscard]] Result<Adding> add(const HistorySession& session);
  /// Adds an event to the index and to its file of events.
  [[nodiscard]] Result<void> add_event(const HistoryEvent& event);
  /// Returns the sessions of all units, or of the unit with this serial number, ordered by unit and time.
  [[nodiscard]] Result<std::vector<HistorySession>> sessions(const std::optional<std::string>& serial) const;
  /// Returns the events of a unit.
  [[nodiscard]] Result<std::vector<HistoryEvent>> events(const std::string& serial) const;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  HistoryIndex(std::filesystem::path file, std::unique_ptr<sqlite3, Close> database);
  [[nodiscard]] static Result<HistoryIndex> open_read_only(const std::filesystem::path& file);
  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> database_;
};

/// Reads a session to add. Verifies all its files, unless the index knows the session. Errors: those of
/// read_history_session() and verify_history_session().
[[nodiscard]] Result<HistorySession> verified_session(const HistoryIndex& index, const std::filesystem::path& folder);

/// Returns $XDG_DATA_HOME/todbench/history.sqlite, or the same below ~/.local/share.
[[nodiscard]] std::filesystem::path default_history_file();

}  // namespace todbench
