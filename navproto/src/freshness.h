#pragma once

#include <algorithm>
#include <chrono>
#include <limits>

namespace armature::navproto {

/// Tells how old a message is although the two ends' clocks may count from different origins: the smallest difference
/// between receiving and sending among the last 256 to 512 messages is taken for the clocks' offset, what a message
/// took longer than that for time spent in a queue. Counted in messages, so that a pause does not empty the memory;
/// bounded, so that clocks may drift. Messages that come in a burst count as one: a queue that empties after the
/// receiver stood still, however long it was, does not teach that all messages are late.
class Freshness {
 public:
  using Time = std::chrono::nanoseconds;

  /// When, by the receiver's clock, the publisher made what it `published` (by its clock), `sent` later and was now
  /// `received`. All times are not negative.
  [[nodiscard]] Time made_at(Time published, Time sent, Time received) noexcept {
    if (received - counted_at_ >= kBurst) {
      counted_at_ = received;
      ++count_;
    }
    if (count_ > kHalfWindow) {
      previous_ = current_;
      current_ = Time::max();
      count_ = 1;
    }
    current_ = std::min(current_, received - sent);
    const Time offset = std::min(previous_, current_);
    return received - (received - sent - offset) - std::max(sent - published, Time::zero());
  }

 private:
  static constexpr int kHalfWindow = 256;
  static constexpr Time kBurst = std::chrono::milliseconds(10);
  Time previous_ = Time::max();
  Time current_ = Time::max();
  Time counted_at_{0};  // when the last message came that counted
  int count_ = 0;
};

}  // namespace armature::navproto
