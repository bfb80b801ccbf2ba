#include "march/brick/brick_slots.h"

namespace stratum::march {

void BrickSlots::open(std::size_t bricks, std::size_t most) {
    table_ = HugeArray<std::uint32_t>(bricks);
    size_ = std::min(bricks, most);
    bounded_ = size_ < bricks;
    if (!bounded_) {
        size_ += std::size_t{kShare} * kMostShares;
        return;
    }
    owners_.assign(size_, kNobody);
    marks_.assign(size_, 0);
    free_.reserve(size_);  // so that evict() doesn't throw while all threads wait
}

std::uint32_t BrickSlots::take(std::size_t brick) {
    std::uint32_t slot = 0;
    if (free_taken_.load(std::memory_order_relaxed) < free_.size()) {
        const std::size_t next = free_taken_.fetch_add(1, std::memory_order_relaxed);
        if (next < free_.size()) slot = free_[next];
    }
    if (slot == 0 && !bounded_) return takeFromShare();
    // Concurrent threads may increment past the end, by at most the number of threads, because each checks first.
    if (slot == 0 && used_.load(std::memory_order_relaxed) < size_) {
        const std::uint32_t next = used_.fetch_add(1, std::memory_order_relaxed);
        if (next < size_) slot = next + kFirst;
    }
    if (bounded_ && slot != 0) {
        owners_[slot - kFirst] = static_cast<std::uint32_t>(brick);
        made_.fetch_add(1, std::memory_order_relaxed);
    }
    return slot;
}

std::uint32_t BrickSlots::takeFromShare() {
    Share& share = shares_.local();
    if (share.next == share.end) {
        if (share.end == 0) share.alone = share_count_.fetch_add(1, std::memory_order_relaxed) >= kMostShares;
        const std::uint32_t count = share.alone ? 1 : kShare;
        share.next = used_.fetch_add(count, std::memory_order_relaxed);
        share.end = share.next + count;
    }
    return share.next++ + kFirst;
}

std::size_t BrickSlots::leftInShares() const {
    std::size_t left = 0;
    for (const Share& share : shares_) left += share.end - share.next;
    return left;
}

// Removes the used entries at the front of the free list.
void BrickSlots::dropTakenFree() {
    free_.erase(free_.begin(), free_.begin() + static_cast<std::ptrdiff_t>(freeTaken()));
    free_taken_ = 0;
}

void BrickSlots::forget(std::size_t brick) {
    const std::uint32_t slot = table_[brick];
    table_[brick] = 0;
    if (slot < kFirst) return;
    if (free_taken_ > 0) dropTakenFree();
    free_.push_back(slot);
    if (bounded_) owners_[slot - kFirst] = kNobody;
}

void BrickSlots::makeRoom(bool needs) {
    gate_.unlock_shared();
    if (needs) {
        waiting_.fetch_add(1, std::memory_order_relaxed);
        gate_.lock();
        waiting_.fetch_sub(1, std::memory_order_relaxed);
        if (!anyLeft()) evict();
        gate_.unlock();
    }
    gate_.lock_shared();
}

// Evicts an eighth at a time: a compromise, because all threads wait meanwhile, and because the more slots are evicted,
// the more likely they are needed again.
void BrickSlots::evict() {
    dropTakenFree();
    const std::size_t wanted = std::max<std::size_t>(size_ / 8, 1);
    // On the second round no marks are left.
    for (std::size_t n = 0; n < 2 * size_ && free_.size() < wanted; ++n) {
        const std::size_t at = hand_;
        hand_ = hand_ + 1 < size_ ? hand_ + 1 : 0;
        if (owners_[at] == kNobody) continue;
        if (marks_[at] != 0) {
            marks_[at] = 0;
            continue;
        }
        table_[owners_[at]] = 0;
        owners_[at] = kNobody;
        free_.push_back(static_cast<std::uint32_t>(at) + kFirst);
        ++evicted_;
    }
}

BrickCacheCounts BrickSlots::counts() const {
    const std::uint64_t cells = cells_.load(std::memory_order_relaxed);
    const std::uint64_t made = made_.load(std::memory_order_relaxed);
    return {size_, everTaken(), cells > made ? cells - made : 0, made, evicted_};
}

std::size_t BrickSlots::bytes() const {
    return (table_.size() + owners_.capacity()) * sizeof(std::uint32_t) + marks_.capacity() +
           (bounded_ ? free_.capacity() * sizeof(std::uint32_t) : 0);
}

}  // namespace stratum::march
