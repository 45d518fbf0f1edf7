#include "firmware_host/backends/light_thread.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace armature {
namespace {

using namespace std::chrono_literals;
using enum StatusLight;

/// A lamp that answers when it is told to, with what it is told.
class Lamp {
 public:
  bool operator()(StatusLight light) {
    std::unique_lock lock(mutex_);
    asked_.push_back(light);
    changed_.notify_all();
    changed_.wait(lock, [this] { return answers_ > 0; });
    --answers_;
    return works_;
  }
  /// To the next requests.
  void answer(int times, bool works) {
    const std::lock_guard lock(mutex_);
    answers_ += times;
    works_ = works;
    changed_.notify_all();
  }
  /// Once there were so many requests.
  std::vector<StatusLight> asked(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return asked_.size() >= count; });
    return asked_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<StatusLight> asked_;
  int answers_ = 0;
  bool works_ = true;
};

class SharedClock final : public Clock {
 public:
  [[nodiscard]] std::chrono::nanoseconds now() const noexcept override { return now_.load(); }
  void sleep_until(std::chrono::nanoseconds) override {}
  void advance(std::chrono::nanoseconds by) { now_ = now_.load() + by; }

 private:
  std::atomic<std::chrono::nanoseconds> now_{0ns};
};

class LightThreadTest : public testing::Test {
 protected:
  /// Until something is tried again. It may only be about to begin its rest, so that one minute would not do.
  void rest() {
    for (const std::size_t before = lamp_.asked(0).size(); lamp_.asked(0).size() == before;) {
      clock_->advance(LightThread::kRest);
      std::this_thread::sleep_for(1ms);
    }
  }
  Lamp lamp_;
  std::shared_ptr<SharedClock> clock_ = std::make_shared<SharedClock>();
  std::optional<LightThread> light_{std::in_place, std::ref(lamp_), clock_};
};

TEST_F(LightThreadTest, NobodyWaitsForALampThatDoesNotAnswerAndTheNewestWins) {
  light_->show(Ready);
  EXPECT_EQ(lamp_.asked(1), std::vector{Ready});
  for (const StatusLight light : {Calibrating, Trouble, Engaged}) light_->show(light);
  lamp_.answer(2, true);
  EXPECT_EQ(lamp_.asked(2), (std::vector{Ready, Engaged}));
}

TEST_F(LightThreadTest, WhatWasAskedForLastIsShownBeforeItGoes) {
  lamp_.answer(2, true);
  light_->show(Ready);
  (void)lamp_.asked(1);
  light_->show(Off);
  light_.reset();
  EXPECT_EQ(lamp_.asked(2), (std::vector{Ready, Off}));
}

TEST_F(LightThreadTest, AfterAFailureNothingIsTriedForAMinuteThenTheNewest) {
  lamp_.answer(1, false);
  light_->show(Ready);
  (void)lamp_.asked(1);
  light_->show(Trouble);
  light_->show(Calibrating);
  lamp_.answer(1, true);
  rest();
  EXPECT_EQ(lamp_.asked(2), (std::vector{Ready, Calibrating}));
}

TEST_F(LightThreadTest, WhatFailedIsTriedAgainByItself) {
  lamp_.answer(1, false);
  light_->show(Engaged);
  (void)lamp_.asked(1);
  lamp_.answer(1, true);
  rest();
  EXPECT_EQ(lamp_.asked(2), (std::vector{Engaged, Engaged}));
}

TEST_F(LightThreadTest, ItGoesWithoutTryingWhatJustFailed) {
  lamp_.answer(1, false);
  light_->show(Ready);
  (void)lamp_.asked(1);
  light_->show(Off);
  light_.reset();
  EXPECT_EQ(lamp_.asked(1), std::vector{Ready});
}

}  // namespace
}  // namespace armature
