#include "march/brick/brick_slots.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <set>
#include <thread>
#include <vector>

namespace stratum::march {
namespace {

constexpr std::size_t kSlots = 80;

// All slots taken, by bricks of the same numbers.
void fill(BrickSlots& slots) {
    slots.open(1000, kSlots);
    ASSERT_TRUE(slots.bounded());
    for (std::uint32_t brick = 0; brick < kSlots; ++brick) {
        const std::uint32_t slot = slots.take(brick);
        ASSERT_EQ(slot, brick + BrickSlots::kFirst);
        slots.publish(brick, slot);
    }
    ASSERT_FALSE(slots.anyLeft());
    ASSERT_EQ(slots.take(500), 0U);
}

TEST(BrickSlots, GivesOutTheSlotsOfBricksThatNobodyCameToLately) {
    BrickSlots slots;
    fill(slots);
    for (std::uint32_t brick = 0; brick < kSlots; ++brick)
        if (brick % 2 == 0) slots.mark(slots.of(brick));
    const BrickSlots::Reading reading(slots);
    slots.makeRoom(true);
    EXPECT_EQ(slots.taken(), kSlots - kSlots / 8);
    for (std::uint32_t brick = 0; brick < kSlots; ++brick) {
        const bool lost = brick % 2 == 1 && brick < kSlots / 4;
        EXPECT_EQ(slots.of(brick), lost ? 0 : brick + BrickSlots::kFirst) << brick;
    }
    // Room is made only where there is none.
    slots.makeRoom(true);
    EXPECT_EQ(slots.counts().evicted, kSlots / 8);
    // The hand goes on from where it was; what had a mark then has none now.
    for (std::uint32_t n = 0; n < kSlots / 8; ++n) slots.publish(600 + n, slots.take(600 + n));
    slots.makeRoom(true);
    EXPECT_EQ(slots.of(kSlots / 4 + 1), 0U);
    EXPECT_EQ(slots.of(0), BrickSlots::kFirst);
    EXPECT_EQ(slots.of(600), BrickSlots::kFirst + 1);
    EXPECT_EQ(slots.counts().peak, kSlots);
    EXPECT_EQ(slots.counts().made, kSlots + kSlots / 8);
}

TEST(BrickSlots, FindsRoomWhereAllWereReadLately) {
    BrickSlots slots;
    fill(slots);
    for (std::uint32_t n = 0; n < kSlots; ++n) slots.mark(BrickSlots::kFirst + n);
    const BrickSlots::Reading reading(slots);
    slots.makeRoom(true);
    EXPECT_TRUE(slots.anyLeft());
}

TEST(BrickSlots, TakesForgottenBricksFirst) {
    BrickSlots slots;
    fill(slots);
    slots.forget(7);
    slots.forget(9);
    slots.forget(9);  // has none by now
    slots.publish(11, BrickSlots::kNoSamples);
    slots.forget(11);
    EXPECT_EQ(slots.of(11), 0U);
    EXPECT_EQ(slots.take(700), 7 + BrickSlots::kFirst);
    slots.forget(20);
    EXPECT_EQ(slots.take(701), 9 + BrickSlots::kFirst);
    EXPECT_EQ(slots.take(702), 20 + BrickSlots::kFirst);
    EXPECT_EQ(slots.take(703), 0U);
    EXPECT_EQ(slots.counts().evicted, 0U);
}

TEST(BrickSlots, HaveNoBoundIfThereIsRoomForAll) {
    BrickSlots slots;
    slots.open(1000, 1000);
    EXPECT_FALSE(slots.bounded());
    for (std::uint32_t brick = 0; brick < 1000; ++brick) EXPECT_NE(slots.take(brick), 0U);
    EXPECT_EQ(slots.taken(), 1000U);
    EXPECT_TRUE(slots.anyLeft());
}

// Threads have shares of their own, which end in the middle.
TEST(BrickSlots, GiveEveryBrickItsOwnSlotWithoutABound) {
    constexpr std::uint32_t kThreads = 4;
    constexpr std::uint32_t kEach = 5000;
    BrickSlots slots;
    slots.open(std::size_t{kThreads} * kEach, std::numeric_limits<std::size_t>::max());
    ASSERT_FALSE(slots.bounded());
    std::vector<std::vector<std::uint32_t>> taken(kThreads);
    std::vector<std::thread> threads;
    for (std::uint32_t n = 0; n < kThreads; ++n)
        threads.emplace_back([&slots, &mine = taken[n], n] {
            for (std::uint32_t brick = n * kEach; brick < (n + 1) * kEach; ++brick) mine.push_back(slots.take(brick));
        });
    for (std::thread& thread : threads) thread.join();
    std::set<std::uint32_t> different;
    for (const auto& mine : taken) different.insert(mine.begin(), mine.end());
    EXPECT_EQ(different.size(), std::size_t{kThreads} * kEach);
    EXPECT_GE(*different.begin(), BrickSlots::kFirst);
    EXPECT_LT(*different.rbegin(), slots.size() + BrickSlots::kFirst);
    EXPECT_EQ(slots.taken(), different.size());
}

}  // namespace
}  // namespace stratum::march
