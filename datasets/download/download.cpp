// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/download.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <poll.h>

#include "core/base/error.h"
#include "datasets/download/transfer_checks.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxBackoffS = 60.0;
constexpr double kMaxRequestedWaitS = 600.0;
constexpr int kWaitStepMs = 100;
constexpr std::size_t kMd5Digits = 32;

/// Waits; a signal ends the current step. @return false if stopped
bool wait(double seconds, const TransferControl& control) {
  using Clock = std::chrono::steady_clock;
  const auto end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  while (Clock::now() < end) {
    if (is_stopped(control)) return false;
    poll(nullptr, 0, kWaitStepMs);
  }
  return !is_stopped(control);
}

/// Transfers the whole file from one address, with several attempts. Attempts are counted from the last one
/// that received something.
TransferResult transfer_with_retries(const std::string& url, PartialFile& part,
                                     const DownloadRequest& request, const TransferControl& control) {
  for (int attempt = 1;; ++attempt) {
    const std::uint64_t before = part.state().url == url ? part.bytes() : 0;
    TransferResult result = transfer({url, request.bytes}, part, request.settings, control);
    if (result.outcome != TransferOutcome::kTemporary) return result;
    if (part.bytes() > before) attempt = 1;
    if (attempt >= request.attempts) return result;
    const double backoff_s =
        std::min(kMaxBackoffS, request.first_backoff_s * std::pow(2.0, static_cast<double>(attempt - 1)));
    const double wait_s = std::max(backoff_s, std::min(result.retry_after_s, kMaxRequestedWaitS));
    report_line(control, fmt::format("{}: {}; next attempt in {:.1f} s", url, result.problem, wait_s));
    if (!wait(wait_s, control)) return {TransferOutcome::kStopped, "", 0.0};
  }
}

/// What contradicts the request; empty if nothing does.
std::string digest_problem(const CryptographicDigests& found, const DownloadRequest& request) {
  if (request.bytes != 0 && found.bytes != request.bytes)
    return fmt::format("has {} bytes, expected {}", found.bytes, request.bytes);
  if (!request.sha256.empty() && found.sha256 != request.sha256)
    return "has the SHA-256 " + found.sha256 + ", expected " + request.sha256;
  if (!request.md5.empty() && found.md5 != request.md5)
    return "has the MD5 " + found.md5 + ", expected " + request.md5;
  return "";
}

void remove_part(const fs::path& file) {
  std::error_code ignored;
  fs::remove(file.string() + ".part", ignored);
  fs::remove(file.string() + ".part.state", ignored);
}

/// The digest that the server publishes beside the file; empty if it cannot be had.
std::string published_md5(const std::string& url, const DownloadRequest& request,
                          const TransferControl& control) {
  const fs::path file = request.file.string() + ".md5";
  std::string text;
  {
    PartialFile part(file);
    part.restart({});
    const TransferControl quiet{.progress = {}, .stop = control.stop, .report = {}};
    if (transfer({.url = url + request.md5_suffix}, part, request.settings, quiet).outcome ==
        TransferOutcome::kComplete) {
      std::ifstream input(part.path());
      text.assign(std::istreambuf_iterator<char>(input), {});
    }
  }
  remove_part(file);
  text = text.substr(0, text.find_first_of(" \t\r\n"));
  const bool is_digest =
      text.size() == kMd5Digits && text.find_first_not_of("0123456789abcdef") == std::string::npos;
  return is_digest ? text : "";
}

/// Result of one address: a verified file, a problem, or neither if stopped.
struct AddressResult {
  std::optional<DownloadedFile> file;
  std::string problem;
};

AddressResult download_from(const std::string& url, DownloadRequest request, const TransferControl& control) {
  if (!request.md5_suffix.empty() && request.md5.empty()) request.md5 = published_md5(url, request, control);
  PartialFile part(request.file);
  const bool was_resumed = part.bytes() > 0 && part.state().url == url;
  const TransferResult result = transfer_with_retries(url, part, request, control);
  if (result.outcome == TransferOutcome::kStopped) return {};
  if (result.outcome == TransferOutcome::kDenied)
    return {std::nullopt, result.problem + ", see `stillpoint data catalogue NAME`"};
  if (result.outcome != TransferOutcome::kComplete) return {std::nullopt, result.problem};
  std::string problem = content_problem(part.path(), request.file.filename().string());
  if (problem.empty()) {
    const std::optional<CryptographicDigests> digests = digest_file(part.path(), control);
    if (!digests) return {};
    problem = digest_problem(*digests, request);
    if (problem.empty()) {
      part.complete();
      return {DownloadedFile{*digests, url}, ""};
    }
  }
  remove_part(request.file);
  if (!was_resumed) return {std::nullopt, problem};
  // The bytes of an earlier run may be damaged.
  report_line(control, fmt::format("{}: {}; downloading it again", url, problem));
  return download_from(url, request, control);
}

}  // namespace

std::optional<DownloadedFile> download(const DownloadRequest& request, const TransferControl& control) {
  if (fs::exists(request.file)) {
    const std::optional<CryptographicDigests> digests = digest_file(request.file, control);
    if (!digests) return std::nullopt;
    const std::string problem = digest_problem(*digests, request);
    if (problem.empty()) return DownloadedFile{*digests, ""};
    throw InputError(request.file.string(),
                     problem + "; it was changed or belongs to another program: move it away");
  }
  std::string problems;
  for (const std::string& url : request.urls) {
    AddressResult result = download_from(url, request, control);
    if (result.file) return result.file;
    if (is_stopped(control)) return std::nullopt;
    problems += url + ": " + result.problem + "; ";
    if (&url != &request.urls.back()) report_line(control, url + ": " + result.problem + "; next mirror");
  }
  throw InputError(
      request.file.filename().string(),
      "could not be downloaded: " + problems + "try again later, or set another server with --mirror");
}

}  // namespace stillpoint::datasets
