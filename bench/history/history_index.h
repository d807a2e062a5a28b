// An SQLite index of sessions by unit: never the truth itself, for it can be made again from the session folders.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/history/history_session.h"

struct sqlite3;

namespace todbench {

/// Something that happened to a unit: its charts begin anew after it.
struct HistoryEvent {
  std::string serial, utc, kind, text;
};

enum class Adding {
  added,
  known,  ///< the same manifest at the same place, or a copy of the session that is still there
  moved,  ///< the same manifest at another place, and no longer where it was
};

/// Events are kept in FILE.events.csv beside the index, which no session folder holds; an index that is made again
/// reads them. One writer at a time; one thread.
class HistoryIndex {
 public:
  /// Opens the index, or makes it with its folder. `invalid_input`: no index, of a later version, damaged, or on a
  /// network disk, where locks are not kept. `io`: locked by another program, or refused by the disk.
  [[nodiscard]] static Result<HistoryIndex> open(const std::filesystem::path& file);
  HistoryIndex(HistoryIndex&&) noexcept;
  HistoryIndex& operator=(HistoryIndex&&) noexcept;
  ~HistoryIndex();

  [[nodiscard]] Result<Adding> add(const HistorySession& session);
  [[nodiscard]] Result<void> add_event(const HistoryEvent& event);
  /// Of every unit, or of those with this serial number, in the order of time. Without values where they are not asked
  /// for.
  [[nodiscard]] Result<std::vector<HistorySession>> sessions(const std::optional<std::string>& serial) const;
  [[nodiscard]] Result<std::vector<HistoryEvent>> events(const std::string& serial) const;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  HistoryIndex(std::filesystem::path file, std::unique_ptr<sqlite3, Close> database);
  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> database_;
};

/// $XDG_DATA_HOME/todbench/history.sqlite, or below ~/.local/share.
[[nodiscard]] std::filesystem::path default_history_file();

}  // namespace todbench
