#include "firmware_host/capture/capture_process.h"

#include <csignal>
#include <cstring>
#include <filesystem>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "firmware_host/capture/recovery.h"
#include "firmware_host/capture/shared_frames.h"
#include "firmware_host/recording/recorder.h"
#include "tests/support/temporary_directory.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

DepthFrame frame_of(std::uint16_t depth_mm, std::uint64_t sequence, int width = 64, int height = 48) {
  DepthFrame frame;
  frame.depth_mm.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), depth_mm);
  frame.intrinsics = {width, height, 60, 60, 32, 24};
  frame.sequence = sequence;
  frame.sensor = {std::chrono::milliseconds(33 * sequence), ClockId::Device};
  return frame;
}

TEST(SharedFrames, HandOverTheNewestFrameOnceAndBitForBit) {
  auto writer = SharedFrames::create();
  ASSERT_TRUE(writer);
  auto reader = SharedFrames::attach(::dup(writer->descriptor()));
  ASSERT_TRUE(reader) << reader.error().message;
  DepthFrame frame;
  EXPECT_EQ(reader->read(frame), SharedFrames::Read::Nothing);
  for (std::uint64_t n = 1; n <= 5; ++n) ASSERT_TRUE(writer->write(frame_of(static_cast<std::uint16_t>(n), n), 30));
  ASSERT_EQ(reader->read(frame), SharedFrames::Read::Frame);
  EXPECT_EQ(frame.depth_mm, frame_of(5, 5).depth_mm);
  EXPECT_EQ(frame.intrinsics, frame_of(5, 5).intrinsics);
  EXPECT_EQ(frame.sensor, frame_of(5, 5).sensor);
  EXPECT_EQ(reader->read(frame), SharedFrames::Read::Nothing);
}

TEST(SharedFrames, AFrameThatContradictsItselfIsNotWritten) {
  auto frames = SharedFrames::create();
  ASSERT_TRUE(frames);
  DepthFrame lies = frame_of(1, 1);
  lies.depth_mm.pop_back();
  EXPECT_FALSE(frames->write(lies, 30));
  EXPECT_FALSE(frames->write(frame_of(1, 1, 4096, 4096), 30)) << "too large";
}

TEST(SharedFrames, LeaveNoDescriptorBehindWhereTheyFail) {
  const auto open_descriptors = [] {
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return std::distance(begin(all), end(all));
  };
  const test::TemporaryDirectory directory;
  const auto before = open_descriptors();
  for (int i = 0; i < 5; ++i) {
    const int other = ::open(directory.path().c_str(), O_RDONLY | O_DIRECTORY);
    EXPECT_FALSE(SharedFrames::attach(other));
  }
  EXPECT_EQ(open_descriptors(), before);
}

TEST(SharedFrames, NothingElseIsTakenForThem) {
  const test::TemporaryDirectory directory;
  std::FILE* file = std::fopen((directory.path() / "x").c_str(), "w+");
  EXPECT_FALSE(SharedFrames::attach(::dup(::fileno(file))));
  std::fclose(file);
  EXPECT_FALSE(SharedFrames::attach(-1));
}

TEST(Recovery, GoesFromGentleToHardAndNeverGivesUp) {
  using enum Recovery::Step;
  Recovery recovery;
  std::chrono::nanoseconds now = 1s;
  EXPECT_EQ(recovery.step(now, Reader::Gone), RestartProcess);
  recovery.process_started(now);
  recovery.frame(now);
  std::vector<Recovery::Step> steps;
  int starts = 0;
  auto last_start = now, longest_pause = 0ns;
  for (; now < 601s; now += 10ms) {
    const auto step = recovery.step(now, Reader::Streaming);
    if (step == None) continue;
    steps.push_back(step);
    if (step == RestartProcess) {
      recovery.process_started(now);
      ++starts;
      longest_pause = std::max(longest_pause, now - last_start);
      last_start = now;
    }
  }
  EXPECT_EQ((std::vector(steps.begin(), steps.begin() + 4)),
            (std::vector{RestartStream, ResetDevice, Reopen, RestartProcess}));
  EXPECT_GT(std::ranges::count(steps, ResetDevice), 10) << "again and again, not once";
  EXPECT_GT(starts, 100);
  EXPECT_LE(longest_pause, 5s);
}

TEST(Recovery, StartsAProcessThatDiesAgainAfterAPauseThatDoubles) {
  using enum Recovery::Step;
  Recovery recovery;
  std::chrono::nanoseconds now = 1s;
  std::vector<std::chrono::nanoseconds> starts;
  bool running = false;
  for (; now < 60s; now += 10ms) {
    if (recovery.step(now, running ? Reader::Streaming : Reader::Gone) == RestartProcess) {
      starts.push_back(now);
      recovery.process_started(now);
      recovery.process_ended(now);
    }
  }
  ASSERT_GT(starts.size(), 10U);
  EXPECT_LE(starts[1] - starts[0], 250ms);
  for (std::size_t i = 1; i < starts.size(); ++i) EXPECT_LE(starts[i] - starts[i - 1], 2100ms);
  EXPECT_GE(starts.back() - starts[starts.size() - 2], 1900ms);
}

TEST(Recovery, LeavesAProcessAloneThatOpensADevice) {
  Recovery recovery;
  recovery.process_started(0s);
  for (auto now = 0s; now < 3600s; ++now) EXPECT_EQ(recovery.step(now, Reader::Opening), Recovery::Step::None);
}

TEST(Recovery, StartsAProcessAgainWhoseDeviceNeverOpensAfterAPauseThatGrows) {
  using enum Recovery::Step;
  Recovery recovery;
  recovery.process_started(0s);
  std::vector<std::chrono::seconds> restarts;
  for (auto now = 0s; now < 300s; ++now) {
    const auto step = recovery.step(now, now.count() % 3 == 0 ? Reader::Opening : Reader::Waiting);
    if (step == None) continue;
    EXPECT_EQ(step, RestartProcess);
    restarts.push_back(now);
    recovery.process_started(now);
  }
  ASSERT_GE(restarts.size(), 5U);
  const std::vector<double> pauses = {10, 20, 40, 60, 60};
  for (std::size_t i = 0; i < pauses.size(); ++i) {
    const auto before = i == 0 ? 0s : restarts[i - 1];
    EXPECT_NEAR(static_cast<double>((restarts[i] - before).count()), pauses[i], 1.0) << i;
  }
}

/// What a device library does whose device is pulled out.
enum class Library : std::uint8_t {
  Notices,
  WaitsForFrames,  ///< that never come, once it is open
  Hangs,           ///< in the call that it is in
  HangsTwice,      ///< and in the first call that opens the device once it is back
};

/// From replug to frames: a process that reads a device whose plug is pulled `at` after its start and put back `away`
/// later, with a library as slow as a Kinect's: 1.2 s to open, looked for every 300 ms.
std::chrono::nanoseconds replug_to_frames(Library library, std::chrono::nanoseconds at, std::chrono::nanoseconds away) {
  Recovery recovery;
  recovery.process_started(0s);
  Reader reader = Reader::Opening;
  std::chrono::nanoseconds began = 0s, heard = 0s;
  const bool hangs = library == Library::Hangs || library == Library::HangsTwice;
  bool stuck = false, stumbled = library != Library::HangsTwice;
  for (std::chrono::nanoseconds now = 0s; now < at + away + 100s; now += 10ms) {
    const bool there = now < at || now >= at + away;
    switch (reader) {
      case Reader::Opening:
        if (stuck) break;
        if (!there && (!hangs || now == began))
          reader = Reader::Waiting, began = now;
        else if (!there)
          stuck = true;
        else if (now >= at + away && !stumbled)
          stuck = stumbled = true;
        else if (now - began >= 1200ms)
          reader = Reader::Streaming;
        break;
      case Reader::Waiting:
        if (now - began >= 300ms) reader = Reader::Opening, began = now + 10ms;
        break;
      case Reader::Streaming:
        if (!there && library == Library::Notices)
          reader = Reader::Waiting, began = now;
        else if (!there)
          stuck = true;
        else if (!stuck) {
          recovery.frame(now);
          if (now >= at + away) return now - at - away;
        }
        break;
      case Reader::Gone: break;
    }
    if (reader == Reader::Opening)
      heard = began;
    else if (!stuck || library == Library::WaitsForFrames)
      heard = now;
    if (reader != Reader::Gone && recovery.hangs(now - heard, reader)) {
      recovery.process_ended(now, reader);
      reader = Reader::Gone;
    }
    if (recovery.step(now, reader) == Recovery::Step::RestartProcess) {
      recovery.process_started(now);
      reader = Reader::Opening, began = now + 10ms, stuck = false;
    }
  }
  return 1h;
}

/// The contract, whenever the plug was pulled and put back, whatever the process was in the midst of.
TEST(Recovery, BringsFramesBackWithinFiveSecondsOfAReplug) {
  for (const Library library : {Library::Notices, Library::WaitsForFrames, Library::Hangs}) {
    for (std::chrono::nanoseconds at = 10ms; at < 2s; at += 50ms) {
      for (std::chrono::nanoseconds away = 10ms; away < 75s; away = away * 5 / 4 / 10ms * 10ms + 10ms) {
        EXPECT_LE(replug_to_frames(library, at, away), 5s)
            << static_cast<int>(library) << ": pulled after " << at / 1ms << " ms, away for " << away / 1ms << " ms";
      }
    }
  }
}

/// A read that hangs is given 2 s, an open 3 s; a device opens in 1.2 s, and there are pauses between.
TEST(Recovery, GivesAnOpenThatHangsAfterAReadDidItsThreeSeconds) {
  for (std::chrono::nanoseconds at = 1500ms; at < 2s; at += 50ms) {
    for (std::chrono::nanoseconds away = 10ms; away < 20s; away = away * 5 / 4 / 10ms * 10ms + 10ms) {
      EXPECT_LE(replug_to_frames(Library::HangsTwice, at, away), away < 2s ? 2s + 3s + 1200ms + 400ms : 5s)
          << "pulled after " << at / 1ms << " ms, away for " << away / 1ms << " ms";
    }
  }
}

TEST(Recovery, BearsWithALibraryThatTakesLongToOpenOnceItWasKilledForIt) {
  Recovery recovery;
  recovery.process_started(0s);
  EXPECT_FALSE(recovery.hangs(2900ms, Reader::Opening));
  std::vector<std::chrono::seconds> patience;
  for (int start = 0; start < 4; ++start) {
    auto seconds = 1s;
    while (!recovery.hangs(seconds, Reader::Opening)) ++seconds;
    patience.push_back(seconds - 1s);
    recovery.process_ended(0s, Reader::Opening);
    recovery.process_started(0s);
  }
  EXPECT_EQ(patience, (std::vector{3s, 6s, 12s, 12s}));
  recovery.frame(0s);
  EXPECT_TRUE(recovery.hangs(3100ms, Reader::Opening));
}

/// A Kinect's dump of so many frames at 30 Hz.
class CaptureProcessTest : public testing::Test {
 protected:
  std::string dump(int frames) {
    std::string index;
    for (int i = 0; i < frames; ++i) {
      char name[64];
      std::snprintf(name, sizeof name, "d-%.6f-%u.pgm", 1000 + i / 30.0, 2'000'000U * static_cast<unsigned>(i));
      index += std::string(name) + "\n";
      std::FILE* file = std::fopen((directory_.path() / name).c_str(), "wb");
      std::fputs("P5 640 480 65535\n", file);
      const std::vector<std::uint16_t> pixels(640 * 480, static_cast<std::uint16_t>(2500 + i));
      std::fwrite(pixels.data(), 2, pixels.size(), file);
      std::fclose(file);
    }
    std::FILE* file = std::fopen((directory_.path() / "INDEX.txt").c_str(), "w");
    std::fputs(index.c_str(), file);
    std::fclose(file);
    return "process:fakenect:" + directory_.path().string();
  }
  Expected<std::unique_ptr<CaptureProcess>> open(const std::string& uri) {
    return CaptureProcess::open(uri.substr(8), {.wait_for_device = 10s});
  }
  /// Reads until a frame comes, for at most ten seconds.
  static bool frame_comes(DepthSource& source) {
    DepthFrame frame;
    for (int i = 0; i < 100; ++i) {
      const auto status = source.read(frame, 100ms);
      if (status && *status == ReadStatus::Frame) return true;
    }
    return false;
  }
  static std::string descriptor_of(pid_t process, int number) {
    return "/proc/" + std::to_string(process) + "/fd/" + std::to_string(number);
  }
  test::TemporaryDirectory directory_;
};

TEST_F(CaptureProcessTest, PassesFramesAndTheEndOn) {
  auto source = open(dump(20));
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_TRUE((*source)->info().live);
  EXPECT_EQ((*source)->info().intrinsics.width, 640);
  DepthFrame frame;
  ReadStatus last = ReadStatus::Timeout;
  for (int i = 0; i < 200 && last != ReadStatus::EndOfStream; ++i) {
    const auto status = (*source)->read(frame, 100ms);
    ASSERT_TRUE(status);
    last = *status;
  }
  EXPECT_EQ(last, ReadStatus::EndOfStream);
  EXPECT_EQ(frame.depth_mm.front(), 2519);
}

TEST_F(CaptureProcessTest, BringsAKilledProcessBack) {
  auto source = open(dump(300));
  ASSERT_TRUE(source) << source.error().message;
  for (int times = 1; times <= 3; ++times) {
    ASSERT_TRUE(frame_comes(**source));
    const pid_t victim = (*source)->process();
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    constexpr int kCrash = SIGABRT;  // they would catch the other
#else
    constexpr int kCrash = SIGSEGV;
#endif
    ::kill(victim, times == 2 ? kCrash : SIGKILL);
    DepthFrame frame;
    std::string trouble;
    for (int i = 0; i < 100 && trouble.empty(); ++i) {
      (void)(*source)->read(frame, 10ms);
      trouble = (*source)->health().trouble;
    }
    EXPECT_NE(trouble.find("the capture process died"), std::string::npos) << trouble;
    EXPECT_TRUE(frame_comes(**source));
    EXPECT_NE((*source)->process(), victim);
    EXPECT_EQ((*source)->health().restarts, static_cast<std::uint64_t>(times));
    EXPECT_EQ((*source)->health().trouble, "");
  }
}

TEST_F(CaptureProcessTest, StartsAProcessThatHangsAgain) {
  auto source = open(dump(600));
  ASSERT_TRUE(source) << source.error().message;
  ::kill((*source)->process(), SIGSTOP);
  DepthFrame frame;
  while ((*source)->read(frame, 0ms).value_or(ReadStatus::Timeout) == ReadStatus::Frame) {
  }
  EXPECT_TRUE(frame_comes(**source));
  EXPECT_EQ((*source)->health().restarts, 1U);
}

TEST_F(CaptureProcessTest, StartsAProcessThatHangsAgainWhateverTimeItWrites) {
  auto source = open(dump(600));
  ASSERT_TRUE(source) << source.error().message;
  const pid_t victim = (*source)->process();
  auto garbage = SharedFrames::attach(::open(descriptor_of(victim, kFramesDescriptor).c_str(), O_RDWR | O_CLOEXEC));
  ASSERT_TRUE(garbage) << garbage.error().message;
  ::kill(victim, SIGSTOP);
  garbage->alive(std::chrono::nanoseconds::max());
  garbage->set_state(CaptureState::Opening, "");  // so that nobody waits for frames
  DepthFrame frame;
  while ((*source)->read(frame, 0ms).value_or(ReadStatus::Timeout) == ReadStatus::Frame) {
  }
  EXPECT_TRUE(frame_comes(**source));
  EXPECT_EQ((*source)->health().restarts, 1U);
}

TEST_F(CaptureProcessTest, BringsAKilledProcessBackWhereSigchldIsIgnored) {
  const auto before = ::signal(SIGCHLD, SIG_IGN);
  auto source = open(dump(300));
  ASSERT_TRUE(source) << source.error().message;
  ::kill((*source)->process(), SIGKILL);
  DepthFrame frame;
  std::string trouble;
  for (int i = 0; i < 1000 && trouble.empty(); ++i) {
    (void)(*source)->read(frame, 10ms);
    trouble = (*source)->health().trouble;
  }
  EXPECT_NE(trouble.find("the capture process ended"), std::string::npos) << trouble;
  EXPECT_TRUE(frame_comes(**source));
  EXPECT_EQ((*source)->health().restarts, 1U);
  source->reset();
  ::signal(SIGCHLD, before);
}

TEST_F(CaptureProcessTest, NeedsNoHighDescriptors) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit few{256, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
  const auto source = open(dump(20));
  EXPECT_TRUE(source) << source.error().message;
  ::setrlimit(RLIMIT_NOFILE, &before);
}

TEST_F(CaptureProcessTest, SaysWhyItCannotBeStarted) {
  auto source = CaptureProcess::open(dump(20).substr(8), {.wait_for_device = 0ms});
  ASSERT_TRUE(source) << source.error().message;
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{1, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  DepthFrame frame;
  EXPECT_EQ((*source)->read(frame, 0ms).value(), ReadStatus::Timeout);
  ::setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_NE((*source)->health().trouble.find("cannot be started: "), std::string::npos) << (*source)->health().trouble;
  EXPECT_TRUE(frame_comes(**source));
}

/// Its parent may have gone before it could ask to be told.
TEST_F(CaptureProcessTest, GoesWhereItsParentIsNotWhoStartedIt) {
  auto frames = SharedFrames::create();
  ASSERT_TRUE(frames);
  const std::string program =
      (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "../lib/armature/armature-capture").string();
  const std::string uri = dump(20).substr(8), gone = std::to_string(::getppid());
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(frames->descriptor(), kFramesDescriptor);
    ::fcntl(kFramesDescriptor, F_SETFD, 0);
    ::execl(program.c_str(), program.c_str(), gone.c_str(), uri.c_str(), nullptr);
    ::_exit(99);
  }
  const int over = static_cast<int>(::syscall(SYS_pidfd_open, child, 0));
  pollfd event{over, POLLIN, 0};
  EXPECT_EQ(::poll(&event, 1, 30'000), 1) << "it stays";
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  DepthFrame frame;
  EXPECT_EQ(frames->read(frame), SharedFrames::Read::Nothing);
  ::close(over);
}

TEST_F(CaptureProcessTest, SaysThatAnImageIsTooLarge) {
  const auto path = directory_.path() / "large.oni";
  DepthFrame large = frame_of(2000, 1, 1920, 1080);
  auto recorder = Recorder::create(path, {.intrinsics = large.intrinsics, .frames_per_second = 30, .origin = ""});
  ASSERT_TRUE(recorder) << recorder.error().message;
  for (large.sequence = 1; large.sequence < 4; ++large.sequence, large.sensor.time += 33ms)
    ASSERT_TRUE(recorder->append(large.view()));
  ASSERT_TRUE(recorder->finish());
  auto source = CaptureProcess::open("oni:" + path.string(), {.wait_for_device = 0ms});
  ASSERT_TRUE(source) << source.error().message;
  DepthFrame frame;
  for (int i = 0; i < 200 && (*source)->health().trouble.find("1920 x 1080") == std::string::npos; ++i) {
    EXPECT_NE((*source)->read(frame, 50ms).value(), ReadStatus::Frame);
  }
  EXPECT_NE((*source)->health().trouble.find("an image of 1920 x 1080"), std::string::npos)
      << (*source)->health().trouble;
  EXPECT_EQ((*source)->health().restarts, 0U);
}

TEST_F(CaptureProcessTest, TakesFramesThatAreNoGoodForSilence) {
  const auto clock = std::make_shared<ManualClock>();
  auto source = CaptureProcess::open(dump(900).substr(8), {.clock = clock, .wait_for_device = 10s});
  ASSERT_TRUE(source) << source.error().message;
  const auto process = (*source)->process();
  const auto restarts = [&] { return (*source)->health().restarts; };
  // The next frame, said to come 250 ms after the last one.
  const auto one_more = [&](bool good) {
    DepthFrame frame;
    for (int i = 0; i < 10'000; ++i) {
      const auto status = (*source)->read(frame, 0ms);
      EXPECT_EQ((*source)->health().trouble, "") << "frames come";
      if (status && *status == ReadStatus::Frame) {
        (*source)->judge(good);
        clock->advance(250ms);
        return true;
      }
      std::this_thread::sleep_for(1ms);
    }
    return false;
  };
  for (int n = 0; n < 20; ++n) ASSERT_TRUE(one_more(true));
  EXPECT_EQ((*source)->process(), process);
  for (int n = 0; n < 100 && restarts() == 0; ++n) ASSERT_TRUE(one_more(false));
  EXPECT_EQ(restarts(), 1U);
  EXPECT_NE((*source)->process(), process);
  for (int n = 0; n < 20; ++n) ASSERT_TRUE(one_more(true));
  EXPECT_EQ(restarts(), 1U);
}

TEST_F(CaptureProcessTest, SaysWhatIsMissingAndGoesOnLookingForIt) {
  auto source = CaptureProcess::open("fakenect:" + (directory_.path() / "later").string(), {.wait_for_device = 0ms});
  ASSERT_TRUE(source);
  DepthFrame frame;
  for (int i = 0; i < 100 && (*source)->health().trouble.find("INDEX.txt") == std::string::npos; ++i) {
    EXPECT_EQ((*source)->read(frame, 50ms).value(), ReadStatus::Timeout);
  }
  EXPECT_NE((*source)->health().trouble.find("INDEX.txt"), std::string::npos) << (*source)->health().trouble;
  dump(300);
  std::filesystem::create_directory_symlink(directory_.path(), directory_.path() / "later");
  EXPECT_TRUE(frame_comes(**source));
}

}  // namespace
}  // namespace armature
