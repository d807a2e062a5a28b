// SPDX-License-Identifier: GPL-3.0-or-later
// Signed sessions: a detached signature of manifest.json, made and verified by standard programs with the user's keys.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Program that signs and verifies.
enum class SigningProgram { minisign, openssl };
inline constexpr std::array signing_programs{SigningProgram::minisign, SigningProgram::openssl};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(SigningProgram program);

/// Content of signature.json. The signatures of manifest.json and signature.json are files next to them (.sig or
/// .minisig).
struct SessionSignature {
  SigningProgram with = SigningProgram::openssl;
  std::string signed_utc;
  std::string manifest_sha256{};       ///< digest of the signed manifest
  std::string manifest_file_sha256{};  ///< SHA-256 of the file manifest.json
  std::string public_key{};            ///< public key in the format of its program
  [[nodiscard]] std::string key_sha256() const;
};

/// Returns whether the session has a signature. Does not verify it.
[[nodiscard]] bool is_signed(const std::filesystem::path& folder);
/// Fails if the session is signed, because a signed session is never modified. Errors: `invalid_input` with the action
/// to take.
[[nodiscard]] Result<void> require_unsigned(const std::filesystem::path& folder);

/// Signs an intact session with a secret key; `signed_utc`: time of signing to record. The program asks for a
/// passphrase on the terminal; a stop request ends it. Errors: `invalid_input` (not intact, already signed, no such
/// key, or rejected by the program, with its message), `not_found` (no such program), `interrupted`.
[[nodiscard]] Result<SessionSignature> sign_session(const std::filesystem::path& folder, SigningProgram with,
                                                    const std::filesystem::path& secret_key,
                                                    const std::string& signed_utc, const std::stop_token& stop = {});

/// Revision of the report of a signed session. The session stays unchanged and counts as revision 1.
struct ReportRevision {
  int number = 2;
  std::string utc, reason;
};

/// Result of a verification.
struct SignatureCheck {
  SessionSignature signature;
  bool valid = false;
  /// True if the signature was verified with the key in the folder. The verification does not prove who owns the key.
  bool own_key = true;
  std::string sentence{};  ///< reason if not valid
  /// Contents confirmed by valid signatures: "manifest.json", "signed_utc" and "revisions".
  std::vector<std::string> covers{};
  /// SHA-256 of the signed record of each revision, from revision 2 on. Each record contains the digest of the previous
  /// record. The folder alone cannot reveal that the newest revisions were removed; a digest kept elsewhere reveals the
  /// removal.
  std::vector<std::string> revision_sha256{};
};
/// Verifies the signatures of manifest.json, signature.json and the list of revisions, and the digests of the
/// revisions. Empty if the session is not signed. check_session() compares the files with the manifest. Errors:
/// `invalid_input` (no such key), `not_found` (no such program).
[[nodiscard]] Result<std::optional<SignatureCheck>> check_signature(
    const std::filesystem::path& folder, const std::optional<std::filesystem::path>& public_key);

/// Returns the next revision. Errors: `invalid_input` (not signed, no reason given, unreadable list of revisions).
[[nodiscard]] Result<ReportRevision> next_revision(const std::filesystem::path& folder, const std::string& reason,
                                                   const std::string& utc);
/// Returns the path of a page of a revision: "revisions/report-2.html".
[[nodiscard]] std::string revision_page(const ReportRevision& revision, std::string_view extension);
/// Adds a revision to the list, with the digests of its pages, and signs the list with the secret key of the session.
/// The pages must exist. Errors: `invalid_input` (no such key, or rejected by the program), `io` with the path.
[[nodiscard]] Result<void> keep_revision(const std::filesystem::path& folder, const ReportRevision& revision,
                                         const std::vector<std::string>& pages, const std::filesystem::path& secret_key,
                                         const std::stop_token& stop = {});
/// Succeeds if the session was signed with this secret key. Errors: those of sign_session().
[[nodiscard]] Result<void> require_key_of_session(const std::filesystem::path& folder,
                                                  const std::filesystem::path& secret_key,
                                                  const std::stop_token& stop = {});

/// Returns the files that a signature adds to a session, with paths relative to its folder: the signature and the
/// listed and signed revisions. Does not check their validity. Empty if the session is not signed.
[[nodiscard]] std::vector<std::string> files_of_signature(const std::filesystem::path& folder);

}  // namespace todbench
