// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/http_transfer.h"

#include <exception>
#include <memory>

#include <curl/curl.h>
#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/download/disk_space.h"
#include "datasets/download/file_kind.h"
#include "datasets/download/response_headers.h"

namespace stillpoint::datasets {
namespace {

constexpr long kHttpOk = 200;
constexpr long kHttpPartial = 206;
constexpr long kHttpRangeNotSatisfiable = 416;
constexpr long kMinBytesPerS = 1000;

/// State of one attempt; receives the callbacks of libcurl, which must not be left by exceptions.
struct Attempt {
  CURL* handle = nullptr;
  const std::string& url;
  PartialFile& part;
  std::uint64_t expected_bytes;
  const TransferControl& control;
  ResponseHeaders headers;
  bool body_started = false;
  bool discards_body = false;  ///< of an error response
  std::string rejection;       ///< why this response was rejected
  bool is_temporary = false;   ///< whether the rejection may be overcome by another attempt
  std::exception_ptr error;    ///< of writing
};

long status_of(const Attempt& attempt) {
  long status = 0;
  curl_easy_getinfo(attempt.handle, CURLINFO_RESPONSE_CODE, &status);
  return status;
}

std::uint64_t total_of(const Attempt& attempt) {
  if (attempt.headers.range) return attempt.headers.range->total;
  return status_of(attempt) == kHttpOk ? attempt.headers.content_length : 0;
}

bool reject(Attempt& attempt, const std::string& problem, bool is_temporary = false) {
  attempt.rejection = problem;
  attempt.is_temporary = is_temporary;
  return false;
}

/// Whether the body continues the partial file.
bool continues(const Attempt& attempt, const ContentState& offered) {
  return status_of(attempt) == kHttpPartial && attempt.headers.range &&
         attempt.headers.range->first == attempt.part.bytes() &&
         is_same_content(attempt.part.state(), offered);
}

/// Called with the first bytes of a body. @return false to end the transfer
bool accept_body(Attempt& attempt, std::string_view first_bytes) {
  const long status = status_of(attempt);
  if (status != kHttpOk && status != kHttpPartial) {
    attempt.discards_body = true;
    return true;
  }
  const ContentState offered{.url = attempt.url,
                             .etag = attempt.headers.etag,
                             .last_modified = attempt.headers.last_modified,
                             .total = total_of(attempt)};
  if (attempt.expected_bytes != 0 && offered.total != 0 && offered.total != attempt.expected_bytes) {
    return reject(attempt,
                  fmt::format("offers {} bytes, expected {}", offered.total, attempt.expected_bytes));
  }
  if (status == kHttpPartial) {
    if (!continues(attempt, offered)) {
      attempt.part.restart({});
      return reject(attempt, "the file has changed since the download was started", true);
    }
  } else {
    if (is_html(first_bytes)) return reject(attempt, "answers with an HTML page instead of the file");
    attempt.part.restart(offered);
  }
  if (offered.total > attempt.part.bytes())
    require_disk_space(attempt.part.path().parent_path(), offered.total - attempt.part.bytes());
  return true;
}

std::size_t on_header(char* bytes, std::size_t, std::size_t count, void* context) {
  auto& attempt = *static_cast<Attempt*>(context);
  attempt.headers = with_header_line(std::move(attempt.headers), {bytes, count});
  return count;
}

std::size_t on_body(char* bytes, std::size_t, std::size_t count, void* context) {
  auto& attempt = *static_cast<Attempt*>(context);
  constexpr std::size_t kEndTransfer = CURL_WRITEFUNC_ERROR;
  try {
    if (!attempt.body_started && !accept_body(attempt, {bytes, count})) return kEndTransfer;
    attempt.body_started = true;
    if (attempt.discards_body) return count;
    if (attempt.expected_bytes != 0 && attempt.part.bytes() + count > attempt.expected_bytes) {
      reject(attempt, fmt::format("sends more than the expected {} bytes", attempt.expected_bytes));
      return kEndTransfer;
    }
    attempt.part.append({bytes, count});
    report_progress(attempt.control, attempt.part.bytes(), attempt.part.state().total);
    return count;
  } catch (...) {
    attempt.error = std::current_exception();
    return kEndTransfer;
  }
}

int on_progress(void* context, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return is_stopped(static_cast<Attempt*>(context)->control) ? 1 : 0;
}

using Handle = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;
using HeaderList = std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)>;

void set_limits(CURL* curl, const TransferSettings& settings) {
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(curl, CURLOPT_MAXREDIRS, static_cast<long>(settings.max_redirects));
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, static_cast<long>(settings.connect_timeout_s));
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, kMinBytesPerS);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, static_cast<long>(settings.stall_timeout_s));
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  const std::string agent = settings.user_agent.empty() ? "stillpoint" : settings.user_agent;
  curl_easy_setopt(curl, CURLOPT_USERAGENT, agent.c_str());
  if (settings.token.empty()) return;
  curl_easy_setopt(curl, CURLOPT_HTTPAUTH, CURLAUTH_BEARER);
  curl_easy_setopt(curl, CURLOPT_XOAUTH2_BEARER, settings.token.c_str());
}

void set_callbacks(CURL* curl, Attempt& attempt) {
  curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, on_header);
  curl_easy_setopt(curl, CURLOPT_HEADERDATA, &attempt);
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, on_body);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, &attempt);
  curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, on_progress);
  curl_easy_setopt(curl, CURLOPT_XFERINFODATA, &attempt);
  curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
}

/// The conditional header of a resumed transfer: a server with other content answers with all of it.
HeaderList if_range(const ContentState& state) {
  const std::string& validator = state.etag.empty() ? state.last_modified : state.etag;
  HeaderList list(nullptr, curl_slist_free_all);
  if (!validator.empty()) list.reset(curl_slist_append(nullptr, ("If-Range: " + validator).c_str()));
  return list;
}

bool is_temporary_failure(CURLcode code) {
  switch (code) {
    case CURLE_TOO_MANY_REDIRECTS:
    case CURLE_UNSUPPORTED_PROTOCOL:
    case CURLE_URL_MALFORMAT:
    case CURLE_PEER_FAILED_VERIFICATION:
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_OUT_OF_MEMORY:
      return false;
    default:
      return true;
  }
}

TransferResult http_failure(long status, double retry_after_s) {
  const bool is_temporary = status == 408 || status == 425 || status == 429 || status >= 500;
  std::string problem = fmt::format("answers with HTTP status {}", status);
  if (status == 401 || status == 403)
    problem += " (access denied: the host may require a token, see `stillpoint data catalogue NAME`)";
  if (status == 404 || status == 410) problem += " (no such file)";
  return {is_temporary ? TransferOutcome::kTemporary : TransferOutcome::kPermanent, problem, retry_after_s};
}

/// Result of a transfer that libcurl completed.
TransferResult completed_result(const Attempt& attempt) {
  const std::uint64_t total = attempt.part.state().total;
  if (status_of(attempt) == kHttpRangeNotSatisfiable) {
    if (total != 0 && attempt.part.bytes() == total) return {TransferOutcome::kComplete, "", 0.0};
    attempt.part.restart({});
    return {TransferOutcome::kTemporary, "does not have the missing bytes any more", 0.0};
  }
  if (status_of(attempt) >= 300 || status_of(attempt) < 200) {
    curl_off_t retry_after_s = 0;
    curl_easy_getinfo(attempt.handle, CURLINFO_RETRY_AFTER, &retry_after_s);
    return http_failure(status_of(attempt), static_cast<double>(retry_after_s));
  }
  const std::uint64_t expected = attempt.expected_bytes != 0 ? attempt.expected_bytes : total;
  if (!attempt.body_started || (expected != 0 && attempt.part.bytes() != expected)) {
    return {TransferOutcome::kTemporary,
            fmt::format("sent {} of {} bytes", attempt.body_started ? attempt.part.bytes() : 0, expected),
            0.0};
  }
  return {TransferOutcome::kComplete, "", 0.0};
}

TransferResult result_of(const Attempt& attempt, CURLcode code) {
  if (attempt.error) std::rethrow_exception(attempt.error);
  if (!attempt.rejection.empty()) {
    return {attempt.is_temporary ? TransferOutcome::kTemporary : TransferOutcome::kPermanent,
            attempt.rejection, 0.0};
  }
  if (code == CURLE_ABORTED_BY_CALLBACK) return {TransferOutcome::kStopped, "", 0.0};
  if (code == CURLE_OK) return completed_result(attempt);
  return {is_temporary_failure(code) ? TransferOutcome::kTemporary : TransferOutcome::kPermanent,
          curl_easy_strerror(code), 0.0};
}

}  // namespace

TransferResult transfer(const TransferSource& source, PartialFile& part, const TransferSettings& settings,
                        const TransferControl& control) {
  const Handle curl(curl_easy_init(), curl_easy_cleanup);
  STILLPOINT_CHECK(curl != nullptr);
  if (part.state().url != source.url) part.restart({});
  Attempt attempt{.handle = curl.get(),
                  .url = source.url,
                  .part = part,
                  .expected_bytes = source.expected_bytes,
                  .control = control,
                  .headers = {},
                  .rejection = {},
                  .error = {}};
  curl_easy_setopt(curl.get(), CURLOPT_URL, source.url.c_str());
  set_limits(curl.get(), settings);
  set_callbacks(curl.get(), attempt);
  const std::string range = fmt::format("{}-", part.bytes());
  const HeaderList conditions = part.bytes() > 0 ? if_range(part.state()) : if_range({});
  if (part.bytes() > 0) curl_easy_setopt(curl.get(), CURLOPT_RANGE, range.c_str());
  curl_easy_setopt(curl.get(), CURLOPT_HTTPHEADER, conditions.get());
  return result_of(attempt, curl_easy_perform(curl.get()));
}

}  // namespace stillpoint::datasets
