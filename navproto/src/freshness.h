#pragma once

#include <algorithm>
#include <chrono>
#include <limits>

namespace armature::navproto {

/// Tells how old a message is although the two ends' clocks may count from different origins: the smallest difference
/// between receiving and sending among the last 256 to 512 messages is taken for the clocks' offset, what a message
/// took longer than that for time spent in a queue. Counted in messages, so that a pause does not empty the memory;
/// bounded, so that clocks may drift.
class Freshness {
 public:
  using Time = std::chrono::nanoseconds;

  /// When, by the receiver's clock, the publisher made what it `published` (by its clock), `sent` later and was now
  /// `received`. All times are not negative.
  [[nodiscard]] Time made_at(Time published, Time sent, Time received) noexcept {
    if (++count_ > kHalfWindow) {
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
  Time previous_ = Time::max();
  Time current_ = Time::max();
  int count_ = 0;
};

}  // namespace armature::navproto
