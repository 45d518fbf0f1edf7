#include "navproto/src/freshness.h"

#include <gtest/gtest.h>

namespace armature::navproto {
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr nanoseconds kPeriod = milliseconds(33);
constexpr nanoseconds kOtherOrigin = hours(1000);  // how far the receiver's clock is ahead of the sender's

TEST(Freshness, AMessageThatCameAtOnceWasMadeNow) {
  Freshness freshness;
  for (int i = 0; i < 2000; ++i) {
    const nanoseconds sent = seconds(5) + i * kPeriod;
    const nanoseconds received = sent + kOtherOrigin + microseconds(100);
    EXPECT_EQ(freshness.made_at(sent, sent, received), received);
  }
}

TEST(Freshness, TimeInAQueueAndTimeBeforeAReplayCount) {
  Freshness freshness;
  const nanoseconds first = seconds(5);
  (void)freshness.made_at(first, first, first + kOtherOrigin);
  const nanoseconds published = seconds(6);
  const nanoseconds sent = published + milliseconds(40);
  const nanoseconds received = sent + milliseconds(300) + kOtherOrigin;
  EXPECT_EQ(freshness.made_at(published, sent, received), received - milliseconds(340));
}

TEST(Freshness, ABurstAfterAPauseIsSeenForWhatItIs) {
  Freshness freshness;
  nanoseconds sent = seconds(5);
  for (int i = 0; i < 300; ++i, sent += kPeriod) (void)freshness.made_at(sent, sent, sent + kOtherOrigin);
  const nanoseconds resumed = sent + seconds(10) + kOtherOrigin;
  for (int i = 0; i < 200; ++i, sent += kPeriod) {
    EXPECT_EQ(freshness.made_at(sent, sent, resumed), sent + kOtherOrigin);
  }
}

TEST(Freshness, NoBurstIsLongEnoughToTeachThatAllIsLate) {
  Freshness freshness;
  nanoseconds sent = seconds(5);
  for (int i = 0; i < 300; ++i, sent += kPeriod) (void)freshness.made_at(sent, sent, sent + kOtherOrigin);
  // 20,000 messages waited, and are read one every 20 us.
  constexpr int kWaiting = 20'000;
  nanoseconds received = sent + kWaiting * kPeriod + seconds(10) + kOtherOrigin;
  for (int i = 0; i < kWaiting; ++i, sent += kPeriod, received += microseconds(20)) {
    EXPECT_EQ(freshness.made_at(sent, sent, received), sent + kOtherOrigin);
  }
}

TEST(Freshness, ClocksThatDriftDoNotAddUp) {
  Freshness freshness;
  // The receiver's clock gains 100 us each second, for a day.
  nanoseconds worst{0};
  for (long i = 0; i < 30L * 86'400; ++i) {
    const nanoseconds sent = i * kPeriod;
    const nanoseconds received = sent + sent / 10'000 + kOtherOrigin;
    worst = std::max(worst, received - freshness.made_at(sent, sent, received));
  }
  EXPECT_LT(worst, milliseconds(2));  // what 512 messages of drift come to
}

}  // namespace
}  // namespace armature::navproto
