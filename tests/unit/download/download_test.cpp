// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/download.h"

#include <gtest/gtest.h>

#include <csignal>
#include <set>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/fault_server.h"
#include "tests/unit/download/download_target.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

TEST(FileDigests, AreThoseOfThePublicTools) {
  const TemporaryFolder folder;
  const auto digests = digest_file(folder.write("abc", "abc"), {});
  // The test vectors of FIPS 180-2, appendix B.1, and RFC 1321, appendix A.5.
  EXPECT_EQ(digests->sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(digests->md5, "900150983cd24fb0d6963f7d28e17f72");
  EXPECT_EQ(digests->bytes, 3U);
}

TEST(Download, OfAWholeFileLeavesNothingElse) {
  const std::string content = content_of(1);
  const FaultServer server([&](const ServedRequest& r) { return file_response(r, content, kEtag); });
  const Target target;
  DownloadRequest request = target.request({server.url("/data.tgz")});
  request.sha256 = sha256_of(content);
  request.bytes = content.size();
  const auto file = download(request, {});
  ASSERT_TRUE(file);
  EXPECT_EQ(file->digests.sha256, request.sha256);
  EXPECT_EQ(text_of(target.file), content);
  EXPECT_EQ(target.files(), 1U);
  // Again: verified, not downloaded.
  EXPECT_EQ(download(request, {})->url, "");
  EXPECT_EQ(server.requests(), 1);
}

TEST(Download, ContinuesAfterTenCutsAtRandomPlaces) {
  const std::string content = content_of(2);
  std::mt19937 random(3);
  std::atomic<std::uint64_t> sent = 0;
  const FaultServer server([&](const ServedRequest& r) {
    ServedResponse response = file_response(r, content, kEtag);
    if (r.number <= 10) response.cut_after = random() % (kBytes / 12);
    sent += std::min<std::uint64_t>(response.cut_after, response.body.size());
    return response;
  });
  const Target target;
  ASSERT_TRUE(download(target.request({server.url("/data.tgz")}), {}));
  EXPECT_EQ(text_of(target.file), content);
  EXPECT_EQ(server.requests(), 11);
  EXPECT_EQ(sent, kBytes);  // no byte was sent twice
}

TEST(Download, ContinuesAtARestartedServer) {
  const std::string content = content_of(4);
  const Target target;
  int port = 0;
  std::string url;
  {
    const FaultServer server([&](const ServedRequest& r) {
      ServedResponse response = file_response(r, content, kEtag);
      response.cut_after = r.number == 1 ? kBytes / 2 : 0;
      return response;
    });
    port = server.port();
    url = server.url("/data.tgz");
    expect_input_error([&] { static_cast<void>(download(target.request({url}), {})); },
                       {"could not be downloaded", "try again later"});
    EXPECT_FALSE(fs::exists(target.file));
  }
  std::uint64_t first_byte = 0;
  const FaultServer restarted(
      [&](const ServedRequest& r) {
        first_byte = r.first_byte();
        return file_response(r, content, kEtag);
      },
      port);
  ASSERT_TRUE(download(target.request({url}), {}));
  EXPECT_EQ(first_byte, kBytes / 2);
  EXPECT_EQ(text_of(target.file), content);
}

TEST(Download, BeginsAgainWhenAResumedFileHasAnotherDigest) {
  const std::string content = content_of(10);
  const FaultServer server([&](const ServedRequest& r) { return file_response(r, content, kEtag); });
  const Target target;
  DownloadRequest request = target.request({server.url("/data.tgz")});
  request.sha256 = sha256_of(content);
  {
    PartialFile part(target.file);
    part.restart({.url = request.urls.front(), .etag = kEtag, .last_modified = "", .total = kBytes});
    part.append("damaged bytes");
  }
  ASSERT_TRUE(download(request, {}));
  EXPECT_EQ(text_of(target.file), content);
}

/// The first response is cut in the middle, then the content changes. @param with_condition whether the
/// server evaluates If-Range
void expect_changed_content_is_downloaded_whole(bool with_condition) {
  const std::string old_content = content_of(13);
  const std::string new_content = content_of(14, kBytes + 5);
  const FaultServer server([&](ServedRequest r) {
    if (r.number == 1) {
      ServedResponse response = file_response(r, old_content, kEtag);
      response.cut_after = kBytes / 2;
      return response;
    }
    if (!with_condition) r.headers.erase("if-range");
    return file_response(r, new_content, "\"v2\"");
  });
  const Target target;
  ASSERT_TRUE(download(target.request({server.url("/data.tgz")}), {}));
  EXPECT_EQ(text_of(target.file), new_content);
}

TEST(Download, BeginsAgainWhenTheFileChangedSinceTheStart) {
  expect_changed_content_is_downloaded_whole(true);
  expect_changed_content_is_downloaded_whole(false);
}

TEST(Download, BeginsAgainAtAServerWithoutRanges) {
  const std::string content = content_of(15);
  const FaultServer server([&](const ServedRequest& r) {
    return ServedResponse{
        .headers = {}, .body = content, .cut_after = r.number == 1 ? kBytes / 3 : UINT64_MAX};
  });
  const Target target;
  ASSERT_TRUE(download(target.request({server.url("/data.tgz")}), {}));
  EXPECT_EQ(text_of(target.file), content);
}

TEST(Download, ContinuesAfterAFullDisk) {
  const std::string content = content_of(16);
  const FaultServer server([&](const ServedRequest& r) { return file_response(r, content, kEtag); });
  const Target target;
  rlimit unlimited{};
  getrlimit(RLIMIT_FSIZE, &unlimited);
  const rlimit half{kBytes / 2, unlimited.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &half);
  expect_input_error([&] { static_cast<void>(download(target.request({server.url("/data.tgz")}), {})); },
                     {"cannot be written", "free disk space"});
  setrlimit(RLIMIT_FSIZE, &unlimited);
  std::signal(SIGXFSZ, handler);
  EXPECT_FALSE(fs::exists(target.file));
  EXPECT_EQ(fs::file_size(target.file.string() + ".part"), kBytes / 2);
  ASSERT_TRUE(download(target.request({server.url("/data.tgz")}), {}));
  EXPECT_EQ(text_of(target.file), content);
}

TEST(Download, ContinuesAfterAStop) {
  const std::string content = content_of(17);
  const FaultServer server([&](const ServedRequest& r) {
    ServedResponse response = file_response(r, content, kEtag);
    if (r.number == 1) response.pause_ms = 1;
    return response;
  });
  const Target target;
  std::uint64_t received = 0;
  const TransferControl control{.progress = [&](std::uint64_t done, std::uint64_t) { received = done; },
                                .stop = [&] { return received > 10'000; },
                                .report = {}};
  EXPECT_FALSE(download(target.request({server.url("/data.tgz")}), control));
  EXPECT_FALSE(fs::exists(target.file));
  EXPECT_GT(fs::file_size(target.file.string() + ".part"), 10'000U);
  ASSERT_TRUE(download(target.request({server.url("/data.tgz")}), {}));
  EXPECT_EQ(text_of(target.file), content);
}

TEST(Download, UsesTheNextMirrorWhenOneFails) {
  const std::string content = content_of(18);
  const FaultServer broken(
      [](const ServedRequest&) { return ServedResponse{.status = 404, .headers = {}, .body = ""}; });
  const FaultServer mirror([&](const ServedRequest& r) { return file_response(r, content, kEtag); });
  const Target target;
  const auto file = download(target.request({broken.url("/data.tgz"), mirror.url("/data.tgz")}), {});
  ASSERT_TRUE(file);
  EXPECT_EQ(file->url, mirror.url("/data.tgz"));
}

TEST(Download, VerifiesTheDigestBesideTheFile) {
  const std::string content = content_of(19);
  std::string md5 = "00000000000000000000000000000000";
  const FaultServer server([&](const ServedRequest& r) {
    if (r.path.ends_with(".md5")) return ServedResponse{.headers = {}, .body = md5 + "  data.tgz\n"};
    return file_response(r, content, kEtag);
  });
  const Target target;
  DownloadRequest request = target.request({server.url("/data.tgz")});
  request.md5_suffix = ".md5";
  expect_input_error([&] { static_cast<void>(download(request, {})); }, {"has the MD5", md5});
  const TemporaryFolder folder;
  md5 = digest_file(folder.write("content", content), {})->md5;
  EXPECT_TRUE(download(request, {}));
  EXPECT_EQ(target.files(), 1U);
}

TEST(Download, SendsNameAndTokenToTheFirstHostOnly) {
  const std::string content = content_of(20);
  std::set<std::string> agents;
  std::string redirected_token = "none";
  const FaultServer other([&](const ServedRequest& r) {
    redirected_token = r.header("authorization");
    return file_response(r, content, kEtag);
  });
  std::string token;
  const FaultServer server([&](const ServedRequest& r) {
    token = r.header("authorization");
    agents.insert(r.header("user-agent"));
    const std::string location = "Location: http://localhost:" + std::to_string(other.port()) + "/data.tgz";
    return ServedResponse{.status = 302, .headers = {location}, .body = ""};
  });
  const Target target;
  DownloadRequest request = target.request({server.url("/data.tgz")});
  request.settings.user_agent = "browser";
  request.settings.token = "secret";
  ASSERT_TRUE(download(request, {}));
  EXPECT_EQ(token, "Bearer secret");
  EXPECT_EQ(redirected_token, "");
  EXPECT_EQ(agents, std::set<std::string>{"browser"});
}

/// Peak resident memory of a process that downloads a large file [bytes].
long peak_of_download(const std::string& url, const fs::path& file) {
  const pid_t child = fork();
  if (child == 0) {
    DownloadRequest request{.file = file, .urls = {url}};
    const bool complete = download(request, {}).has_value();
    _exit(complete ? 0 : 1);
  }
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  EXPECT_EQ(status, 0);
  return usage.ru_maxrss * 1024L;
}

TEST(Download, OfALargeFileUsesLittleMemory) {
  const char* large = std::getenv("STILLPOINT_LARGE_DOWNLOAD");  // bytes; by hand: 2 GB
  const std::uint64_t bytes = large != nullptr ? std::stoull(large) : 100'000'000;
  const FaultServer server(
      [&](const ServedRequest&) { return ServedResponse{.headers = {}, .body = "", .zeros = bytes}; });
  const Target target;
  const long peak = peak_of_download(server.url("/zeros"), target.folder.path() / "zeros");
  EXPECT_EQ(fs::file_size(target.folder.path() / "zeros"), bytes);
  EXPECT_LT(peak, 50'000'000);
  std::cout << "peak memory " << peak / 1'000'000 << " MB for " << bytes / 1'000'000 << " MB\n";
}

}  // namespace
}  // namespace stillpoint::datasets
