// SPDX-License-Identifier: BSD-3-Clause
// Servers that fail or send something else than the file.
#include "datasets/download/download.h"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/support/expect_input_error.h"
#include "tests/support/fault_server.h"
#include "tests/unit/download/download_target.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

TEST(Download, EndsAtOnceWhenTheFileIsMissingOrForbidden) {
  for (const int status : {404, 403}) {
    const FaultServer server([&](const ServedRequest&) {
      return ServedResponse{.status = status, .headers = {}, .body = "<html>no</html>"};
    });
    const Target target;
    expect_input_error([&] { static_cast<void>(download(target.request({server.url("/data.tgz")}), {})); },
                       {"HTTP status " + std::to_string(status),
                        status == 403 ? "require a token), see `stillpoint data catalogue" : "no such file"});
    EXPECT_EQ(server.requests(), 1);
    EXPECT_FALSE(fs::exists(target.file));
  }
}

TEST(Download, RepeatsTemporaryFailures) {
  const std::string content = content_of(5);
  for (const int status : {500, 503, 429}) {
    const FaultServer server([&](const ServedRequest& r) {
      if (r.number <= 2) return ServedResponse{.status = status, .headers = {}, .body = "busy"};
      return file_response(r, content, kEtag);
    });
    const Target target;
    ASSERT_TRUE(download(target.request({server.url("/data.tgz")}), {})) << status;
    EXPECT_EQ(text_of(target.file), content);
  }
}

TEST(Download, WaitsAsLongAsTheServerRequests) {
  const std::string content = content_of(6);
  const FaultServer server([&](const ServedRequest& r) {
    if (r.number == 1) return ServedResponse{.status = 429, .headers = {"Retry-After: 1"}, .body = ""};
    return file_response(r, content, kEtag);
  });
  const Target target;
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(download(target.request({server.url("/data.tgz")}), {}));
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(990));
}

TEST(Download, RejectsAnotherLengthThanExpectedBeforeItsBody) {
  const std::string content = content_of(7);
  const FaultServer server([&](const ServedRequest& r) { return file_response(r, content, kEtag); });
  const Target target;
  DownloadRequest request = target.request({server.url("/data.tgz")});
  request.bytes = kBytes + 1;
  expect_input_error([&] { static_cast<void>(download(request, {})); },
                     {"offers 1000000 bytes, expected 1000001"});
  EXPECT_FALSE(fs::exists(target.file));
}

TEST(Download, DoesNotAcceptFewerBytesThanDeclared) {
  const std::string content = content_of(8);
  const FaultServer server([&](const ServedRequest&) {
    return ServedResponse{.headers = {}, .body = content, .declared_length = kBytes + 1000};
  });
  const Target target;
  expect_input_error([&] { static_cast<void>(download(target.request({server.url("/data.tgz")}), {})); },
                     {"could not be downloaded"});
  EXPECT_FALSE(fs::exists(target.file));
}

TEST(Download, RemovesAFileWithAnotherDigest) {
  const std::string content = content_of(9);
  const FaultServer server([&](const ServedRequest& r) { return file_response(r, content, kEtag); });
  const Target target;
  DownloadRequest request = target.request({server.url("/data.tgz")});
  request.sha256 = sha256_of("other");
  expect_input_error([&] { static_cast<void>(download(request, {})); }, {"has the SHA-256", request.sha256});
  EXPECT_EQ(target.files(), 0U);
}

TEST(Download, RejectsAPageWithStatus200) {
  const FaultServer server([&](const ServedRequest&) {
    return ServedResponse{.headers = {}, .body = "\n<!DOCTYPE html><html>maintenance</html>"};
  });
  const Target target;
  expect_input_error([&] { static_cast<void>(download(target.request({server.url("/data.tgz")}), {})); },
                     {"HTML page"});
  EXPECT_EQ(server.requests(), 1);
  EXPECT_FALSE(fs::exists(target.file));
}

TEST(Download, RejectsContentThatContradictsTheExtension) {
  const FaultServer server(
      [&](const ServedRequest&) { return ServedResponse{.headers = {}, .body = "not found, sorry"}; });
  const Target target;
  expect_input_error([&] { static_cast<void>(download(target.request({server.url("/data.tgz")}), {})); },
                     {"is not a gzip file"});
  EXPECT_EQ(target.files(), 0U);
}

TEST(Download, FollowsRedirectsButNoLoop) {
  const std::string content = content_of(11);
  const FaultServer server([&](const ServedRequest& r) {
    if (r.path == "/data.tgz")
      return ServedResponse{.status = 302, .headers = {"Location: /moved.tgz"}, .body = ""};
    if (r.path == "/loop.tgz")
      return ServedResponse{.status = 302, .headers = {"Location: /loop.tgz"}, .body = ""};
    return file_response(r, content, kEtag);
  });
  const Target target;
  expect_input_error([&] { static_cast<void>(download(target.request({server.url("/loop.tgz")}), {})); },
                     {"redirects"});
  ASSERT_TRUE(download(target.request({server.url("/data.tgz")}), {}));
  EXPECT_EQ(text_of(target.file), content);
}

TEST(Download, EndsAttemptsOfAServerThatStalls) {
  const std::string content = content_of(12);
  const FaultServer server([&](const ServedRequest& r) {
    ServedResponse response = file_response(r, content, kEtag);
    response.pause_ms = 2500;
    return response;
  });
  const Target target;
  DownloadRequest request = target.request({server.url("/data.tgz")});
  request.settings.stall_timeout_s = 1;
  request.attempts = 1;
  expect_input_error([&] { static_cast<void>(download(request, {})); }, {"Timeout"});
}

}  // namespace
}  // namespace stillpoint::datasets
