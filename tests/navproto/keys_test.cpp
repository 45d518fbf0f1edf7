#include <fstream>

#include <armature/navproto/feed.h>
#include <armature/navproto/keys.h>
#include <armature/navproto/publisher.h>
#include <armature/navproto/subscriber.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/navproto/sample_messages.h"
#include "tests/navproto/transport_fixture.h"
#include "tests/support/temporary_directory.h"

namespace armature::navproto {
namespace {

using namespace std::chrono_literals;

KeyPair new_keys() {
  auto keys = make_key_pair();
  EXPECT_TRUE(keys);
  return keys.value_or(KeyPair{});
}

TEST(Keys, AreReadAsTheyWereWrittenAndOnlyTheirOwnerMayRead) {
  const test::TemporaryDirectory directory;
  const auto file = directory.path() / "kiosk.key";
  const KeyPair keys = new_keys();
  ASSERT_TRUE(write_key_pair(file, keys));
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  const auto read = read_key_pair(file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->public_key, keys.public_key);
  EXPECT_EQ(read->secret_key, keys.secret_key);
  EXPECT_FALSE(write_key_pair(file, keys)) << "an identity is never replaced";
}

TEST(Keys, ThatDoNotBelongTogetherAreRefused) {
  const test::TemporaryDirectory directory;
  const auto file = directory.path() / "kiosk.key";
  ASSERT_TRUE(write_key_pair(file, {new_keys().public_key, new_keys().secret_key}));
  EXPECT_FALSE(read_key_pair(file));
}

TEST(AllowList, HoldsKeysNamesAndComments) {
  const std::string a = new_keys().public_key, b = new_keys().public_key;
  const auto list = parse_allow_list("# who may listen\n\n" + a + " the wall\n  " + b + "\tdesk  \n", "allow");
  ASSERT_TRUE(list) << list.error().message;
  EXPECT_EQ(*list, (std::vector<AllowedKey>{{a, "the wall"}, {b, "desk"}}));
}

TEST(AllowList, NamesTheLineThatIsWrong) {
  const auto list = parse_allow_list("# comment\nnonsense wall\n", "allow");
  ASSERT_FALSE(list);
  EXPECT_EQ(list.error().message.find("allow:2:"), 0U) << list.error().message;
  const std::string key = new_keys().public_key;
  EXPECT_FALSE(parse_allow_list(key + " a\n" + key + " b\n", "allow"));
}

TEST(AllowList, GrowsByALine) {
  const test::TemporaryDirectory directory;
  const auto file = directory.path() / "allow";
  const AllowedKey wall{new_keys().public_key, "wall"};
  ASSERT_TRUE(allow_key(file, wall));
  EXPECT_FALSE(allow_key(file, wall));
  ASSERT_TRUE(allow_key(file, {new_keys().public_key, "desk"}));
  EXPECT_EQ(read_allow_list(file)->size(), 2U);
}

TEST(AllowList, GrowsByALineThoughTheLastOneHasNoEnd) {
  const test::TemporaryDirectory directory;
  const auto file = directory.path() / "allow";
  std::ofstream(file) << new_keys().public_key << " wall";
  ASSERT_TRUE(allow_key(file, {new_keys().public_key, "desk"}));
  const auto list = read_allow_list(file);
  ASSERT_TRUE(list) << list.error().message;
  ASSERT_EQ(list->size(), 2U);
  EXPECT_EQ(list->front().name, "wall");
}

TEST(Keys, AreNeverTakenForAnOptionOrAComment) {
  for (int i = 0; i < 300; ++i) {
    const char first = new_keys().public_key.front();
    EXPECT_TRUE(first != '-' && first != '#');
  }
}

TEST(Keys, ThatThisUserMayNotReadSayHowHeMay) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file to somebody else";
  const test::TemporaryDirectory directory;
  std::filesystem::permissions(directory.path(), std::filesystem::perms(0755));
  const auto file = directory.path() / "kiosk.key";
  ASSERT_TRUE(write_key_pair(file, new_keys()));
  // access() asks for the real user.
  ASSERT_EQ(::setresuid(65534, 65534, 0), 0);
  const auto read = read_key_pair(file);
  ASSERT_EQ(::setresuid(0, 0, 0), 0);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("systemd-tmpfiles --create armature.conf"), std::string::npos)
      << read.error().message;
}

TEST(Curve, LetsInWhoIsListedAndSendsStrangersAway) {
  const KeyPair server = new_keys(), friend_keys = new_keys(), stranger_keys = new_keys();
  PublisherOptions options;
  options.curve = CurveServer{server, {{friend_keys.public_key, "friend"}}};
  auto bound = publisher_over_tcp(options);
  if (!bound) GTEST_SKIP() << "no free TCP ports";
  auto& [endpoint, publisher] = *bound;

  SubscriberOptions as_friend, as_stranger;
  as_friend.curve = CurveClient{server.public_key, friend_keys};
  as_stranger.curve = CurveClient{server.public_key, stranger_keys};
  NavSubscriber known(endpoint, as_friend), unknown(endpoint, as_stranger), naked(endpoint);
  NavigationMessage message = sample::navigation();
  const auto give_up = std::chrono::steady_clock::now() + 10s;
  while (std::chrono::steady_clock::now() < give_up && (!known.navigation() || publisher.counters().strangers == 0)) {
    publisher.publish_navigation(message);
    (void)known.wait(10ms);
  }
  EXPECT_TRUE(known.navigation());
  EXPECT_GE(publisher.counters().strangers, 1U);
  EXPECT_FALSE(unknown.navigation());
  EXPECT_FALSE(naked.navigation());
}

TEST(Ipc, SocketsAreForTheirOwnerAndGroup) {
  const test::TemporaryDirectory directory;
  const auto path = directory.path() / "nav";
  const auto publisher = Publisher::bind("ipc://" + path.string());
  ASSERT_TRUE(publisher);
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0660U);
}

}  // namespace
}  // namespace armature::navproto
