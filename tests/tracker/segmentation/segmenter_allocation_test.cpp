#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "tests/tracker/segmentation/room.h"
#include "tracker/segmentation/segmenter.h"

namespace {
std::size_t allocations = 0;

void* counted(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

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
  const std::size_t before = allocations;
  std::size_t users = 0;
  for (int round = 0; round < 5; ++round)
    for (const auto& picture : pictures) users += segmenter.process(picture.frame.view()).users.size();
  EXPECT_EQ(allocations, before);
  EXPECT_GT(users, 0U);
}

}  // namespace
}  // namespace armature
