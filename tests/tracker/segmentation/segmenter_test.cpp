#include "tracker/segmentation/segmenter.h"

#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/tracker/segmentation/room.h"
#include "tracker/segmentation/stored_background.h"

namespace armature {
namespace {

using test::furnished_room;
using test::Room;

float intersection_over_union(std::span<const std::uint8_t> mask, std::uint8_t id, std::span<const std::uint8_t> truth,
                              std::uint8_t who) {
  int both = 0;
  int either = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    both += mask[i] == id && truth[i] == who;
    either += mask[i] == id || truth[i] == who;
  }
  return either > 0 ? static_cast<float>(both) / static_cast<float>(either) : 0.0F;
}

const User* nearest_to(const Segmentation& result, float x) {
  const auto user =
      std::ranges::min_element(result.users, {}, [x](const User& u) { return std::abs(u.centre.x() - x); });
  return user == result.users.end() ? nullptr : &*user;
}

TEST(Segmenter, FindsAPersonInTheFirstFrameOfAFurnishedRoom) {
  Room room = furnished_room();
  room.add_person(0.2F, 2.5F, 1);
  const auto picture = room.draw();
  Segmenter segmenter({});
  const Segmentation& result = segmenter.process(picture.frame.view());
  ASSERT_EQ(result.users.size(), 1U);
  EXPECT_GE(intersection_over_union(result.user_of_pixel, result.users[0].id, picture.truth, 1), 0.95F);
  EXPECT_NEAR(result.users[0].centre.x(), 0.2F, 0.05F);
  EXPECT_EQ(result.users[0].id, 1);
}

TEST(Segmenter, WhatStandsInTheStoredBackgroundIsNobodyFromTheFirstFrameOn) {
  Room room = furnished_room();
  room.add_person(-0.6F, 2.6F, 2);  // a dummy
  const std::vector<DepthFrame> empty = {room.draw(1).frame, room.draw(2).frame, room.draw(3).frame};
  room.add_person(0.3F, 2.5F, 1);
  const auto picture = room.draw(4);
  ASSERT_EQ(Segmenter({}).process(picture.frame.view()).users.size(), 2U) << "without it";

  Segmenter segmenter({.background = std::make_shared<const StoredBackground>(median_of(empty))});
  const Segmentation& result = segmenter.process(picture.frame.view());
  ASSERT_EQ(result.users.size(), 1U);
  EXPECT_GE(intersection_over_union(result.user_of_pixel, result.users[0].id, picture.truth, 1), 0.9F);
}

TEST(StoredBackground, IsTheMedianAndReadsBackAsItWasWritten) {
  std::vector<DepthFrame> frames(5);
  for (std::size_t n = 0; n < frames.size(); ++n) {
    frames[n].intrinsics = {3, 1, 300, 300, 1.5, 0.5};
    frames[n].depth_mm = {static_cast<std::uint16_t>(1000 + n), 0, static_cast<std::uint16_t>(n < 2 ? 0 : 40000)};
  }
  frames[4].depth_mm[0] = 9;
  const StoredBackground background = median_of(frames);
  EXPECT_EQ(background.depth_mm, (std::vector<std::uint16_t>{1001, 0, 40000}));
  const std::string text = print_background(background);
  const auto bytes = std::as_bytes(std::span(text));
  const auto read = parse_background(bytes, "whole");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->depth_mm, background.depth_mm);
  EXPECT_EQ(read->width, 3);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(parse_background(bytes.first(size), "cut")) << size;
  }
}

/// How well the first frame shows person 1 as the only user: intersection over union, 0 with more or fewer users.
float found_at_once(const Room& room) {
  const auto picture = room.draw();
  Segmenter segmenter({});
  const Segmentation& result = segmenter.process(picture.frame.view());
  if (result.users.size() != 1) return 0;
  return intersection_over_union(result.user_of_pixel, result.users[0].id, picture.truth, 1);
}

TEST(Segmenter, FindsAPersonWhoseLegsACounterHides) {
  for (const float height : {0.8F, 0.95F, 1.1F}) {
    Room room(1.3F);
    room.add_floor();
    room.add_wall(4.0F);
    room.add_box({-0.7F, -height, 1.9F}, {0.7F, 0, 2.2F});
    room.add_person(0, 2.9F, 1);
    EXPECT_GE(found_at_once(room), 0.93F) << height;
  }
}

TEST(Segmenter, WhatHangsHighOnAWallIsNobody) {
  Room room = furnished_room();
  room.add_ellipsoid({0.9F, -1.6F, 3.9F}, {0.3F, 0.35F, 0.25F});
  Segmenter segmenter({});
  EXPECT_TRUE(segmenter.process(room.draw().frame.view()).users.empty());
}

TEST(Segmenter, AForearmBeforeTheBodyDoesNotCutHerInTwo) {
  Room room(1.2F);
  room.add_floor();
  room.add_wall(4.0F);
  room.add_person(0, 1.9F, 1);
  room.add_ellipsoid({0, -0.98F, 1.6F}, {0.36F, 0.07F, 0.06F}, 1);
  EXPECT_GE(found_at_once(room), 0.93F);
}

TEST(Segmenter, APersonOnThePlaneOfACupboardIsNotAPartOfIt) {
  Room room(1.2F);
  room.add_floor();
  room.add_box({0.6F, -2.0F, 3.3F}, {1.9F, 0, 3.8F});
  room.add_person(-0.3F, 3.36F, 1);
  EXPECT_GE(found_at_once(room), 0.9F);
}

TEST(Segmenter, ACupboardFarAwayIsNobody) {
  for (const float z : {3.3F, 3.7F, 4.1F}) {
    Room room(1.2F);
    room.add_floor();
    room.add_box({0.9F, -1.6F, z}, {1.35F, 0, z + 0.4F});
    Segmenter segmenter({});
    EXPECT_TRUE(segmenter.process(room.draw().frame.view()).users.empty()) << z;
  }
}

TEST(Segmenter, MeasuresTheFloorUnderATiltedSensor) {
  for (const float tilt_deg : {-20.0F, -8.0F, 0.0F, 12.0F, 25.0F}) {
    for (const float height : {0.5F, 1.0F, 2.0F}) {
      const float tilt = tilt_deg * std::numbers::pi_v<float> / 180;
      // Positive tilt looks down. The image's lower edge looks down another 22.8 degrees: at least a metre and a half
      // of floor must show before the wall.
      const float lowest_ray = tilt + 22.8F * std::numbers::pi_v<float> / 180;
      if (lowest_ray <= 0 || height / std::tan(lowest_ray) > 2.5F) continue;
      Room room = furnished_room(height, tilt);
      room.add_person(0.2F, 2.5F, 1);
      Segmenter segmenter({});
      const Segmentation& result = segmenter.process(room.draw().frame.view());
      ASSERT_TRUE(result.floor.has_value()) << tilt_deg << " degrees, " << height << " m";
      EXPECT_NEAR(result.floor->offset, height, 0.03F) << tilt_deg << " degrees";
      const Eigen::Vector3f up(0, -std::cos(tilt), -std::sin(tilt));
      EXPECT_GT(up.dot(result.floor->normal), std::cos(0.02F)) << tilt_deg << " degrees, " << height << " m";
      EXPECT_EQ(result.up, result.floor->normal);
    }
  }
}

TEST(Segmenter, ATableTopIsNotTheFloorNorIsAWall) {
  Room room(1.2F);
  room.add_wall(3.0F);
  room.add_box({-0.9F, -0.75F, 1.6F}, {0.9F, -0.70F, 2.4F});
  Segmenter segmenter({});
  for (std::uint64_t t = 0; t < 20; ++t) EXPECT_FALSE(segmenter.process(room.draw(t).frame.view()).floor.has_value());
}

TEST(Segmenter, WithoutFloorUpIsTheCamerasOwn) {
  Room room;
  room.add_person(0, 2.5F, 1);
  Segmenter segmenter({});
  const Segmentation& result = segmenter.process(room.draw().frame.view());
  EXPECT_FALSE(result.floor.has_value());
  EXPECT_EQ(result.up, Eigen::Vector3f(0, -1, 0));
  EXPECT_EQ(result.users.size(), 1U);
}

TEST(Segmenter, AnEmptyRoomHasNoUsers) {
  const Room room = furnished_room();
  Segmenter segmenter({});
  for (std::uint64_t t = 0; t < 40; ++t) EXPECT_TRUE(segmenter.process(room.draw(t).frame.view()).users.empty());
}

TEST(Segmenter, KeepsWhoIsWhoWhenTwoCross) {
  Segmenter segmenter({});
  std::uint8_t left = 0;
  std::uint8_t right = 0;
  for (int t = 0; t <= 60; ++t) {
    Room room = furnished_room();
    const float x = 0.9F - 0.03F * static_cast<float>(t);
    room.add_person(-x, 2.2F, 1);
    room.add_person(x, 3.0F, 2);
    const auto picture = room.draw(static_cast<std::uint64_t>(t));
    const Segmentation& result = segmenter.process(picture.frame.view());
    ASSERT_LE(result.users.size(), 2U) << "frame " << t;
    if (t == 0 || t == 60) {
      ASSERT_EQ(result.users.size(), 2U) << "frame " << t;
      const std::uint8_t near_left = nearest_to(result, t == 0 ? -0.9F : 0.9F)->id;
      const std::uint8_t far_right = nearest_to(result, t == 0 ? 0.9F : -0.9F)->id;
      if (t == 0) {
        left = near_left;
        right = far_right;
      }
      EXPECT_EQ(near_left, left);
      EXPECT_EQ(far_right, right);
    }
  }
}

TEST(Segmenter, BridgesAFrameWithoutData) {
  Room room = furnished_room();
  room.add_person(0, 2.5F, 1);
  auto picture = room.draw();
  Segmenter segmenter({});
  const std::uint8_t id = segmenter.process(picture.frame.view()).users[0].id;
  auto blank = picture.frame;
  std::ranges::fill(blank.depth_mm, std::uint16_t{0});
  EXPECT_TRUE(segmenter.process(blank.view()).users.empty());
  const Segmentation& result = segmenter.process(picture.frame.view());
  ASSERT_EQ(result.users.size(), 1U);
  EXPECT_EQ(result.users[0].id, id);
}

TEST(Segmenter, APersonWhoStandsStillForMinutesDoesNotBecomeBackground) {
  Room room = furnished_room();
  room.add_person(0, 2.5F, 1);
  std::vector<Room::Picture> pictures;
  for (std::uint64_t t = 0; t < 8; ++t) pictures.push_back(room.draw(t, 0.5F, 80, 60));
  Segmenter segmenter({});
  for (std::size_t t = 0; t < 4000; ++t) {
    const auto& picture = pictures[t % pictures.size()];
    const Segmentation& result = segmenter.process(picture.frame.view());
    ASSERT_EQ(result.users.size(), 1U) << "frame " << t;
    ASSERT_EQ(result.users[0].id, 1) << "frame " << t;
  }
}

TEST(Segmenter, ALearnedTableIsNotPartOfWhoeverTouchesIt) {
  Segmenter segmenter({});
  for (std::uint64_t t = 0; t < 20; ++t) (void)segmenter.process(furnished_room().draw(t).frame.view());
  Room room = furnished_room();
  room.add_person(-0.55F, 2.6F, 1);
  const auto picture = room.draw(20);
  const Segmentation& result = segmenter.process(picture.frame.view());
  ASSERT_EQ(result.users.size(), 1U);
  EXPECT_GE(intersection_over_union(result.user_of_pixel, result.users[0].id, picture.truth, 1), 0.93F);
}

TEST(Segmenter, WhoLeavesIsGoneAndTheNextOneIsSomebodyElse) {
  Segmenter segmenter({});
  Room with = furnished_room();
  with.add_person(0, 2.5F, 1);
  const auto there = with.draw();
  const auto empty = furnished_room().draw();
  for (int t = 0; t < 20; ++t) (void)segmenter.process(there.frame.view());
  for (int t = 0; t < 60; ++t) EXPECT_TRUE(segmenter.process(empty.frame.view()).users.empty());
  const Segmentation& result = segmenter.process(there.frame.view());
  ASSERT_EQ(result.users.size(), 1U);
  EXPECT_EQ(result.users[0].id, 2);
}

TEST(Segmenter, TheSameFramesGiveTheSameMasks) {
  Segmenter first({});
  Segmenter second({});
  for (int t = 0; t < 12; ++t) {
    Room room = furnished_room();
    room.add_person(0.05F * static_cast<float>(t), 2.5F, 1);
    const auto picture = room.draw(static_cast<std::uint64_t>(t));
    const Segmentation& a = first.process(picture.frame.view());
    const Segmentation& b = second.process(picture.frame.view());
    EXPECT_TRUE(std::ranges::equal(a.user_of_pixel, b.user_of_pixel)) << "frame " << t;
    ASSERT_EQ(a.floor.has_value(), b.floor.has_value());
    if (a.floor) {
      EXPECT_EQ(a.floor->offset, b.floor->offset);
    }
  }
}

TEST(Segmenter, DescribesUsersAsTheMaskShowsThem) {
  Room room = furnished_room();
  room.add_person(-0.3F, 2.2F, 1);
  room.add_person(0.8F, 2.8F, 2);
  const auto picture = room.draw(0, 0.5F, 640, 480);
  Segmenter segmenter({});
  const Segmentation& result = segmenter.process(picture.frame.view());
  ASSERT_EQ(result.users.size(), 2U);
  EXPECT_GE(result.users[0].pixel_count, result.users[1].pixel_count);
  for (const User& user : result.users) {
    int count = 0;
    int left = 640, top = 480, right = 0, bottom = 0;
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) {
        if (result.user_of_pixel[static_cast<std::size_t>(v * 640 + u)] != user.id) continue;
        ++count;
        left = std::min(left, u);
        top = std::min(top, v);
        right = std::max(right, u + 1);
        bottom = std::max(bottom, v + 1);
      }
    }
    EXPECT_EQ(user.pixel_count, count);
    EXPECT_EQ(user.left, left);
    EXPECT_EQ(user.top, top);
    EXPECT_EQ(user.right, right);
    EXPECT_EQ(user.bottom, bottom);
  }
}

TEST(Segmenter, AFrameOfZerosHasNobody) {
  DepthFrame frame;
  frame.intrinsics = {320, 240, 285.63, 285.63, 160, 120};
  frame.depth_mm.assign(320 * 240, 0);
  Segmenter segmenter({});
  const Segmentation& result = segmenter.process(frame.view());
  EXPECT_TRUE(result.users.empty());
  EXPECT_FALSE(result.floor.has_value());
  EXPECT_EQ(result.user_of_pixel.size(), frame.depth_mm.size());
}

TEST(Segmenter, TakesImagesOfAnySize) {
  Segmenter segmenter({});
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {3, 1}, {17, 13}, {4096, 1}, {1, 4096}, {2048, 1536}}) {
    DepthFrame frame;
    frame.intrinsics = {width, height, 300, 300, width / 2.0, height / 2.0};
    frame.depth_mm.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 1500);
    const Segmentation& result = segmenter.process(frame.view());
    EXPECT_EQ(result.user_of_pixel.size(), frame.depth_mm.size());
  }
}

TEST(Segmenter, RefusesWhatIsNoImage) {
  Segmenter segmenter({});
  DepthFrame frame;
  frame.depth_mm.assign(100, 1500);
  for (const Intrinsics& intrinsics :
       {Intrinsics{}, Intrinsics{10, 10, 0, 0, 5, 5}, Intrinsics{-10, -10, 300, 300, 5, 5},
        Intrinsics{10, 9, 300, 300, 5, 5}, Intrinsics{100'000, 100'000, 300, 300, 5, 5},
        Intrinsics{10, 10, std::numeric_limits<double>::quiet_NaN(), 300, 5, 5}}) {
    frame.intrinsics = intrinsics;
    const Segmentation& result = segmenter.process(frame.view());
    EXPECT_TRUE(result.users.empty());
    EXPECT_TRUE(result.user_of_pixel.empty());
  }
}

}  // namespace
}  // namespace armature
