// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/history/history_index.h"

#include <sqlite3.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/session/manifest.h"
#include "bench/text/csv_table.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr int version = 1;
constexpr const char* schema = R"(
CREATE TABLE unit(id INTEGER PRIMARY KEY, vendor TEXT NOT NULL, model TEXT NOT NULL, serial TEXT NOT NULL,
  lens TEXT NOT NULL, UNIQUE(vendor, model, serial, lens)) STRICT;
CREATE TABLE session(id INTEGER PRIMARY KEY, unit INTEGER NOT NULL REFERENCES unit(id), path TEXT NOT NULL,
  manifest_sha256 TEXT NOT NULL UNIQUE, started_utc TEXT NOT NULL, program TEXT NOT NULL, state TEXT NOT NULL,
  firmware TEXT NOT NULL) STRICT;
CREATE TABLE value(session INTEGER NOT NULL REFERENCES session(id), measure TEXT NOT NULL, condition TEXT NOT NULL,
  unit_text TEXT NOT NULL, scale TEXT NOT NULL, value REAL NOT NULL, u REAL NOT NULL,
  PRIMARY KEY(session, measure, condition)) STRICT, WITHOUT ROWID;
CREATE TABLE event(id INTEGER PRIMARY KEY, serial TEXT NOT NULL, utc TEXT NOT NULL, kind TEXT NOT NULL,
  text TEXT NOT NULL) STRICT;
CREATE INDEX session_by_unit ON session(unit, started_utc);
PRAGMA user_version = 1;
)";

/// Magic numbers of statfs(2): NFS, SMB, CIFS, SMB2, AFS, Coda, 9p, Ceph.
constexpr std::array<unsigned long, 8> network_disks{0x6969,     0x517B,     0xFF534D42, 0xFE534D42,
                                                     0x5346414F, 0x73757245, 0x01021997, 0x00C36400};

bool on_network_disk(const std::filesystem::path& folder) {
  struct statfs found {};
  if (::statfs(folder.c_str(), &found) != 0) return false;
  const auto type = static_cast<unsigned long>(found.f_type) & 0xFFFFFFFFUL;
  return std::find(network_disks.begin(), network_disks.end(), type) != network_disks.end();
}

tl::unexpected<Error> refused(sqlite3* database, const std::filesystem::path& file) {
  const int code = sqlite3_extended_errcode(database) & 0xFF;
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED)
    return fail(ErrorCode::io, file.string() + ": another program is writing to this history. Try again");
  if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT) {
    return fail(
        ErrorCode::invalid_input,
        file.string() + ": is not a history or is damaged. Move the file away and add the session folders again");
  }
  return fail(ErrorCode::io, file.string() + ": " + one_line(sqlite3_errmsg(database)));
}

/// Statement that is finalised at destruction.
class Statement {
 public:
  Statement(sqlite3* database, const char* text) {
    good_ = sqlite3_prepare_v2(database, text, -1, &statement_, nullptr) == SQLITE_OK;
  }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  ~Statement() { sqlite3_finalize(statement_); }

  Statement& bind(const std::string& text) {
    good_ = good_ && sqlite3_bind_text(statement_, ++bound_, text.data(), static_cast<int>(text.size()),
                                       SQLITE_TRANSIENT) == SQLITE_OK;
    return *this;
  }
  Statement& bind(double number) {
    good_ = good_ && sqlite3_bind_double(statement_, ++bound_, number) == SQLITE_OK;
    return *this;
  }
  Statement& bind(sqlite3_int64 number) {
    good_ = good_ && sqlite3_bind_int64(statement_, ++bound_, number) == SQLITE_OK;
    return *this;
  }
  /// Resets the statement for the next parameter values.
  Statement& again() {
    good_ = good_ && sqlite3_reset(statement_) == SQLITE_OK;
    bound_ = 0;
    return *this;
  }
  /// Returns SQLITE_ROW, SQLITE_DONE or an error code.
  int step() { return good_ ? sqlite3_step(statement_) : SQLITE_ERROR; }
  [[nodiscard]] std::string text(int column) const {
    const auto* found = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return found == nullptr ? ""
                            : std::string(found, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)));
  }
  [[nodiscard]] double number(int column) const { return sqlite3_column_double(statement_, column); }
  [[nodiscard]] sqlite3_int64 whole(int column) const { return sqlite3_column_int64(statement_, column); }

 private:
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
  bool good_ = false;
};

bool run(sqlite3* database, const char* text) {
  return sqlite3_exec(database, text, nullptr, nullptr, nullptr) == SQLITE_OK;
}

std::filesystem::path events_file(const std::filesystem::path& file) {
  return file.string() + ".events.csv";
}

bool insert_event(sqlite3* database, const HistoryEvent& event) {
  return Statement(database, "INSERT INTO event(serial, utc, kind, text) VALUES(?, ?, ?, ?)")
             .bind(event.serial)
             .bind(event.utc)
             .bind(event.kind)
             .bind(event.text)
             .step() == SQLITE_DONE;
}

/// Reads the events that a lost index contained.
Result<std::vector<HistoryEvent>> kept_events(const std::filesystem::path& file) {
  std::vector<HistoryEvent> events;
  if (!is_there(events_file(file))) return events;
  TODBENCH_TRY(const auto text, read_text_file(events_file(file)));
  TODBENCH_TRY(const auto table, parse_csv(text, events_file(file).string()));
  for (const CsvRow& row : table.rows) {
    if (row.fields.size() != 4) return table.wrong(row.line, "expected serial, utc, kind and text");
    events.push_back({row.fields[0], row.fields[1], row.fields[2], row.fields[3]});
  }
  return events;
}

/// Transaction that is rolled back unless it is committed.
class Transaction {
 public:
  explicit Transaction(sqlite3* database) : database_(database), open_(run(database, "BEGIN IMMEDIATE")) {}
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction() {
    if (open_) (void)run(database_, "ROLLBACK");
  }
  [[nodiscard]] bool open() const { return open_; }
  [[nodiscard]] bool commit() {
    const bool done = run(database_, "COMMIT");
    if (done) open_ = false;
    return done;
  }

 private:
  sqlite3* database_;
  bool open_;
};

/// Switches to a write-ahead log. SQLite does not wait if two programs switch a new file at once, because they could
/// deadlock.
bool keeps_a_log(sqlite3* database, std::chrono::milliseconds wait) {
  constexpr int pause_ms = 20;
  for (int waited_ms = 0;; waited_ms += pause_ms) {
    if (run(database, "PRAGMA journal_mode = WAL")) return true;
    const int code = sqlite3_errcode(database) & 0xFF;
    if ((code != SQLITE_BUSY && code != SQLITE_LOCKED) || waited_ms >= wait.count()) return false;
    sqlite3_sleep(pause_ms);
  }
}

enum class IndexState { made, empty };
/// Returns whether the tables exist. Errors: `invalid_input` (tables of another program).
Result<IndexState> state_of(sqlite3* database, const std::filesystem::path& file) {
  Statement asked(database, "PRAGMA user_version");
  if (asked.step() != SQLITE_ROW) return refused(database, file);
  const sqlite3_int64 found = asked.whole(0);
  if (found == version) return IndexState::made;
  Statement counted(database, "SELECT count(*) FROM sqlite_schema");
  if (counted.step() != SQLITE_ROW) return refused(database, file);
  if (found == 0 && counted.whole(0) == 0) return IndexState::empty;
  return fail(ErrorCode::invalid_input, file.string() + ": is not a history of this version of todbench");
}

Result<void> prepare(sqlite3* database, const std::filesystem::path& file, std::chrono::milliseconds wait) {
  sqlite3_busy_timeout(database, static_cast<int>(wait.count()));
  TODBENCH_TRY(const auto before, state_of(database, file));
  if (!keeps_a_log(database, wait) || !run(database, "PRAGMA foreign_keys = ON; PRAGMA synchronous = NORMAL;"))
    return refused(database, file);
  if (before == IndexState::made) return {};
  TODBENCH_TRY(const auto events, kept_events(file));
  Transaction transaction(database);
  if (!transaction.open()) return refused(database, file);
  // Another program may have created the tables meanwhile.
  TODBENCH_TRY(const auto now, state_of(database, file));
  if (now == IndexState::made) return {};
  if (!run(database, schema)) return refused(database, file);
  for (const HistoryEvent& event : events) {
    if (!insert_event(database, event)) return refused(database, file);
  }
  if (!transaction.commit()) return refused(database, file);
  return {};
}

}  // namespace

void HistoryIndex::Close::operator()(sqlite3* database) const {
  sqlite3_close(database);
}

HistoryIndex::HistoryIndex(std::filesystem::path file, std::unique_ptr<sqlite3, Close> database)
    : file_(std::move(file)), database_(std::move(database)) {}
HistoryIndex::HistoryIndex(HistoryIndex&&) noexcept = default;
HistoryIndex& HistoryIndex::operator=(HistoryIndex&&) noexcept = default;
HistoryIndex::~HistoryIndex() = default;

Result<HistoryIndex> HistoryIndex::open(const std::filesystem::path& file, std::chrono::milliseconds wait) {
  if (std::error_code problem; std::filesystem::is_directory(file, problem))
    return fail(ErrorCode::invalid_input, file.string() + ": is a folder, expected a history file");
  if (is_there(file) && ::access(file.c_str(), W_OK) != 0) return open_read_only(file);
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  TODBENCH_TRY_VOID(make_folder(folder));
  if (on_network_disk(folder)) {
    return fail(ErrorCode::invalid_input,
                file.string() +
                    ": is on a network disk, and two programs can damage it there. Use a local file and fill it from "
                    "the session folders with todbench history add");
  }
  sqlite3* opened = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  std::unique_ptr<sqlite3, Close> database(opened);
  if (code != SQLITE_OK) return refused(opened, file);
  TODBENCH_TRY_VOID(prepare(opened, file, wait));
  return HistoryIndex(file, std::move(database));
}

Result<HistoryIndex> HistoryIndex::open_read_only(const std::filesystem::path& file) {
  std::error_code problem;
  const auto log = std::filesystem::file_size(file.string() + "-wal", problem);
  if (!problem && log > 0) {
    return fail(ErrorCode::io, file.string() +
                                   ": is read-only, and the file with the extension -wal has changes that are not yet "
                                   "merged. Copy both files to a folder that you can write to");
  }
  // The file is immutable here, so it needs no lock and no auxiliary file. Characters with a meaning in a URI are
  // escaped.
  std::string address = "file:";
  for (const char c : std::filesystem::absolute(file, problem).string()) {
    address += c == '%' ? "%25" : c == '?' ? "%3f" : c == '#' ? "%23" : std::string(1, c);
  }
  sqlite3* opened = nullptr;
  const int code =
      sqlite3_open_v2((address + "?immutable=1").c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  std::unique_ptr<sqlite3, Close> database(opened);
  if (code != SQLITE_OK) return refused(opened, file);
  TODBENCH_TRY(const auto state, state_of(opened, file));
  if (state == IndexState::empty)
    return fail(ErrorCode::invalid_input, file.string() + ": is empty, expected a history");
  return HistoryIndex(file, std::move(database));
}

bool HistoryIndex::knows(const std::string& manifest_sha256) const {
  Statement known(database_.get(), "SELECT 1 FROM session WHERE manifest_sha256 = ?");
  return known.bind(manifest_sha256).step() == SQLITE_ROW;
}

Result<HistorySession> verified_session(const HistoryIndex& index, const std::filesystem::path& folder) {
  TODBENCH_TRY(auto session, read_history_session(folder));
  if (!index.knows(session.manifest_sha256)) TODBENCH_TRY_VOID(verify_history_session(folder));
  return session;
}

Result<Adding> HistoryIndex::add(const HistorySession& session) {
  if (session.judged_again) return Adding::judged_again;
  sqlite3* const database = database_.get();
  Transaction transaction(database);
  if (!transaction.open()) return refused(database, file_);
  {
    Statement known(database, "SELECT path FROM session WHERE manifest_sha256 = ?");
    const int found = known.bind(session.manifest_sha256).step();
    if (found != SQLITE_ROW && found != SQLITE_DONE) return refused(database, file_);
    if (found == SQLITE_ROW && known.text(0) == session.path) return Adding::known;
    // A copy: the old place still has the session.
    if (found == SQLITE_ROW && manifest_digest(known.text(0)) == session.manifest_sha256) return Adding::known;
    if (found == SQLITE_ROW) {
      if (Statement(database, "UPDATE session SET path = ? WHERE manifest_sha256 = ?")
              .bind(session.path)
              .bind(session.manifest_sha256)
              .step() != SQLITE_DONE)
        return refused(database, file_);
    }
    if (found == SQLITE_ROW) {
      // A statement that is still on its row would keep the transaction open.
      while (known.step() == SQLITE_ROW) {
      }
      if (!transaction.commit()) return refused(database, file_);
      return Adding::moved;
    }
  }
  const HistoryUnit& unit = session.unit;
  const auto bound = [&](const char* text) {
    Statement statement(database, text);
    return statement.bind(unit.vendor).bind(unit.model).bind(unit.serial).bind(unit.lens).step();
  };
  if (bound("INSERT OR IGNORE INTO unit(vendor, model, serial, lens) VALUES(?, ?, ?, ?)") != SQLITE_DONE)
    return refused(database, file_);
  if (Statement(database,
                "INSERT INTO session(unit, path, manifest_sha256, started_utc, program, state, firmware) SELECT id, ?, "
                "?, ?, ?, ?, ? FROM unit WHERE vendor = ? AND model = ? AND serial = ? AND lens = ?")
          .bind(session.path)
          .bind(session.manifest_sha256)
          .bind(session.started_utc)
          .bind(session.program)
          .bind(session.state)
          .bind(session.firmware)
          .bind(unit.vendor)
          .bind(unit.model)
          .bind(unit.serial)
          .bind(unit.lens)
          .step() != SQLITE_DONE)
    return refused(database, file_);
  const sqlite3_int64 id = sqlite3_last_insert_rowid(database);
  for (const HistoryValue& value : session.values) {
    if (Statement(database, "INSERT OR REPLACE INTO value VALUES(?, ?, ?, ?, ?, ?, ?)")
            .bind(id)
            .bind(value.measure)
            .bind(stated_condition(session, value))
            .bind(value.unit)
            .bind(value.scale)
            .bind(value.value)
            .bind(value.u)
            .step() != SQLITE_DONE)
      return refused(database, file_);
  }
  if (!session.resumes_sha256.empty() &&
      Statement(database, "DELETE FROM value WHERE session IN (SELECT id FROM session WHERE manifest_sha256 = ?)")
              .bind(session.resumes_sha256)
              .step() != SQLITE_DONE)
    return refused(database, file_);
  if (!transaction.commit()) return refused(database, file_);
  return Adding::added;
}

Result<void> HistoryIndex::add_event(const HistoryEvent& event) {
  const auto file = events_file(file_);
  Transaction transaction(database_.get());
  if (!transaction.open()) return refused(database_.get(), file_);
  const bool begun = is_there(file);
  TODBENCH_TRY(auto csv, AppendFile::open(file, AppendFile::Start::at_end));
  const std::string row = csv_field(event.serial) + "," + csv_field(event.utc) + "," + csv_field(event.kind) + "," +
                          csv_field(one_line(event.text)) + "\n";
  TODBENCH_TRY_VOID(csv.append((begun ? "" : "serial,utc,kind,text\n") + row));
  if (!insert_event(database_.get(), event) || !transaction.commit()) return refused(database_.get(), file_);
  return {};
}

Result<std::vector<HistorySession>> HistoryIndex::sessions(const std::optional<std::string>& serial) const {
  sqlite3* const database = database_.get();
  std::vector<HistorySession> sessions;
  Statement asked(
      database,
      "SELECT u.vendor, u.model, u.serial, u.lens, s.path, s.manifest_sha256, s.started_utc, s.program, "
      "s.state, s.firmware, s.id FROM session s JOIN unit u ON u.id = s.unit WHERE ?1 = '' OR u.serial = ?2 "
      "ORDER BY u.vendor, u.model, u.serial, u.lens, s.started_utc, s.id");
  Statement of(database,
               "SELECT measure, condition, unit_text, scale, value, u FROM value WHERE session = ? ORDER BY measure, "
               "condition");
  asked.bind(serial ? std::string("one") : std::string()).bind(serial.value_or(""));
  int found = asked.step();
  for (; found == SQLITE_ROW; found = asked.step()) {
    HistorySession session{.unit = {asked.text(0), asked.text(1), asked.text(2), asked.text(3)},
                           .path = asked.text(4),
                           .manifest_sha256 = asked.text(5),
                           .started_utc = asked.text(6),
                           .program = asked.text(7),
                           .state = asked.text(8),
                           .firmware = asked.text(9),
                           .values = {}};
    of.again().bind(asked.whole(10));
    int row = of.step();
    for (; row == SQLITE_ROW; row = of.step())
      session.values.push_back({of.text(0), of.text(1), of.text(2), of.text(3), of.number(4), of.number(5)});
    if (row != SQLITE_DONE) return refused(database, file_);
    sessions.push_back(std::move(session));
  }
  if (found != SQLITE_DONE) return refused(database, file_);
  return sessions;
}

Result<std::vector<HistoryEvent>> HistoryIndex::events(const std::string& serial) const {
  std::vector<HistoryEvent> events;
  Statement asked(database_.get(), "SELECT serial, utc, kind, text FROM event WHERE serial = ? ORDER BY utc, id");
  asked.bind(serial);
  int found = asked.step();
  for (; found == SQLITE_ROW; found = asked.step())
    events.push_back({asked.text(0), asked.text(1), asked.text(2), asked.text(3)});
  if (found != SQLITE_DONE) return refused(database_.get(), file_);
  return events;
}

std::filesystem::path default_history_file() {
  const char* const data = std::getenv("XDG_DATA_HOME");
  const char* const home = std::getenv("HOME");
  const std::filesystem::path folder = data != nullptr && *data != 0
                                           ? std::filesystem::path(data)
                                           : std::filesystem::path(home != nullptr ? home : ".") / ".local" / "share";
  return folder / "todbench" / "history.sqlite";
}

}  // namespace todbench
