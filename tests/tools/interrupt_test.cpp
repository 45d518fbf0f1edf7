#include "tools/interrupt.h"

#include <condition_variable>
#include <csignal>
#include <mutex>

#include <gtest/gtest.h>

namespace armature::tools {
namespace {

void wait_for_stop(const std::stop_token& token) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  stopped.wait(lock, token, [] { return false; });
}

TEST(Interrupt, TheFirstSignalStopsTheTokenAndNotTheProgram) {
  const Interrupt interrupt;
  EXPECT_FALSE(interrupt.requested());
  std::raise(SIGINT);
  wait_for_stop(interrupt.token());
  EXPECT_TRUE(interrupt.requested());
}

TEST(Interrupt, IsReadyAgainForTheNextJob) {
  for (int job = 0; job < 2; ++job) {
    const Interrupt interrupt;
    EXPECT_FALSE(interrupt.requested());
    std::raise(SIGTERM);
    wait_for_stop(interrupt.token());
  }
}

TEST(Interrupt, TwoAtATimeStopTogetherAndTheInnerOneLeavesTheOuterInForce) {
  const Interrupt outer;
  {
    const Interrupt inner;
    EXPECT_FALSE(inner.requested());
  }
  const Interrupt other;
  std::raise(SIGINT);
  wait_for_stop(outer.token());
  wait_for_stop(other.token());
  EXPECT_TRUE(Interrupt().requested()) << "made after the signal";
}

TEST(InterruptDeathTest, ASecondSignalKills) {
  EXPECT_EXIT(
      {
        const Interrupt interrupt;
        std::raise(SIGTERM);
        std::raise(SIGTERM);
      },
      testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace armature::tools
