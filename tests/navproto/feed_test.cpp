#include <thread>

#include <armature/navproto/feed.h>
#include <gtest/gtest.h>

#include "tests/navproto/sample_messages.h"
#include "tests/navproto/transport_fixture.h"

namespace armature::navproto {
namespace {

using std::chrono::milliseconds;

TEST(Feed, IsSentOnlyWhileSomebodySubscribes) {
  const TemporaryEndpoint endpoint;
  auto publisher = FeedPublisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher) << publisher.error().message;
  const FeedMessage sent = sample::feed();
  EXPECT_FALSE(publisher->wanted());
  EXPECT_FALSE(publisher->publish(sent.view()).value());
  {
    auto subscriber = FeedSubscriber::connect(endpoint.uri());
    ASSERT_TRUE(subscriber) << subscriber.error().message;
    std::optional<FeedMessage> got;
    ASSERT_TRUE(repeat_until([&] { EXPECT_TRUE(publisher->publish(sent.view())); },
                             [&] {
                               auto received = subscriber->receive(milliseconds(1));
                               EXPECT_TRUE(received);
                               got = *std::move(received);
                               return got.has_value();
                             }));
    EXPECT_EQ(got->depth_mm, sent.depth_mm);
    EXPECT_EQ(got->user_mask, sent.user_mask);
    EXPECT_EQ(got->intrinsics, sent.intrinsics);
    EXPECT_EQ(got->times.frame, sent.times.frame);
    EXPECT_GE(got->header.sequence, 1U);
    EXPECT_TRUE(publisher->wanted());
  }
  EXPECT_TRUE(repeat_until([] {}, [&] { return !publisher->wanted(); })) << "the last subscriber has gone";
}

TEST(Feed, StaysWantedUntilTheLastOfSeveralSubscribersGoes) {
  const TemporaryEndpoint endpoint;
  auto publisher = FeedPublisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher);
  auto staying = FeedSubscriber::connect(endpoint.uri());
  const FeedMessage sent = sample::feed();
  const auto hears = [&](FeedSubscriber& subscriber) {
    return repeat_until([&] { (void)publisher->publish(sent.view()); },
                        [&] { return subscriber.receive(milliseconds(1)).value().has_value(); });
  };
  {
    auto leaving = FeedSubscriber::connect(endpoint.uri());
    ASSERT_TRUE(hears(*leaving));
    ASSERT_TRUE(hears(*staying));
  }
  ASSERT_TRUE(hears(*staying));
  EXPECT_TRUE(publisher->wanted());
}

TEST(Feed, AnImageThatIsNotTheSizeItSaysIsRefused) {
  const TemporaryEndpoint endpoint;
  auto publisher = FeedPublisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher);
  auto subscriber = FeedSubscriber::connect(endpoint.uri());
  ASSERT_TRUE(repeat_until([] {}, [&] { return publisher->wanted(); }));
  FeedMessage wrong = sample::feed();
  wrong.user_mask.pop_back();
  const auto published = publisher->publish(wrong.view());
  ASSERT_FALSE(published);
  EXPECT_EQ(published.error().message, "feed: user mask: must hold width times height pixels");
}

TEST(Feed, ASubscriberThatComesLateToItsQueueFindsTheNewestImage) {
  const TemporaryEndpoint endpoint;
  auto publisher = FeedPublisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher);
  auto subscriber = FeedSubscriber::connect(endpoint.uri());
  ASSERT_TRUE(repeat_until([] {}, [&] { return publisher->wanted(); }));
  FeedMessage message = sample::feed();
  for (std::uint64_t frame = 1; frame <= 50; ++frame) {
    message.times.frame = frame;
    ASSERT_TRUE(publisher->publish(message.view()));
    std::this_thread::sleep_for(milliseconds(2));
  }
  // The last one may be on its way still; no older one waits behind it.
  std::uint64_t newest = 0;
  int received = 0;
  ASSERT_TRUE(repeat_until([] {},
                           [&] {
                             const auto got = subscriber->receive(milliseconds(0)).value();
                             if (got) ++received, newest = got->times.frame;
                             return newest == 50;
                           }));
  EXPECT_LE(received, 3);
}

}  // namespace
}  // namespace armature::navproto
