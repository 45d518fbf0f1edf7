#include "sdk/hierarchy/collapse_queue.h"

#include <algorithm>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

TEST(CollapseQueue, IsEmptyUntilSomethingIsPushed) {
  CollapseQueue queue;
  EXPECT_TRUE(queue.empty());
  queue.arrange();
  EXPECT_TRUE(queue.empty());
  queue.push(7);
  EXPECT_EQ(queue.top(), 7U);
  queue.pop();
  EXPECT_TRUE(queue.empty());
}

TEST(CollapseQueue, GivesTheLeastWhateverIsPushedMeanwhile) {
  CollapseQueue queue;
  std::set<std::uint64_t> held;
  std::mt19937 random(1);
  const auto fresh = [&](std::uint32_t least, std::uint32_t most) {
    std::uint64_t entry = 0;
    do entry = CollapseQueue::entry(least + static_cast<std::uint32_t>(random()) % (most - least), random() & 0xFFFFFU);
    while (!held.insert(entry).second);
    return entry;
  };
  for (int k = 0; k < 20000; ++k) queue.append(fresh(0, 1000));
  queue.arrange();
  for (int k = 0; !held.empty(); ++k) {
    ASSERT_FALSE(queue.empty());
    const std::uint64_t least = *held.begin();
    ASSERT_EQ(queue.top(), least);
    held.erase(held.begin());
    const std::uint32_t key = CollapseQueue::key_of(least);
    if (k % 3 == 0 && k < 60000)
      queue.replace_top(fresh(key, key + 300));
    else
      queue.pop();
    if (k % 10 == 0 && k < 60000) queue.push(fresh(0, 2000));
    if (k == 30000) {
      for (int more = 0; more < 5000; ++more) queue.append(fresh(0, 3000));
      queue.arrange();
    }
  }
  EXPECT_TRUE(queue.empty());
}

TEST(CollapseQueue, GivesTheLeastWhereSomeWasPutBack) {
  CollapseQueue queue;
  std::multiset<std::uint64_t> held;
  std::mt19937 random(2);
  const auto fresh = [&] { return *held.insert(random() % 100000U); };
  for (int k = 0; k < 20000; ++k) queue.append(fresh());
  queue.arrange();
  while (!held.empty()) {
    std::vector<std::uint64_t> out;
    for (int k = 0; k < 100 && !held.empty(); ++k) {
      ASSERT_FALSE(queue.empty());
      ASSERT_EQ(queue.top(), *held.begin());
      out.push_back(queue.top());
      held.erase(held.begin());
      queue.pop();
    }
    // All but a third, the greatest first or in any order, while others come.
    if (random() % 4 == 0) std::shuffle(out.begin(), out.end(), random);
    for (std::size_t k = out.size(); k-- > 0;) {
      if (k % 3 == 0) continue;
      queue.put_back(*held.insert(out[k]));
      if (random() % 16 == 0) queue.push(fresh());
    }
    if (held.empty()) break;
    ASSERT_EQ(queue.top(), *held.begin());
    held.erase(held.begin());
    const std::uint64_t later = fresh();
    queue.replace_top(later);
  }
  EXPECT_TRUE(queue.empty());
}

TEST(CollapseQueue, HoldsWhatIsEqual) {
  CollapseQueue queue;
  for (int k = 0; k < 2000; ++k) queue.append(7);
  queue.arrange();
  for (int k = 0; k < 2000; ++k) {
    ASSERT_FALSE(queue.empty());
    ASSERT_EQ(queue.top(), 7U);
    queue.pop();
  }
  EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace armature::sdk
