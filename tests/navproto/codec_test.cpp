#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>

#include <armature/navproto/codec.h>
#include <gtest/gtest.h>

#include "tests/navproto/sample_messages.h"

namespace armature::navproto {
namespace {

using Bytes = std::vector<std::byte>;

template <class Message>
Bytes encoded(const Message& message) {
  Encoder encoder;
  const auto part = encoder.encode(message);
  return {part.begin(), part.end()};
}
Bytes encoded(const FeedMessage& message) {
  Encoder encoder;
  const auto part = encoder.encode(message.view());
  return {part.begin(), part.end()};
}

/// Calls `f(name, message)` with a sample of each kind.
template <class F>
void for_each_sample(F f) {
  f("navigation", sample::navigation());
  f("skeleton", sample::skeleton());
  f("event", sample::event());
  f("health", sample::health());
  f("feed", sample::feed());
  f("request", sample::request());
  f("reply", sample::reply());
}

Bytes golden(const std::string& name) {
  std::ifstream file("tests/data/navproto/" + name + ".bin", std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

TEST(Codec, WhatGoesInComesOut) {
  for_each_sample([](const char* name, const auto& message) {
    const auto decoded = decode<std::decay_t<decltype(message)>>(encoded(message));
    ASSERT_TRUE(decoded) << name << ": " << decoded.error().message;
    EXPECT_EQ(*decoded, message) << name;
  });
}

// ARMATURE_WRITE_GOLDEN=1 writes the files anew, for a new schema version.
TEST(Codec, GoldenBytesStayReadableAndAreWrittenAgain) {
  for_each_sample([](const char* name, const auto& message) {
    if (std::getenv("ARMATURE_WRITE_GOLDEN") != nullptr) {
      const Bytes bytes = encoded(message);
      std::ofstream(std::string("tests/data/navproto/") + name + ".bin", std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    const Bytes bytes = golden(name);
    ASSERT_FALSE(bytes.empty()) << name;
    const auto decoded = decode<std::decay_t<decltype(message)>>(bytes);
    ASSERT_TRUE(decoded) << name << ": " << decoded.error().message;
    EXPECT_EQ(*decoded, message) << name;
    if (std::string_view(name) != "feed") {
      EXPECT_EQ(encoded(message), bytes) << name;
    }  // zstd may pack otherwise
  });
}

TEST(Codec, EveryTruncatedPrefixIsRefused) {
  for_each_sample([](const char* name, const auto& message) {
    const Bytes bytes = encoded(message);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      // A copy of exactly that length, so that a sanitizer sees a read beyond it.
      const Bytes prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
      const auto decoded = decode<std::decay_t<decltype(message)>>(prefix);
      // The last bytes may be padding that nothing refers to; then the message must be whole.
      if (decoded) {
        EXPECT_EQ(*decoded, message) << name << ", " << length << " of " << bytes.size() << " bytes";
      }
      if (length + 8 <= bytes.size()) {
        EXPECT_FALSE(decoded) << name << ", " << length << " of " << bytes.size();
      }
    }
  });
}

TEST(Codec, APartMayLieAtAnyAddress) {
  const NavigationMessage message = sample::navigation();
  const Bytes bytes = encoded(message);
  for (std::size_t offset = 0; offset < 8; ++offset) {
    Bytes shifted(offset);
    shifted.insert(shifted.end(), bytes.begin(), bytes.end());
    const auto decoded = decode<NavigationMessage>(std::span(shifted).subspan(offset));
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(*decoded, message);
  }
}

TEST(Codec, AnyFlippedByteGivesAValidMessageOrOneLine) {
  for_each_sample([](const char* name, const auto& message) {
    const Bytes bytes = encoded(message);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      for (const unsigned mask : {0x01U, 0x80U, 0xffU}) {
        Bytes altered = bytes;
        altered[i] ^= std::byte(mask);
        const auto decoded = decode<std::decay_t<decltype(message)>>(altered);
        if (decoded) {
          EXPECT_FALSE(encoded(*decoded).empty()) << name << ", byte " << i;
        } else {
          EXPECT_EQ(decoded.error().message.find('\n'), std::string::npos) << name << ", byte " << i;
        }
      }
    }
  });
}

TEST(Codec, AnotherSchemaVersionIsNamed) {
  Bytes bytes = encoded(sample::navigation());
  bytes[7] = std::byte{kSchemaVersion + 1};
  const auto decoded = decode<NavigationMessage>(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().message,
            "message arm.nav: schema version 2 where this program speaks version 1; update the older side");
}

TEST(Codec, ABodyUnderAnotherTopicIsRefused) {
  Bytes bytes = encoded(sample::event());
  std::memcpy(bytes.data(), "arm.nav", 7);
  const auto decoded = decode<NavigationMessage>(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().message, "message arm.nav: the body is of another kind than the topic");
  EXPECT_FALSE(decode<EventMessage>(bytes));
}

TEST(Codec, TopicsAreToldByTheirFirstSevenBytes) {
  for (std::size_t i = 0; i < kTopicPrefixes.size(); ++i) {
    const auto bytes = std::as_bytes(std::span(kTopicPrefixes[i]));
    EXPECT_EQ(topic_of(bytes), static_cast<Topic>(i));
    EXPECT_EQ(topic_of(bytes.first(6)), std::nullopt);
  }
}

/// Whether check() and encode() agree that `message` may not travel.
template <class Message>
bool refused(const Message& message) {
  const bool complained = check(message).has_value();
  Encoder encoder;
  EXPECT_EQ(encoder.encode(message).empty(), complained);
  return complained;
}

template <class Change>
bool navigation_refused(Change change) {
  NavigationMessage message = sample::navigation();
  change(message);
  return refused(message);
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Ranges, NavigationHoldsOnlyWhatACameraMayFollow) {
  EXPECT_FALSE(navigation_refused([](auto&) {}));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.velocity.linear_m_s = kNan; }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.velocity.angular_rad_s = kInfinity; }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.walk = 1.001F; }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.turn = kNan; }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.motions[7].angle_rad = -kInfinity; }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.motions[0].normalised = -1.001F; }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.motions[0].shaped = kNan; }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.motions[0].confidence = -0.001F; }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.stage_us[5] = -1; }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.engagement = static_cast<Engagement>(5); }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.stop_reason = static_cast<StopReason>(9); }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.walk_motion = static_cast<MotionId>(8); }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.times.sensor_clock = static_cast<SensorClock>(4); }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.times.published = std::chrono::nanoseconds(-1); }));
  EXPECT_TRUE(navigation_refused([](auto& m) { m.header.sent = std::chrono::nanoseconds(-1); }));
}

TEST(Ranges, AStopReasonGoesWithZeroVelocityOnly) {
  EXPECT_TRUE(navigation_refused([](auto& m) { m.stop_reason = StopReason::NoUser; }));
  EXPECT_FALSE(navigation_refused([](auto& m) {
    m.stop_reason = StopReason::NoUser;
    m.velocity = {};
  }));
}

TEST(Ranges, JointsAreFiniteWithAConfidenceAndAState) {
  const auto changed = [](auto change) {
    SkeletonMessage message = sample::skeleton();
    change(message);
    return refused(message);
  };
  EXPECT_TRUE(changed([](auto& m) { m.joints[29].position.z = kNan; }));
  EXPECT_TRUE(changed([](auto& m) { m.joints[0].confidence = 1.5F; }));
  EXPECT_TRUE(changed([](auto& m) { m.joints[0].state = static_cast<JointState>(3); }));
  EXPECT_TRUE(changed([](auto& m) { m.user_position.x = kInfinity; }));
  EXPECT_TRUE(changed([](auto& m) { m.user_forward.y = kNan; }));
}

TEST(Ranges, TextIsOneLineOfUtf8) {
  const auto accepted = [](std::string text) {
    EventMessage message = sample::event();
    message.text = std::move(text);
    return !refused(message);
  };
  EXPECT_TRUE(accepted(""));
  EXPECT_TRUE(accepted(std::string(1024, 'a')));
  EXPECT_TRUE(accepted("\xc3\xa9 \xe2\x82\xac \xf0\x9f\x9a\xb6"));
  EXPECT_FALSE(accepted(std::string(1025, 'a')));
  EXPECT_FALSE(accepted("two\nlines"));
  EXPECT_FALSE(accepted(std::string("nul\0", 4)));
  EXPECT_FALSE(accepted("\xff"));              // no UTF-8
  EXPECT_FALSE(accepted("\xc0\xaf"));          // overlong
  EXPECT_FALSE(accepted("\xed\xa0\x80"));      // a surrogate
  EXPECT_FALSE(accepted("\xf4\x90\x80\x80"));  // beyond Unicode
  EXPECT_FALSE(accepted("\xe2\x82"));          // cut short
}

TEST(RoundTrip, HealthSaysWhyNoFramesCome) {
  HealthMessage message = sample::health();
  Encoder encoder;
  const std::size_t size_of_all_is_well = encoder.encode(message).size();
  message.source_trouble = "freenect:0: no Kinect is plugged in";
  const auto part = encoder.encode(message);
  EXPECT_GT(part.size(), size_of_all_is_well);
  const auto again = decode<HealthMessage>(part);
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, message);
}

TEST(Ranges, HealthCountsUpwardsFromZero) {
  const auto changed = [](auto change) {
    HealthMessage message = sample::health();
    change(message);
    return refused(message);
  };
  EXPECT_TRUE(changed([](auto& m) { m.uptime_s = -1; }));
  EXPECT_TRUE(changed([](auto& m) { m.source_trouble = "two\nlines"; }));
  EXPECT_TRUE(changed([](auto& m) { m.frames_per_second = kNan; }));
  EXPECT_TRUE(changed([](auto& m) { m.latency_p99_us = -1; }));
}

TEST(Ranges, AFeedImageHasTheSizeItSays) {
  const auto changed = [](auto change) {
    FeedMessage message = sample::feed();
    change(message);
    return refused(message.view());
  };
  EXPECT_FALSE(changed([](auto&) {}));
  EXPECT_TRUE(changed([](auto& m) { m.depth_mm.pop_back(); }));
  EXPECT_TRUE(changed([](auto& m) { m.user_mask.clear(); }));
  EXPECT_TRUE(changed([](auto& m) { m.intrinsics.width = 0; }));
  EXPECT_TRUE(changed([](auto& m) { m.intrinsics.height = kMaxFeedSide + 1; }));
  EXPECT_TRUE(changed([](auto& m) { m.intrinsics.focal_x_px = 0; }));
  EXPECT_TRUE(changed([](auto& m) { m.intrinsics.centre_y_px = kNan; }));
}

TEST(Ranges, SettingsStayWithinTheirMeaning) {
  const auto changed = [](auto change) {
    ControlRequest message = sample::request();
    change(message.settings);
    return refused(message);
  };
  EXPECT_FALSE(changed([](auto& s) { s = {}; }));
  EXPECT_TRUE(changed([](auto& s) { s.turn_motion = static_cast<MotionId>(8); }));
  EXPECT_TRUE(changed([](auto& s) { s.max_walk_m_s = 0; }));
  EXPECT_TRUE(changed([](auto& s) { s.max_turn_rad_s = kNan; }));
  EXPECT_TRUE(changed([](auto& s) { s.walk_acceleration_m_s2 = kInfinity; }));
  EXPECT_TRUE(changed([](auto& s) { s.motions[0].alpha = 1; }));
  EXPECT_TRUE(changed([](auto& s) { s.motions[0].beta = 0; }));
  EXPECT_TRUE(changed([](auto& s) { s.motions[0].range_rad = 4; }));
  EXPECT_TRUE(changed([](auto& s) { s.motions[1].motion = s.motions[0].motion; }));
}

}  // namespace
}  // namespace armature::navproto
