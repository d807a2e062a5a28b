// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/open_session.h"

#include <algorithm>
#include <iterator>

#include "acquisition/base/try.h"
#include "bench/session/foreign_files.h"
#include "bench/session/signature.h"
#include "bench/text/files.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::size_t files_in_a_sentence = 4;

/// Returns whether provenance.json states the state running, even if the file is otherwise invalid.
bool says_running(const std::filesystem::path& folder) {
  const Result<std::string> text = read_text_file(folder / "provenance.json");
  if (!text) return false;
  const Json json = Json::parse(*text, nullptr, false);
  return json.is_object() && json.contains("state") && json["state"] == to_string(SessionState::running);
}

/// Returns "a", "a and b" or "a, b, c, d and 3 more".
std::string listed(std::vector<std::string> files) {
  if (files.size() > files_in_a_sentence) {
    const std::size_t more = files.size() - files_in_a_sentence;
    files.resize(files_in_a_sentence);
    files.push_back(std::to_string(more) + " more");
  }
  std::string text = files.front();
  for (std::size_t i = 1; i < files.size(); ++i) text += (i + 1 < files.size() ? ", " : " and ") + files[i];
  return text;
}

struct Kind {
  std::vector<std::string> files;
  std::string_view one, more;  ///< event in singular and plural
};

std::string sentence_of(const std::vector<Kind>& kinds) {
  std::string text;
  for (const Kind& kind : kinds) {
    if (kind.files.empty()) continue;
    text += (text.empty() ? "" : ", ") + listed(kind.files) + " " +
            std::string(kind.files.size() == 1 ? kind.one : kind.more);
  }
  return text.empty() ? "" : text + " after the session ended";
}

/// States what is wrong with links, and the remedy; empty without links.
std::string sentence_of_links(const std::vector<std::string>& links) {
  if (links.empty()) return "";
  const bool one = links.size() == 1;
  return listed(links) +
         (one ? " is a symbolic link or lies in a linked folder" : " are symbolic links or lie in a linked folder") +
         ", so that " + (one ? "its" : "their") + " content can change at any time: put a copy in place of " +
         (one ? "the link" : "each link");
}

}  // namespace

std::string_view to_string(SessionCondition condition) {
  switch (condition) {
    case SessionCondition::intact:
      return "intact";
    case SessionCondition::changed:
      return "changed";
    case SessionCondition::cut_off:
      return "cut_off";
  }
  return "";
}

Result<SessionCheck> check_session(const std::filesystem::path& folder) {
  if (!is_there(folder / "session.toml") && !is_there(folder / manifest_name)) {
    return fail(ErrorCode::invalid_input, folder.string() + ": not a session folder (there is no session.toml)");
  }
  TODBENCH_TRY(ManifestCheck files, check_manifest(folder));
  SessionCheck check{
      .condition = SessionCondition::intact, .files = std::move(files), .not_vouched_for = {}, .sentence = {}};
  if (!is_there(folder / manifest_name) && says_running(folder)) {
    check.condition = SessionCondition::cut_off;
    check.not_vouched_for = check.files.missing;
    check.sentence = "the run is not finished or was cut off. There is no manifest, so the files cannot be verified";
    return check;
  }
  Kind changed{check.files.changed, "was changed", "were changed"};
  Kind missing{{}, "was removed", "were removed"};
  Kind added{{}, "was added", "were added"};
  std::copy_if(check.files.missing.begin(), check.files.missing.end(), std::back_inserter(missing.files),
               [](const std::string& path) { return !is_report_page(path); });
  std::copy_if(check.files.foreign.begin(), check.files.foreign.end(), std::back_inserter(added.files),
               is_session_file);
  for (const Kind* kind : {&changed, &missing, &added})
    check.not_vouched_for.insert(check.not_vouched_for.end(), kind->files.begin(), kind->files.end());
  check.not_vouched_for.insert(check.not_vouched_for.end(), check.files.links.begin(), check.files.links.end());
  std::sort(check.not_vouched_for.begin(), check.not_vouched_for.end());
  const auto twice = std::unique(check.not_vouched_for.begin(), check.not_vouched_for.end());
  check.not_vouched_for.erase(twice, check.not_vouched_for.end());
  if (!check.files.intact()) check.condition = SessionCondition::changed;
  if (!check.not_vouched_for.empty()) {
    const std::string links = sentence_of_links(check.files.links);
    check.sentence = sentence_of({changed, missing, added});
    check.sentence += (check.sentence.empty() || links.empty() ? "" : "; ") + links;
  }
  return check;
}

Result<Session> open_session(const std::filesystem::path& folder, const Opening& opening) {
  TODBENCH_TRY(const SessionCheck check, check_session(folder));
  const bool cut_off = check.condition == SessionCondition::cut_off;
  const bool vouched_for = check.not_vouched_for.empty();
  const bool taken = vouched_for || opening.accept_changed || (cut_off && opening.accept_cut_off);
  if (!taken) {
    return fail(ErrorCode::invalid_input, folder.string() + ": " + (cut_off ? "" : "the session was changed: ") +
                                              check.sentence +
                                              (opening.may_accept ? " (use --accept-changed to read it anyway)" : ""));
  }
  Result<Session> session = read_session(folder);
  if (!session) return session;
  session->cut_off = cut_off;
  session->manifest_sha256 = check.files.manifest_sha256;
  if (!cut_off || !opening.accept_cut_off) session->accepted_changes = check.not_vouched_for;
  return session;
}

Result<void> require_intact(const std::filesystem::path& folder) {
  TODBENCH_TRY(const SessionCheck check, check_session(folder));
  if (check.not_vouched_for.empty()) {
    TODBENCH_TRY_VOID(require_no_foreign_file(folder));
    return require_unsigned(folder);
  }
  return fail(ErrorCode::invalid_input, folder.string() + ": the session was changed: " + check.sentence);
}

}  // namespace todbench
