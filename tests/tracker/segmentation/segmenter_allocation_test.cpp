#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"
#include "tests/tracker/segmentation/room.h"
#include "tracker/segmentation/segmenter.h"

namespace armature {
namespace {

TEST(SegmenterAllocation, NothingIsAllocatedAfterReset) {
  std::vector<test::Room::Picture> pictures;
  for (int t = 0; t < 8; ++t) {
    test::Room room = test::furnished_room();
    room.add_person(-0.6F + 0.15F * static_cast<float>(t), 2.4F, 1);
    room.add_person(0.6F - 0.15F * static_cast<float>(t), 3.2F, 2);
    pictures.push_back(room.draw(static_cast<std::uint64_t>(t)));
  }
  Segmenter segmenter({});
  segmenter.reset(pictures[0].frame.intrinsics);
  const std::size_t before = test::allocations;
  std::size_t users = 0;
  for (int round = 0; round < 5; ++round)
    for (const auto& picture : pictures) users += segmenter.process(picture.frame.view()).users.size();
  EXPECT_EQ(test::allocations, before);
  EXPECT_GT(users, 0U);
}

}  // namespace
}  // namespace armature
