// A session that its responsible signed: a detached signature over manifest.json, made and checked by ordinary programs
// with keys of their user.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

enum class SigningProgram { minisign, openssl };
inline constexpr std::array signing_programs{SigningProgram::minisign, SigningProgram::openssl};
[[nodiscard]] std::string_view to_string(SigningProgram program);

/// signature.json of a session. The signature itself is manifest.json.minisig or manifest.json.sig.
struct SessionSignature {
  SigningProgram with = SigningProgram::openssl;
  std::string signed_utc;
  std::string manifest_sha256;  ///< digest of the manifest that was signed
  std::string public_key;       ///< as its program writes it
  [[nodiscard]] std::string key_sha256() const;
};

[[nodiscard]] bool is_signed(const std::filesystem::path& folder);
/// `invalid_input` with what to do where the session is signed: nothing of it is written again.
[[nodiscard]] Result<void> require_unsigned(const std::filesystem::path& folder);

/// Signs an intact session with a secret key; `signed_utc` is the time to be stated. The program asks for a passphrase
/// on the terminal. `invalid_input`: not intact, signed already, there is no such key, or the
/// program refuses it, with its words. `not_found`: no such program.
[[nodiscard]] Result<SessionSignature> sign_session(const std::filesystem::path& folder, SigningProgram with,
                                                    const std::filesystem::path& secret_key,
                                                    const std::string& signed_utc);

/// A revision of the report of a signed session, which itself stays as it is and is the first.
struct ReportRevision {
  int number = 2;
  std::string utc, reason;
};

struct SignatureCheck {
  SessionSignature signature;
  bool valid = false;
  bool own_key = true;   ///< checked with the key that came with the folder: it does not say whose it is
  std::string sentence;  ///< why it is not valid
};
/// Nothing: the session is not signed. Checks the signature of manifest.json and the digests of revisions; whether the
/// files are those of the manifest is check_session(). `invalid_input`:
/// no such key. `not_found`: no such program.
[[nodiscard]] Result<std::optional<SignatureCheck>> check_signature(
    const std::filesystem::path& folder, const std::optional<std::filesystem::path>& public_key);

/// The next revision. `invalid_input`: not signed, no reason, or a list of revisions that cannot be read.
[[nodiscard]] Result<ReportRevision> next_revision(const std::filesystem::path& folder, const std::string& reason,
                                                   const std::string& utc);
/// The folder of revisions, and the file of one: "revisions/report-2.html".
[[nodiscard]] std::string revision_page(const ReportRevision& revision, std::string_view extension);
/// Lists a revision whose pages are written, with their digests. `io` with the path.
[[nodiscard]] Result<void> keep_revision(const std::filesystem::path& folder, const ReportRevision& revision,
                                         const std::vector<std::string>& pages);

}  // namespace todbench
