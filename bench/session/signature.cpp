// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/signature.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "acquisition/base/process.h"
#include "acquisition/base/try.h"
#include "bench/session/manifest.h"
#include "bench/session/open_session.h"
#include "bench/text/files.h"
#include "bench/text/json.h"
#include "bench/text/json_file.h"
#include "bench/text/json_reader.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::string_view signature_record = "signature.json";
constexpr std::string_view signature_schema = "todbench-signature-2";
constexpr std::string_view revisions_folder = "revisions/";
constexpr std::string_view revisions_record = "revisions/revisions.json";
constexpr std::string_view revisions_schema = "todbench-revisions-3";

/// Returns the name of the detached signature of a file.
std::string signature_of(std::string_view file, SigningProgram program) {
  return std::string(file) + (program == SigningProgram::minisign ? ".minisig" : ".sig");
}

/// Private temporary file of this process, removed at the end.
class OwnFile {
 public:
  OwnFile() {
    std::error_code problem;
    std::string name = (std::filesystem::temp_directory_path(problem) / "todbench-key-XXXXXX").string();
    const int descriptor = ::mkstemp(name.data());
    if (descriptor < 0) return;
    ::close(descriptor);
    path_ = name;
  }
  OwnFile(const OwnFile&) = delete;
  OwnFile& operator=(const OwnFile&) = delete;
  ~OwnFile() {
    std::error_code problem;
    if (!path_.empty()) std::filesystem::remove(path_, problem);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A relative path may begin with a hyphen, which a program would read as an option.
std::string argument(const std::filesystem::path& path) {
  std::error_code problem;
  const auto absolute = std::filesystem::absolute(path, problem);
  return (problem ? path : absolute).string();
}

Result<void> require_file(const std::filesystem::path& file) {
  std::error_code problem;
  if (std::filesystem::is_regular_file(file, problem)) return {};
  return fail(ErrorCode::invalid_input, file.string() + ": there is no such key file");
}

/// Runs a program. On failure the message is the last line of its output.
Result<void> run_well(const std::vector<std::string>& words, ProgramOutput output, const std::stop_token& stop = {}) {
  TODBENCH_TRY(const auto run, run_program(words, output, stop));
  if (stop.stop_requested() || run.exit_code == 128 + SIGINT)
    return fail(ErrorCode::interrupted, words.front() + " was interrupted");
  if (run.exit_code == 0) return {};
  std::string said = run.output;
  while (!said.empty() && said.back() == '\n') said.pop_back();
  const std::size_t line = said.find_last_of('\n');
  if (line != std::string::npos) said = said.substr(line + 1);
  return fail(ErrorCode::invalid_input, words.front() + " failed" + (said.empty() ? "" : ": " + one_line(said)));
}

/// Signs with a digest, or without one for keys that sign the whole text (Ed25519).
Result<void> openssl_sign(const std::string& key, const std::string& file, const std::string& signature) {
  const auto digest =
      run_well({"openssl", "dgst", "-sha256", "-sign", key, "-out", signature, file}, ProgramOutput::kept);
  if (digest || digest.error().code == ErrorCode::not_found) return digest;
  return run_well({"openssl", "pkeyutl", "-sign", "-rawin", "-inkey", key, "-in", file, "-out", signature},
                  ProgramOutput::kept);
}

Result<void> openssl_verify(const std::string& key, const std::string& file, const std::string& signature) {
  const auto digest =
      run_well({"openssl", "dgst", "-sha256", "-verify", key, "-signature", signature, file}, ProgramOutput::kept);
  if (digest || digest.error().code == ErrorCode::not_found) return digest;
  return run_well(
      {"openssl", "pkeyutl", "-verify", "-pubin", "-inkey", key, "-rawin", "-in", file, "-sigfile", signature},
      ProgramOutput::kept);
}

Result<void> sign_file(SigningProgram with, const std::string& key, const std::string& file,
                       const std::string& signature, const std::stop_token& stop) {
  if (with == SigningProgram::openssl) return openssl_sign(key, file, signature);
  return run_well({"minisign", "-S", "-s", key, "-m", file, "-x", signature}, ProgramOutput::shown, stop);
}

Result<void> verify_file(SigningProgram with, const std::string& key, const std::string& file,
                         const std::string& signature) {
  if (with == SigningProgram::openssl) return openssl_verify(key, file, signature);
  return run_well({"minisign", "-V", "-q", "-p", key, "-m", file, "-x", signature}, ProgramOutput::kept);
}

/// Returns the detached signature of a text.
Result<std::string> signature_over(std::string_view text, SigningProgram with, const std::filesystem::path& key,
                                   const std::stop_token& stop) {
  const OwnFile file, signature;
  if (file.path().empty() || signature.path().empty()) return fail(ErrorCode::io, "no temporary file can be created");
  if (auto written = write_file_atomically(file.path(), text); !written) return tl::unexpected(written.error());
  if (auto done = sign_file(with, argument(key), file.path().string(), signature.path().string(), stop); !done)
    return tl::unexpected(done.error());
  return read_text_file(signature.path());
}

/// Writes the detached signature of a session file next to it. The current content is signed.
Result<void> sign_in(const std::filesystem::path& folder, std::string_view file, SigningProgram with,
                     const std::filesystem::path& key, const std::stop_token& stop) {
  TODBENCH_TRY(const auto text, read_text_file(folder / file));
  TODBENCH_TRY(const auto signature, signature_over(text, with, key, stop));
  return write_file_atomically(folder / signature_of(file, with), signature);
}

/// Returns whether the detached signature next to a session file matches the file and the key.
Result<bool> is_signed_in(const std::filesystem::path& folder, std::string_view file, SigningProgram with,
                          const std::string& key) {
  const auto signature = folder / signature_of(file, with);
  if (!is_there(signature)) return false;
  const auto verified = verify_file(with, key, argument(folder / file), argument(signature));
  if (!verified && verified.error().code != ErrorCode::invalid_input) return tl::unexpected(verified.error());
  return verified.has_value();
}

/// Returns the public key of a secret one, in the format of its program.
Result<std::string> public_key_of(SigningProgram with, const std::string& secret_key, const std::stop_token& stop) {
  const OwnFile file;
  const std::string out = file.path().string();
  if (out.empty()) return fail(ErrorCode::io, "no temporary file can be created");
  if (with == SigningProgram::minisign) {
    // The program does not overwrite a file.
    std::error_code problem;
    std::filesystem::remove(out, problem);
  }
  if (const auto made =
          with == SigningProgram::openssl
              ? run_well({"openssl", "pkey", "-in", secret_key, "-pubout", "-out", out}, ProgramOutput::kept)
              : run_well({"minisign", "-R", "-s", secret_key, "-p", out}, ProgramOutput::shown, stop);
      !made)
    return tl::unexpected(made.error());
  return read_text_file(out);
}

void signature_fields(JsonFields& json, SessionSignature& signature) {
  // Every schema that is accepted signs this record; another would hold for a changed time of signing.
  json.constant("schema", signature_schema);
  json.value("with", signature.with, signing_programs);
  json.value("signed_utc", signature.signed_utc);
  json.value("manifest_sha256", signature.manifest_sha256);
  json.value("manifest_file_sha256", signature.manifest_file_sha256);
  json.derived("key_sha256", signature.key_sha256());
  json.value("public_key", signature.public_key);
}

Result<SessionSignature> read_signature(const std::filesystem::path& folder) {
  return read_record_file<SessionSignature>(folder / signature_record, signature_fields);
}

Result<Json> revisions_of(const std::filesystem::path& folder) {
  if (!is_there(folder / revisions_record)) return Json{{"schema", revisions_schema}, {"revisions", Json::array()}};
  auto json = read_json_file(folder / revisions_record);
  if (!json) return json;
  if (!json->is_object() || !json->contains("revisions") || !(*json)["revisions"].is_array())
    return fail(ErrorCode::invalid_input, (folder / revisions_record).string() + ": expected a list of revisions");
  return json;
}

/// Returns whether the path is a file directly in the folder of revisions.
bool is_revision_page(std::string_view path) {
  return path.starts_with(revisions_folder) && path.find('/', revisions_folder.size()) == std::string_view::npos;
}

/// Returns pages and digests of a list of revisions.
Result<std::vector<std::pair<std::string, std::string>>> pages_of(const Json& json) {
  std::vector<std::pair<std::string, std::string>> pages;
  const JsonReader reader(json);
  for (const JsonReader& revision : reader.at("revisions").elements()) {
    for (const JsonReader& page : revision.at("pages").elements())
      pages.emplace_back(page.at("path").text(), page.at("sha256").text());
  }
  if (auto finished = reader.finish(); !finished) return tl::unexpected(finished.error());
  return pages;
}

/// Returns the digests of the records of revisions, in order. Each record has its number and the digest of the record
/// before; the first has that of signature.json. Empty if a record does not follow.
Result<std::optional<std::vector<std::string>>> chain_of(const std::filesystem::path& folder, const Json& revisions) {
  TODBENCH_TRY(std::string before, sha256_of_file(folder / signature_record));
  std::vector<std::string> digests;
  for (const Json& record : revisions) {
    if (!record.is_object() || record.value("number", Json()) != Json(digests.size() + 2) ||
        record.value("previous_sha256", Json()) != Json(before))
      return std::nullopt;
    before = sha256_of(record.dump());
    digests.push_back(before);
  }
  return digests;
}

bool has_signed_revisions(const std::filesystem::path& folder, SigningProgram with) {
  return is_there(folder / revisions_record) && is_there(folder / signature_of(revisions_record, with));
}

/// Returns the reason why the list of revisions is invalid; empty if it is valid, and `digests` are then those of the
/// records. An unsigned list confirms no files: they are foreign.
Result<std::string> wrong_revision(const std::filesystem::path& folder, SigningProgram with, const std::string& key,
                                   std::vector<std::string>& digests) {
  if (!has_signed_revisions(folder, with)) return std::string();
  TODBENCH_TRY(const auto holds, is_signed_in(folder, revisions_record, with, key));
  if (!holds) return "the signature does not belong to " + std::string(revisions_record) + " and this key";
  TODBENCH_TRY(const auto json, revisions_of(folder));
  TODBENCH_TRY(const auto manifest, sha256_of_file(folder / manifest_name));
  if (json.value("manifest_file_sha256", Json()) != Json(manifest))
    return std::string(revisions_record) + " belongs to another session";
  TODBENCH_TRY(auto chain, chain_of(folder, json["revisions"]));
  if (!chain) return std::string(revisions_record) + ": a revision does not follow the one before it";
  const auto pages = pages_of(json);
  if (!pages) return fail((folder / revisions_record).string(), pages.error());
  for (const auto& [path, expected] : *pages) {
    const auto digest = sha256_of_file(folder / path);
    if (!is_revision_page(path) || !digest || *digest != expected)
      return path + " was changed after the revision was written";
  }
  digests = *std::move(chain);
  return std::string();
}

Result<void> require_whole(const std::filesystem::path& folder) {
  TODBENCH_TRY(const auto check, check_session(folder));
  if (check.condition == SessionCondition::intact) return {};
  return fail(ErrorCode::invalid_input, folder.string() + ": a session that is not intact cannot be signed: " +
                                            (check.sentence.empty() ? "files are missing or foreign" : check.sentence));
}

}  // namespace

std::string_view to_string(SigningProgram program) {
  return program == SigningProgram::minisign ? "minisign" : "openssl";
}

std::string SessionSignature::key_sha256() const {
  return sha256_of(public_key);
}

bool is_signed(const std::filesystem::path& folder) {
  return is_there(folder / signature_record);
}

Result<void> require_unsigned(const std::filesystem::path& folder) {
  if (!is_signed(folder)) return {};
  return fail(ErrorCode::invalid_input,
              folder.string() +
                  ": the session is signed and cannot be changed. To add a revision of its report, use "
                  "todbench report --reason TEXT --key FILE");
}

Result<SessionSignature> sign_session(const std::filesystem::path& folder, SigningProgram with,
                                      const std::filesystem::path& secret_key, const std::string& signed_utc,
                                      const std::stop_token& stop) {
  if (is_signed(folder)) return fail(ErrorCode::invalid_input, folder.string() + ": the session is already signed");
  if (auto found = require_file(secret_key); !found) return tl::unexpected(found.error());
  if (auto whole = require_whole(folder); !whole) return tl::unexpected(whole.error());
  SessionSignature made{.with = with, .signed_utc = signed_utc};
  TODBENCH_TRY(made.manifest_sha256, manifest_digest(folder));
  TODBENCH_TRY(made.manifest_file_sha256, sha256_of_file(folder / manifest_name));
  TODBENCH_TRY(auto public_key, public_key_of(with, argument(secret_key), stop));
  made.public_key = std::move(public_key);
  auto done = sign_in(folder, manifest_name, with, secret_key, stop);
  if (done) done = write_json_file(folder / signature_record, json_of(made, signature_fields));
  if (done) done = sign_in(folder, signature_record, with, secret_key, stop);
  if (!done) {
    std::error_code problem;
    for (const std::string& file :
         {signature_of(manifest_name, with), std::string(signature_record), signature_of(signature_record, with)})
      std::filesystem::remove(folder / file, problem);
    return tl::unexpected(done.error());
  }
  return made;
}

Result<std::optional<SignatureCheck>> check_signature(const std::filesystem::path& folder,
                                                      const std::optional<std::filesystem::path>& public_key) {
  if (!is_signed(folder)) return std::nullopt;
  TODBENCH_TRY(auto signature, read_signature(folder));
  SignatureCheck check{.signature = std::move(signature), .own_key = !public_key};
  const OwnFile own;
  std::string key = own.path().string();
  if (public_key) {
    if (auto found = require_file(*public_key); !found) return tl::unexpected(found.error());
    key = argument(*public_key);
  } else if (auto written = write_file_atomically(own.path(), check.signature.public_key); !written) {
    return tl::unexpected(written.error());
  }
  const SigningProgram with = check.signature.with;
  TODBENCH_TRY(const auto manifest_holds, is_signed_in(folder, manifest_name, with, key));
  if (!manifest_holds) {
    check.sentence = "the signature does not belong to this manifest and key";
    return check;
  }
  check.covers.emplace_back(manifest_name);
  TODBENCH_TRY(const auto time_holds, is_signed_in(folder, signature_record, with, key));
  TODBENCH_TRY(const auto digest, sha256_of_file(folder / manifest_name));
  if (!time_holds || digest != check.signature.manifest_file_sha256) {
    check.sentence = "the time of signing was changed: the signature does not belong to " +
                     std::string(signature_record) + " and this key";
    return check;
  }
  check.covers.emplace_back("signed_utc");
  TODBENCH_TRY(const auto wrong, wrong_revision(folder, with, key, check.revision_sha256));
  if (!wrong.empty()) {
    check.sentence = wrong;
    return check;
  }
  if (has_signed_revisions(folder, with)) check.covers.emplace_back("revisions");
  check.valid = true;
  return check;
}

Result<ReportRevision> next_revision(const std::filesystem::path& folder, const std::string& reason,
                                     const std::string& utc) {
  if (!is_signed(folder))
    return fail(ErrorCode::invalid_input,
                folder.string() + ": the session is not signed, so its report is rebuilt without a reason");
  if (reason.find_first_not_of(" \t\n") == std::string::npos)
    return fail(ErrorCode::invalid_input, folder.string() + ": a revision of a signed report needs a reason");
  TODBENCH_TRY(const auto check, check_signature(folder, std::nullopt));
  if (check && !check->valid)
    return fail(ErrorCode::invalid_input, folder.string() + ": the revision was not added: " + check->sentence);
  TODBENCH_TRY(const auto json, revisions_of(folder));
  return ReportRevision{static_cast<int>(json["revisions"].size()) + 2, utc, one_line(reason)};
}

Result<void> require_key_of_session(const std::filesystem::path& folder, const std::filesystem::path& secret_key,
                                    const std::stop_token& stop) {
  if (auto found = require_file(secret_key); !found) return found;
  TODBENCH_TRY(const auto signature, read_signature(folder));
  TODBENCH_TRY(const auto key, public_key_of(signature.with, argument(secret_key), stop));
  if (key == signature.public_key) return {};
  return fail(ErrorCode::invalid_input, secret_key.string() + ": this key did not sign the session");
}

std::string revision_page(const ReportRevision& revision, std::string_view extension) {
  return "revisions/report-" + std::to_string(revision.number) + "." + std::string(extension);
}

Result<void> keep_revision(const std::filesystem::path& folder, const ReportRevision& revision,
                           const std::vector<std::string>& pages, const std::filesystem::path& secret_key,
                           const std::stop_token& stop) {
  if (auto found = require_file(secret_key); !found) return found;
  TODBENCH_TRY(auto json, revisions_of(folder));
  TODBENCH_TRY(const auto signature, read_signature(folder));
  TODBENCH_TRY(const auto manifest, sha256_of_file(folder / manifest_name));
  json["schema"] = revisions_schema;
  json["manifest_file_sha256"] = manifest;
  Json listed = Json::array();
  for (const std::string& page : pages) {
    TODBENCH_TRY(const auto digest, sha256_of_file(folder / page));
    listed.push_back({{"path", page}, {"sha256", digest}});
  }
  TODBENCH_TRY(const auto chain, chain_of(folder, json["revisions"]));
  if (!chain) return fail(ErrorCode::invalid_input, (folder / revisions_record).string() + ": revisions are missing");
  TODBENCH_TRY(const auto first, sha256_of_file(folder / signature_record));
  json["revisions"].push_back({{"number", revision.number},
                               {"previous_sha256", chain->empty() ? first : chain->back()},
                               {"utc", revision.utc},
                               {"reason", revision.reason},
                               {"pages", listed}});
  if (auto written = write_file_atomically(folder / revisions_record, to_page(json)); !written) return written;
  return sign_in(folder, revisions_record, signature.with, secret_key, stop);
}

std::vector<std::string> files_of_signature(const std::filesystem::path& folder) {
  if (!is_signed(folder)) return {};
  const auto signature = read_signature(folder);
  if (!signature) return {std::string(signature_record)};
  const SigningProgram with = signature->with;
  std::vector<std::string> files{std::string(signature_record), signature_of(manifest_name, with),
                                 signature_of(signature_record, with)};
  if (!has_signed_revisions(folder, with)) return files;
  files.emplace_back(revisions_record);
  files.push_back(signature_of(revisions_record, with));
  const auto json = revisions_of(folder);
  const auto pages = json ? pages_of(*json) : tl::unexpected(json.error());
  if (!pages) return files;
  for (const auto& [path, digest] : *pages) files.push_back(path);
  return files;
}

}  // namespace todbench
