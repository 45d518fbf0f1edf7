#include <thread>

#include <gtest/gtest.h>

#include "tests/navproto/transport_fixture.h"

namespace armature::navproto {
namespace {

using std::chrono::milliseconds;

TEST(Transport, ALateJoinerGetsTheLastStateAtOnce) {
  const TemporaryEndpoint endpoint;
  auto publisher = Publisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher) << publisher.error().message;
  NavigationMessage navigation = walking(0.5);
  ASSERT_TRUE(publisher->publish_navigation(navigation));
  SkeletonMessage skeleton;
  skeleton.user_id = 7;
  ASSERT_TRUE(publisher->publish_skeleton(skeleton));
  EventMessage event;
  event.text = "somebody came";
  ASSERT_TRUE(publisher->publish_event(event));
  HealthMessage health;
  health.source = "synth:test";
  ASSERT_TRUE(publisher->publish_health(health));

  NavSubscriber nav(endpoint.uri());
  std::vector<EventMessage> events;
  ASSERT_TRUE(repeat_until([&] { publisher->serve(); },
                           [&] {
                             for (EventMessage& each : nav.take_events()) events.push_back(std::move(each));
                             return nav.navigation() && nav.skeleton() && nav.health() && !events.empty();
                           }));
  EXPECT_EQ(nav.navigation()->velocity.linear_m_s, 0.5);
  EXPECT_TRUE(nav.navigation()->header.replayed);
  EXPECT_EQ(nav.navigation()->header.session_id, publisher->session_id());
  EXPECT_EQ(nav.skeleton()->user_id, 7U);
  EXPECT_EQ(nav.health()->source, "synth:test");
  EXPECT_EQ(events.front().text, "somebody came");
  EXPECT_FALSE(nav.error());
}

}  // namespace
}  // namespace armature::navproto
