// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint data get`, `list` and `verify` with a server on this machine.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <thread>

#include <sys/mount.h>
#include <unistd.h>

#include "datasets/bags/bag_file.h"
#include "datasets/bags/messages.h"
#include "tests/support/sequences/dataset_host.h"
#include "tests/support/sequences/sequence_folders.h"
#include "tests/support/test_data.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOneSequence = "[[sequences]]\nfiles = [\"{}.tgz\"]\nmembers = [\"a\"]\n";

/// A host with the TUM sequence mini/a, with `filler` bytes that do not compress.
void offer_mini(const DatasetHost& host, std::size_t filler = 0) {
  std::vector<TestEntry> entries = sequence_entries(write_tum_folder, "a/");
  std::mt19937 random(7);
  std::string noise(filler, '\0');
  for (char& byte : noise) byte = static_cast<char>(random());
  entries.push_back({"a/notes.bin", noise});
  host.offer("mini/a.tgz", entries);
  host.add_dataset("mini", kOneSequence);
}

TEST(DataGet, RegistersASequenceThatVerifyAndRunUse) {
  const DatasetHost host;
  offer_mini(host);
  const ProgramResult got = host.get({"mini/a"});
  ASSERT_EQ(got.exit_code, 0) << got.err;
  EXPECT_NE(got.out.find("registered mini_a"), std::string::npos) << got.out;
  EXPECT_NE(got.out.find("no digest is published"), std::string::npos) << got.out;
  EXPECT_NE(host.run({"data", "list"}).out.find("mini_a"), std::string::npos);
  EXPECT_NE(host.run({"data", "catalogue", "mini"}).out.find("available"), std::string::npos);
  EXPECT_EQ(host.run({"data", "verify"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(host.data() / "mini/downloads/a.tgz"));
  EXPECT_EQ(host.get({"mini/a"}).exit_code, 0);  // again: nothing to do
  EXPECT_EQ(host.requests(), 1);
  std::ofstream(host.data() / "mini/a/rgb.txt", std::ios::app) << "# changed\n";
  const ProgramResult verified = host.run({"data", "verify", "mini_*"});
  EXPECT_EQ(verified.exit_code, 1);
  EXPECT_NE(verified.out.find("CHANGED"), std::string::npos);
}

std::string bytes_of_small_bag() {
  const TemporaryFolder folder;
  datasets::BagWriter bag(folder.path() / "a.bag", datasets::ChunkCompression::kNone);
  const std::uint32_t imu = bag.add_connection("/imu", "sensor_msgs/Imu");
  for (int i = 0; i < 100; ++i) {
    const Timestamp t{1'000'000'000 + 1'000'000 * i};
    bag.write(imu, t, serialize(datasets::ImuMessage{.header = {.stamp = t, .frame = "imu"}}, bag.format()));
  }
  bag.finish();
  std::ifstream input(folder.path() / "a.bag", std::ios::binary);
  return {std::istreambuf_iterator<char>(input), {}};
}

TEST(DataGet, ABagThatEndsEarlyIsNotRegistered) {
  const DatasetHost host;
  const std::string bag = bytes_of_small_bag();
  fs::create_directories(host.path() / "host/lab");
  std::ofstream(host.path() / "host/lab/whole.bag", std::ios::binary) << bag;
  std::ofstream(host.path() / "host/lab/cut.bag", std::ios::binary) << bag.substr(0, bag.size() / 2);
  host.add_dataset("lab",
                   "[[sequences]]\nfiles = [\"{}.bag\"]\nfolder = \"{}.bag\"\n"
                   "members = [\"whole\", \"cut\"]\n");
  const ProgramResult whole = host.get({"lab/whole"});
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  const ProgramResult cut = host.get({"lab/cut"});
  EXPECT_EQ(cut.exit_code, 2) << cut.out;
  EXPECT_NE(cut.err.find("cut.bag: ends before its first message"), std::string::npos) << cut.err;
  EXPECT_EQ(host.registered(), 1U);
}

TEST(DataGet, ReadsTheArchivesOfAllHosts) {
  const DatasetHost host;
  // OpenLORIS: a tar with one 7z per sequence. EuRoC: a zip of zips without top folders. 7-Scenes: a zip of
  // zips. ICL-NUIM: no top folder.
  host.offer(
      "lab/cafe.tar",
      {{"cafe1-1.7z", archive_bytes("cafe1-1.7z", sequence_entries(write_openloris_folder, "cafe1-1/"))},
       {"cafe1-2.7z", archive_bytes("cafe1-2.7z", sequence_entries(write_openloris_folder, "cafe1-2/"))}});
  host.offer("lab/room.zip",
             {{"room/V1/V1.zip", archive_bytes("V1.zip", sequence_entries(write_euroc_folder, ""))}});
  host.offer("lab/kitchen.zip",
             {{"kitchen/seq-01.zip",
               archive_bytes("seq-01.zip", sequence_entries(write_seven_scenes_folder, "seq-01/"))}});
  host.offer("lab/flat.tar.gz", sequence_entries(write_tum_folder, ""));
  host.add_dataset("lab", R"([[sequences]]
group = "cafe"
files = ["cafe.tar"]
members = ["cafe1-1", "cafe1-2"]
[[sequences]]
files = ["room.zip"]
folder = "room/{}/{}"
members = ["V1"]
[[sequences]]
files = ["kitchen.zip"]
folder = "{}/seq-01"
members = ["kitchen"]
[[sequences]]
files = ["{}.tar.gz"]
members = ["flat"]
)");
  const ProgramResult got = host.get({"lab/cafe1-1", "lab/V1", "lab/kitchen", "lab/flat"});
  ASSERT_EQ(got.exit_code, 0) << got.out << got.err;
  EXPECT_EQ(host.registered(), 5U);  // cafe1-2 is in the same archive
  EXPECT_EQ(host.requests(), 4);
}

TEST(DataGet, OfTwoProcessesDownloadsOnce) {
  const DatasetHost host;
  offer_mini(host, 2'000'000);
  ProgramResult first;
  std::thread other([&] { first = host.get({"mini/a"}); });
  const ProgramResult second = host.get({"mini/a"});
  other.join();
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(host.requests(), 1);
  EXPECT_EQ(host.registered(), 1U);
}

TEST(DataGet, ContinuesAfterAnInterrupt) {
  const DatasetHost host([](const ServedRequest& request, ServedResponse response) {
    if (request.number == 1) response.pause_ms = 1;
    return response;
  });
  offer_mini(host, 3'000'000);
  const ProgramResult interrupted = host.get({"mini/a"}, {.interrupt_after = "downloading"});
  EXPECT_EQ(interrupted.exit_code, 130) << interrupted.err;
  EXPECT_EQ(host.registered(), 0U);
  EXPECT_FALSE(fs::exists(host.data() / "mini/a"));
  EXPECT_EQ(host.get({"mini/a"}).exit_code, 0);
  EXPECT_EQ(host.registered(), 1U);
}

TEST(DataGet, RegistersNothingOfADefectiveArchive) {
  const DatasetHost host;
  host.offer("mini/a.tgz", {{"b/readme", "another folder"}, {"c/readme", "and another"}});
  host.offer("mini/evil.tgz", {{"../outside", "x"}});
  host.add_dataset("mini", "[[sequences]]\nfiles = [\"{}.tgz\"]\nmembers = [\"a\", \"evil\", \"missing\"]\n");
  for (const auto& [name, message] : std::vector<std::pair<std::string, std::string>>{
           {"a", ""}, {"evil", "outside of the archive"}, {"missing", "HTTP status 404"}}) {
    const ProgramResult got = host.get({"mini/" + name});
    EXPECT_EQ(got.exit_code, 2) << name;
    EXPECT_NE(got.err.find(message), std::string::npos) << got.err;
    EXPECT_EQ(host.registered(), 0U);
    EXPECT_FALSE(fs::exists(host.data() / "mini" / name));
  }
  EXPECT_FALSE(fs::exists(host.data() / "mini/outside"));
}

TEST(DataGet, RequiresTheDigestOfTheFirstUse) {
  const DatasetHost host;
  offer_mini(host);
  ASSERT_EQ(host.get({"mini/a"}).exit_code, 0);
  fs::remove(host.path() / "registry.json");
  fs::remove_all(host.data() / "mini/a");
  offer_mini(host, 10);  // the host changes the file
  const ProgramResult got = host.get({"mini/a"});
  EXPECT_EQ(got.exit_code, 2);
  EXPECT_NE(got.err.find("SHA-256"), std::string::npos) << got.err;
  EXPECT_EQ(host.registered(), 0U);
}

TEST(DataGet, RequiresNoDigestOfADamagedFile) {
  const DatasetHost host;
  offer_mini(host);
  const fs::path file = host.path() / "host/mini/a.tgz";
  const auto size = fs::file_size(file);
  fs::resize_file(file, size / 2);  // a server that closes the connection early, without the size
  const ProgramResult damaged = host.get({"mini/a"});
  EXPECT_EQ(damaged.exit_code, 2);
  EXPECT_NE(damaged.err.find("remove it, and download it again"), std::string::npos) << damaged.err;
  EXPECT_EQ(damaged.err.find("required from now on"), std::string::npos) << damaged.err;
  fs::remove(host.data() / "mini/downloads/a.tgz");
  offer_mini(host);
  EXPECT_EQ(host.get({"mini/a"}).exit_code, 0);
  EXPECT_EQ(host.registered(), 1U);
}

TEST(DataGet, UsesAMirrorFirst) {
  const DatasetHost host;
  offer_mini(host);
  host.add_dataset(
      "mini", std::string(kOneSequence) + "[archives.\"a.tgz\"]\nurls = [\"" + host.url("/gone") + "\"]\n");
  EXPECT_EQ(host.get({"mini/a"}).exit_code, 2);
  EXPECT_EQ(host.get({"mini/a", "--mirror", host.url("")}).exit_code, 0);
}

TEST(DataGet, FetchesWhatAPlanLacks) {
  const DatasetHost host;
  offer_mini(host);
  std::ofstream(host.path() / "plan.toml")
      << "variants = [\"vo\"]\n[recorded]\nsequences = [\"mini/a\"]\nrequired = false\n";
  const std::string plan = (host.path() / "plan.toml").string();
  const ProgramResult before = host.run({"bench", plan, "--store", (host.path() / "s.sqlite").string()});
  EXPECT_NE((before.out + before.err).find("data get mini/a"), std::string::npos) << before.out << before.err;
  EXPECT_EQ(host.get({"--for", plan}).exit_code, 0);
  EXPECT_EQ(host.run({"plan", "show", plan}).out.find("not available"), std::string::npos);
}

TEST(DataGet, RecordsBoxesOfTheNetworkOfTheCatalogue) {
  const auto detectors = find_test_data("detectors");
  if (!detectors) GTEST_SKIP() << missing_test_data("detectors");
  const DatasetHost host;
  offer_mini(host);
  const fs::path network = host.path() / "host/yolo_fastest";
  fs::create_directories(network);
  for (const char* name : {"yolo-fastest-1.1.weights", "yolo-fastest-1.1.cfg", "coco.names"})
    fs::copy_file(*detectors / ("yolo-fastest-1.1_coco__" + std::string(name)), network / name);
  const ProgramResult got = host.get({"mini/a", "--boxes", "--mirror", host.url("")});
  ASSERT_EQ(got.exit_code, 0) << got.err;
  EXPECT_TRUE(fs::exists(host.data() / "mini/a/detections.txt"));
  EXPECT_EQ(host.run({"data", "verify"}).exit_code, 0);
}

TEST(DataGet, ContinuesAfterAFullDisk) {
  if (geteuid() != 0) GTEST_SKIP() << "mounting a small file system requires root";
  const DatasetHost host;
  offer_mini(host, 6'000'000);
  const fs::path disk = host.path() / "disk";
  fs::create_directory(disk);
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=4m") != 0) GTEST_SKIP() << "tmpfs cannot be mounted";
  const ProgramResult full = host.get({"mini/a", "--to", disk.string()});
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_NE(full.err.find("free disk space"), std::string::npos) << full.err;
  EXPECT_EQ(host.registered(), 0U);
  mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT, "size=200m");
  EXPECT_EQ(host.get({"mini/a", "--to", disk.string()}).exit_code, 0);
  EXPECT_EQ(host.registered(), 1U);
  umount(disk.c_str());
}

}  // namespace
}  // namespace stillpoint
