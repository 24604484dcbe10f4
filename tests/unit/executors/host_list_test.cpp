// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/hosts.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint::bench {
namespace {

std::vector<Host> hosts_of(const std::string& text) { return parse_hosts(text, "hosts", "/opt/stillpoint"); }

TEST(HostList, WordsAfterTheHostSetItsOptions) {
  const std::vector<Host> hosts =
      hosts_of("# machines\none\n\nme@two.example.org tasks=4 class=server program=/usr/bin/s  # large\n");
  ASSERT_EQ(hosts.size(), 2u);
  EXPECT_EQ(hosts[0].name, "one");
  EXPECT_EQ(hosts[0].program, "/opt/stillpoint");
  EXPECT_EQ(hosts[0].tasks, 1);
  EXPECT_EQ(hosts[1].name, "me@two.example.org");
  EXPECT_EQ(hosts[1].program, "/usr/bin/s");
  EXPECT_EQ(hosts[1].machine_class, "server");
  EXPECT_EQ(hosts[1].tasks, 4);
}

TEST(HostList, APackageReplacesTheProgram) {
  const std::vector<Host> hosts = parse_hosts("one package=/images/arm64.tar.zst", "hosts", "/my programs/s");
  EXPECT_EQ(hosts[0].package, "/images/arm64.tar.zst");
}

TEST(HostList, NamesThatAShellOrSshWouldInterpretAreErrors) {
  for (const char* name :
       {"-oProxyCommand=x", "a;b", "$(x)", "a@b@c", "@a", "a@", "a:22", "4/a", "..", ":", "a'b"})
    expect_input_error([&] { static_cast<void>(hosts_of(std::string("ok\n") + name)); }, {"hosts:2", "host"});
}

TEST(HostList, InvalidWordsAreErrorsWithTheirLine) {
  expect_input_error([] { static_cast<void>(hosts_of("a tasks=0")); }, {"hosts:1", "1 to 1000"});
  expect_input_error([] { static_cast<void>(hosts_of("a tasks=2x")); }, {"hosts:1", "1 to 1000"});
  expect_input_error([] { static_cast<void>(hosts_of("a program=bin/x")); }, {"hosts:1", "absolute"});
  expect_input_error([] { static_cast<void>(hosts_of("a program=/x;y")); }, {"hosts:1", "absolute"});
  expect_input_error([] { static_cast<void>(hosts_of("a package=x.deb")); }, {"hosts:1", "absolute"});
  expect_input_error([] { static_cast<void>(hosts_of("a program=/x package=/x.deb")); },
                     {"hosts:1", "exclude"});
  expect_input_error([] { static_cast<void>(hosts_of("a port=22")); }, {"hosts:1", "unknown word"});
  expect_input_error([] { static_cast<void>(hosts_of("a\na")); }, {"hosts:2", "twice"});
  expect_input_error([] { static_cast<void>(hosts_of("# none\n")); }, {"hosts", "no host"});
}

TEST(HostList, AProgramWithSpacesRequiresAPath) {
  expect_input_error([] { static_cast<void>(parse_hosts("a", "hosts", "/my programs/stillpoint")); },
                     {"hosts:1", "program=PATH"});
}

}  // namespace
}  // namespace stillpoint::bench
