#pragma once

#include <chrono>
#include <cstdint>

#include <armature/navproto/vocabulary.h>

namespace armature::navproto {

/// What every message begins with. Filled in by the publisher when it sends.
struct Header {
  std::uint64_t session_id = 0;      ///< drawn anew each time a publisher starts
  std::uint64_t sequence = 0;        ///< counts up by one a message of this topic, from 1
  std::chrono::nanoseconds sent{0};  ///< when this copy was sent, by the publisher's monotonic clock
  bool replayed = false;             ///< the last state, sent again because somebody has just subscribed

  friend bool operator==(const Header&, const Header&) = default;
};

/// When the frame behind a message was measured, received and done with.
struct FrameTimes {
  std::uint64_t frame = 0;                                ///< the sensor's sequence number
  std::chrono::nanoseconds sensor{0};                     ///< by sensor_clock
  SensorClock sensor_clock = SensorClock::HostMonotonic;  ///< whose clock `sensor` is
  std::chrono::nanoseconds received{0};                   ///< by the publisher's monotonic clock, as is published
  std::chrono::nanoseconds published{0};                  ///< filled in by the publisher

  friend bool operator==(const FrameTimes&, const FrameTimes&) = default;
};

}  // namespace armature::navproto
