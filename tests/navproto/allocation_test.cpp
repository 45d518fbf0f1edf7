#include <armature/navproto/codec.h>
#include <gtest/gtest.h>

#include "tests/navproto/sample_messages.h"
#include "tests/navproto/transport_fixture.h"
#include "tests/support/count_allocations.h"

namespace armature::navproto {
namespace {

TEST(Allocation, OfAnAlignedTypeIsCounted) {
  struct alignas(128) Wide {
    char bytes[128];
  };
  const std::size_t before = test::allocations;
  const auto one = std::make_unique<Wide>();
  const auto some = std::make_unique<Wide[]>(3);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(one.get()) % 128, 0U);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(some.get()) % 128, 0U);
  EXPECT_EQ(test::allocations, before + 2);
}

TEST(Allocation, EncodingAllocatesNothingAfterTheFirstOfAKind) {
  Encoder encoder;
  const NavigationMessage navigation = sample::navigation();
  const SkeletonMessage skeleton = sample::skeleton();
  const EventMessage event = sample::event();
  const HealthMessage health = sample::health();
  const auto encode_all = [&] {
    return encoder.encode(navigation).size() + encoder.encode(skeleton).size() + encoder.encode(event).size() +
           encoder.encode(health).size();
  };
  ASSERT_GT(encode_all(), 0U);
  const std::size_t before = test::allocations;
  for (int i = 0; i < 1000; ++i) (void)encode_all();
  EXPECT_EQ(test::allocations, before);
}

// What ZeroMQ takes from malloc() for its own message is not seen here and cannot be helped.
TEST(Allocation, PublishingAllocatesNothingOfOursAfterTheFirstOfAKind) {
  const TemporaryEndpoint endpoint;
  auto publisher = Publisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher);
  NavSubscriber nav(endpoint.uri());
  NavigationMessage navigation = sample::navigation();
  SkeletonMessage skeleton = sample::skeleton();
  const auto publish = [&] {
    publisher->publish_navigation(navigation);
    publisher->publish_skeleton(skeleton);
  };
  ASSERT_TRUE(repeat_until(publish, [&] { return nav.navigation() && nav.skeleton(); }));
  const std::size_t before = test::allocations;
  for (int i = 0; i < 1000; ++i) publish();
  EXPECT_EQ(test::allocations, before);
}

}  // namespace
}  // namespace armature::navproto
