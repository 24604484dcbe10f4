// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/http_transfer.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

#include <curl/curl.h>
#include <fmt/format.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kFileMode = 0666;

/// The state as lines: address, ETag, Last-Modified, bytes. HTTP headers have no line breaks.
std::string state_text(const ContentState& state) {
  return state.url + "\n" + state.etag + "\n" + state.last_modified + "\n" + std::to_string(state.total) +
         "\n";
}

/// An empty state if the file is not readable as one.
ContentState read_state(const fs::path& file) {
  std::ifstream input(file);
  ContentState state;
  std::string total;
  if (!std::getline(input, state.url) || !std::getline(input, state.etag) ||
      !std::getline(input, state.last_modified) || !std::getline(input, total))
    return {};
  const auto [end, error] = std::from_chars(total.data(), total.data() + total.size(), state.total);
  return error == std::errc{} && end == total.data() + total.size() ? state : ContentState{};
}

[[noreturn]] void throw_write_error(const fs::path& file, int error) {
  throw InputError(file.string(), std::string("cannot be written: ") + std::strerror(error) +
                                      "; free disk space or choose another folder with --to, then run the "
                                      "command again: it continues");
}

}  // namespace

bool is_same_content(const ContentState& a, const ContentState& b) {
  if (!a.etag.empty() && !b.etag.empty() && a.etag != b.etag) return false;
  if (!a.last_modified.empty() && !b.last_modified.empty() && a.last_modified != b.last_modified)
    return false;
  if (a.total != 0 && b.total != 0 && a.total != b.total) return false;
  return (!a.etag.empty() && a.etag == b.etag) ||
         (!a.last_modified.empty() && a.last_modified == b.last_modified) ||
         (a.total != 0 && a.total == b.total);
}

PartialFile::PartialFile(const fs::path& file)
    : file_(file), part_(file.string() + ".part"), state_file_(file.string() + ".part.state") {
  descriptor_ = open(part_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kFileMode);
  if (descriptor_ < 0) throw_write_error(part_, errno);
  state_ = read_state(state_file_);
  if (state_.url.empty()) {
    if (ftruncate(descriptor_, 0) != 0) throw_write_error(part_, errno);
    return;
  }
  const off_t end = lseek(descriptor_, 0, SEEK_END);
  if (end < 0) throw_write_error(part_, errno);
  bytes_ = static_cast<std::uint64_t>(end);
}

PartialFile::~PartialFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void PartialFile::restart(const ContentState& state) {
  if (ftruncate(descriptor_, 0) != 0 || lseek(descriptor_, 0, SEEK_SET) != 0) throw_write_error(part_, errno);
  bytes_ = 0;
  state_ = state;
  std::ofstream output(state_file_, std::ios::binary);
  output << state_text(state) << std::flush;
  if (!output) throw_write_error(state_file_, ENOSPC);
}

void PartialFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_write_error(part_, errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
    bytes_ += static_cast<std::uint64_t>(count);
  }
}

void PartialFile::complete() {
  if (fsync(descriptor_) != 0) throw_write_error(part_, errno);
  std::error_code error;
  fs::rename(part_, file_, error);
  if (error) throw InputError(file_.string(), "cannot be written: " + error.message());
  fs::remove(state_file_, error);
}

namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

std::optional<std::uint64_t> number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<ContentRange> parse_content_range(std::string_view text) {
  constexpr std::string_view kUnit = "bytes ";
  text = trimmed(text);
  if (!text.starts_with(kUnit)) return std::nullopt;
  text = trimmed(text.substr(kUnit.size()));
  const std::size_t dash = text.find('-');
  const std::size_t slash = text.find('/');
  if (dash == std::string_view::npos || slash == std::string_view::npos || slash < dash) return std::nullopt;
  const auto first = number(text.substr(0, dash));
  const auto last = number(text.substr(dash + 1, slash - dash - 1));
  const std::string_view size = text.substr(slash + 1);
  const auto total = size == "*" ? std::optional<std::uint64_t>(0) : number(size);
  if (!first || !last || !total || *last < *first || (size != "*" && *last >= *total)) return std::nullopt;
  return ContentRange{*first, *last, *total};
}

ResponseHeaders with_header_line(ResponseHeaders headers, std::string_view line) {
  if (line.starts_with("HTTP/")) return {};
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return headers;
  std::string name(line.substr(0, colon));
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (name == "etag" && !value.starts_with("W/")) headers.etag = value;
  if (name == "last-modified") headers.last_modified = value;
  if (name == "content-range") headers.range = parse_content_range(value);
  if (name == "content-length") headers.content_length = number(value).value_or(0);
  return headers;
}

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

// NOLINTNEXTLINE(readability-function-size): libcurl prescribes the parameters
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
    return {TransferOutcome::kDenied, problem + " (access denied: the host may require a token)", 0.0};
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
