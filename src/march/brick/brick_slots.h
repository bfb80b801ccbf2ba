// The memory of lazy bricks' samples: slots of equal size, allocated when bricks are laid out.
//
// There is a slot for every brick, or, with a bound, for some of them: once all are taken, bricks that were not read
// recently are evicted, and laid out again when needed. Victims are chosen by the clock algorithm (Corbató, "A paging
// experiment with the Multics system", 1968): its hand goes around, clears the mark of slots that were read since its
// last visit, and evicts those without a mark. Samples depend on the brick alone, so pictures don't depend on the
// bound.
//
// Without a bound each thread takes slots from a share of its own, so that two threads rarely wait for the same page of
// memory, which the system clears at its first touch.
//
// Threads that read samples hold a Reading; slots are evicted only while no thread holds one. A thread that finds no
// free slot finishes the reads that it has begun, and then calls makeRoom(). Without a bound all this is skipped.
#pragma once

#include "base/huge_array.h"
#include "base/parallel_for.h"

#include <oneapi/tbb/rw_mutex.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace stratum::march {

/// Statistics of a bounded cache, for reports.
struct BrickCacheCounts {
    std::size_t slots = 0;      ///< bricks that may be laid out at once
    std::size_t peak = 0;       ///< largest number that was laid out at once
    std::uint64_t hits = 0;     ///< cells whose brick was laid out when a ray reached them
    std::uint64_t made = 0;     ///< bricks laid out, again or for the first time
    std::uint64_t evicted = 0;  ///< bricks that lost their slot
};

class BrickSlots {
public:
    /// Instead of a slot: the brick is laid out, and has no surface.
    static constexpr std::uint32_t kNoSamples = 1;
    /// The number of the first slot.
    static constexpr std::uint32_t kFirst = 2;
    /// The least bound: a brick for every ray that a thread traces at a time.
    static constexpr std::size_t kLeastBound = 64;

    /// Sizes the tables for this many bricks, of which `most` may have slots at once.
    void open(std::size_t bricks, std::size_t most);
    bool bounded() const { return bounded_; }
    /// Number of slots, those that threads' shares may leave over included; undefined before open().
    std::size_t size() const { return size_; }

    /// By brick: 0 if it isn't laid out, kNoSamples, or its slot, counted from kFirst.
    const std::uint32_t* table() const { return table_.data(); }
    std::uint32_t of(std::size_t brick) { return std::atomic_ref(table_[brick]).load(std::memory_order_acquire); }
    /// A release store: a thread that reads the slot by of() sees everything written before.
    void publish(std::size_t brick, std::uint32_t slot) {
        std::atomic_ref(table_[brick]).store(slot, std::memory_order_release);
    }
    /// A free slot for this brick, or 0 if there is none. From any thread.
    std::uint32_t take(std::size_t brick);
    bool anyLeft() const {
        return !bounded_ || used_.load(std::memory_order_relaxed) < size_ || freeTaken() < free_.size();
    }
    /// Takes this many consecutive slots; returns the one before the first. Without a bound.
    std::uint32_t takeRow(std::uint32_t count) { return used_.fetch_add(count, std::memory_order_relaxed); }
    /// Frees the brick's slot. Not while rays are traced.
    void forget(std::size_t brick);

    /// With a bound, to be held while samples are read: no slot is evicted meanwhile. At most one in each thread.
    class Reading {
    public:
        explicit Reading(BrickSlots& slots) : gate_(slots.bounded_ ? &slots.gate_ : nullptr) {
            if (gate_ != nullptr) gate_->lock_shared();
        }
        ~Reading() {
            if (gate_ != nullptr) gate_->unlock_shared();
        }
        Reading(const Reading&) = delete;
        Reading& operator=(const Reading&) = delete;

    private:
        tbb::rw_mutex* const gate_;
    };
    /// Whether a thread waits for a free slot: threads that hold a Reading should then call makeRoom(false) soon.
    bool roomWanted() const { return waiting_.load(std::memory_order_relaxed) > 0; }
    /// To be called with a Reading held, by a thread that no longer needs the samples it has read. Lets other threads
    /// evict slots; if this thread `needs` a slot itself, evicts some.
    void makeRoom(bool needs);
    /// Marks the slot as recently read.
    void mark(std::uint32_t slot) {
        const std::atomic_ref mark(marks_[slot - kFirst]);
        if (mark.load(std::memory_order_relaxed) == 0) mark.store(1, std::memory_order_relaxed);
    }
    /// Counts surface cells whose brick had to be laid out, for counts().
    void count(std::uint64_t cells) { cells_.fetch_add(cells, std::memory_order_relaxed); }

    /// Bricks that have a slot now.
    std::size_t taken() const { return everTaken() - leftInShares() - (free_.size() - freeTaken()); }
    BrickCacheCounts counts() const;
    /// Memory taken, bytes.
    std::size_t bytes() const;

private:
    static constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();
    static constexpr std::uint32_t kShare = 2048;      // slots: some megabytes of samples
    static constexpr std::uint32_t kMostShares = 128;  // threads; others take slots one by one

    // Slots [next, end) of one thread, counted from 0.
    struct Share {
        std::uint32_t next = 0, end = 0;
        bool alone = false;  // one by one
    };

    std::size_t freeTaken() const { return std::min(free_taken_.load(std::memory_order_relaxed), free_.size()); }
    std::size_t everTaken() const { return std::min<std::size_t>(used_.load(std::memory_order_relaxed), size_); }
    std::size_t leftInShares() const;
    std::uint32_t takeFromShare();
    void dropTakenFree();
    void evict();

    HugeArray<std::uint32_t> table_;
    std::size_t size_ = std::numeric_limits<std::size_t>::max();
    bool bounded_ = false;
    std::atomic<std::uint32_t> used_{0};
    PerThread<Share> shares_;  // without a bound
    std::atomic<std::uint32_t> share_count_{0};
    std::vector<std::uint32_t> free_;  // emptied slots; the first free_taken_ are in use again
    std::atomic<std::size_t> free_taken_{0};

    // With a bound.
    tbb::rw_mutex gate_;
    std::atomic<int> waiting_{0};
    std::vector<std::uint32_t> owners_;  // the brick of each slot, or kNobody
    std::vector<std::uint8_t> marks_;
    std::size_t hand_ = 0;
    std::atomic<std::uint64_t> cells_{0}, made_{0};
    std::uint64_t evicted_ = 0;
};

}  // namespace stratum::march
