// `armature listen` as its user meets it: the program, a real publisher, what comes out and how it exits.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <armature/navproto/publisher.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tools/json_lines.h"

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

struct Outcome {
  int exit_code = -1;
  std::string out;  ///< stdout and, where asked for, stderr
  [[nodiscard]] std::vector<Json> objects() const {
    std::vector<Json> all;
    for (std::size_t begin = 0; begin < out.size();) {
      const auto end = out.find('\n', begin);
      all.push_back(Json::parse(out.substr(begin, end - begin)));
      begin = end + 1;
    }
    return all;
  }
};

Outcome run(const std::string& arguments) {
  const std::string command = std::string(ARMATURE_BINARY_DIR) + "/bin/armature listen " + arguments;
  std::FILE* pipe = popen(command.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> bytes{};
  while (const auto count = std::fread(bytes.data(), 1, bytes.size(), pipe)) outcome.out.append(bytes.data(), count);
  const int status = pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

/// Publishes steering frames until `frames` are out, then the end of the stream until it goes away.
class Stream {
 public:
  explicit Stream(long frames)
      : folder_(std::filesystem::temp_directory_path() / ("armature-listen-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    thread_ = std::jthread([this, frames](const std::stop_token& stop) {
      auto publisher = navproto::Publisher::bind(endpoint());
      ASSERT_TRUE(publisher) << publisher.error().message;
      for (std::uint64_t i = 1; !stop.stop_requested(); ++i) {
        navproto::NavigationMessage navigation;
        navigation.times.frame = i;
        navigation.times.received = navproto::monotonic_now();
        navigation.user_id = 1;
        if (static_cast<long>(i) <= frames) {
          navigation.engagement = navproto::Engagement::Engaged;
          navigation.velocity = {0.5, 0.25};
        } else {
          navigation.stop_reason = navproto::StopReason::EndOfStream;
        }
        publisher->publish_navigation(navigation);
        navproto::SkeletonMessage skeleton;
        skeleton.times = navigation.times;
        publisher->publish_skeleton(skeleton);
        std::this_thread::sleep_for(5ms);
      }
    });
  }
  ~Stream() {
    thread_.request_stop();
    thread_.join();
    std::filesystem::remove_all(folder_);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  [[nodiscard]] std::string endpoint() const { return "ipc://" + (folder_ / "nav").string(); }
  [[nodiscard]] std::filesystem::path folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::jthread thread_;
};

constexpr long kEndless = 1'000'000;

TEST(Listen, PrintsOneJsonObjectALineAndNothingElse) {
  const Stream stream(kEndless);
  const Outcome outcome = run(stream.endpoint() + " --json --frames 5");
  EXPECT_EQ(outcome.exit_code, 0);
  int navigations = 0;
  for (const Json& object : outcome.objects()) {
    if (object["type"] == "skeleton") {
      EXPECT_EQ(object["joints"].size(), navproto::kJointCount);
    }
    if (object["type"] != "navigation") continue;
    ++navigations;
    EXPECT_EQ(object["linear_m_s"], 0.5);
    EXPECT_EQ(object["angular_rad_s"], 0.25);
    EXPECT_EQ(object["engagement"], "engaged");
    EXPECT_EQ(object["motions"].size(), navproto::kMotionCount);
  }
  EXPECT_EQ(navigations, 5);
}

TEST(Listen, EndsByItselfWhenThePublisherSaysThatTheStreamIsOver) {
  const Stream stream(60);
  const Outcome outcome = run(stream.endpoint());
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.out.rfind("stopped: end of stream\n"), std::string::npos) << outcome.out;
}

TEST(Listen, WritesThePictureAsItIsAtTheEnd) {
  const Stream stream(kEndless);
  const auto file = stream.folder() / "view.svg";
  EXPECT_EQ(run(stream.endpoint() + " --frames 20 --svg " + file.string()).exit_code, 0);
  EXPECT_GT(std::filesystem::file_size(file), 1000U);
  for (const auto& entry : std::filesystem::directory_iterator(stream.folder())) {
    EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
  }
}

TEST(Listen, FailsInOneLineWhenNothingComesInTime) {
  const Outcome outcome = run("ipc:///nonexistent/nav --json --timeout 0.2 2>&1");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.out,
            "armature: ipc:///nonexistent/nav: nothing came within 0.2 s; is armatured running with this "
            "endpoint?\n");
}

TEST(Listen, RefusesAnEndpointThatIsNone) {
  const Outcome outcome = run("carrier-pigeon 2>&1");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1) << outcome.out;
  EXPECT_NE(outcome.out.find("carrier-pigeon"), std::string::npos) << outcome.out;
}

TEST(Listen, WrongUseExitsWithTwo) {
  EXPECT_EQ(run("--frames -3 2>&1").exit_code, 2);
  EXPECT_EQ(run("--no-such-option 2>&1").exit_code, 2);
}

}  // namespace
}  // namespace armature::tools
