#include "march/brick/brick_grid.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel_for.h"
#include "march/brick/neighbor_signs.h"

#include <fmt/format.h>
#include <tbb/spin_mutex.h>

#include <algorithm>
#include <utility>

namespace stratum::march {
namespace {

constexpr std::size_t kGrain = 16;  // macro cells a task: enough to find their neighbours in the cache

// Samples of a level set are within its narrow band; larger ones are clamped.
double quantumOf(float background, BrickValues values) {
    return values == BrickValues::Int16 ? static_cast<double>(background) / kMostQuanta : 1;
}

}  // namespace

// Makes bricks of leaves, from any thread.
class BrickGrid::Layouter {
public:
    Layouter(const BrickGrid& grid, const LeafSource& source, std::shared_ptr<const LeafSource> owned,
             std::vector<std::uint32_t> leaves)
        : grid_(grid),
          source_(&source),
          owned_(std::move(owned)),
          leaves_(std::move(leaves)),
          scale_(static_cast<float>(1 / quantumOf(source.background(), grid.values_))) {}
    Layouter(const BrickGrid& grid, std::shared_ptr<const LeafField> field)
        : grid_(grid),
          source_(nullptr),
          field_(std::move(field)),
          scale_(static_cast<float>(1 / quantumOf(field_->background(), grid.values_))),
          neighbors_(*field_, quantumOf(field_->background(), grid.values_)) {}

    // The mutex to lock while laying out a brick. Two bricks rarely share one. It spins: a brick takes some 10
    // microseconds, about as long as to put a thread to sleep and wake it.
    tbb::spin_mutex& mutexOf(std::size_t brick) const { return mutexes_[brick % mutexes_.size()]; }

    // Coordinates in bricks. False if there is no room.
    bool layOut(std::size_t brick, int x, int y, int z) const {
        if (!grid_.slots_.anyLeft()) return false;
        return grid_.values_ == BrickValues::Float32
                   ? layOut(brick, x, y, z, grid_.floats_.data(), float_caches_.local())
                   : layOut(brick, x, y, z, grid_.quanta_.data(), quanta_caches_.local());
    }

    // All bricks of a macro cell, one after the other in memory, without those that turn out to have no surface.
    // Returns the macro cell as it is then. Coordinates in macro cells.
    MacroCell layOutAll(int x, int y, int z) const {
        return grid_.values_ == BrickValues::Float32 ? layOutAll(x, y, z, grid_.floats_.data(), float_caches_.local())
                                                     : layOutAll(x, y, z, grid_.quanta_.data(), quanta_caches_.local());
    }

    // Clears the caches of leaves, after they have changed.
    void forgetLeaves() const {
        float_caches_.clear();
        quanta_caches_.clear();
    }
    const LeafField* field() const { return field_.get(); }

private:
    template <typename T>
    bool layOut(std::size_t brick, int x, int y, int z, T* samples, LeafCache<T>& cache) const {
        const BrickParts<T> parts = field_ ? partsOfField(x, y, z, samples, cache) : partsOf(x, y, z, cache);
        const CellBits surface = surfaceOf(parts);
        std::uint32_t slot = BrickSlots::kNoSamples;
        if (hasAny(surface)) {
            slot = grid_.slots_.take(brick);
            if (slot == 0) return false;  // another thread took the last slot
            march::layOut(parts, samples + static_cast<std::ptrdiff_t>(slot - BrickSlots::kFirst) * kBrickSamples);
        }
        // By slot, bricks without surface share one place, and all write the same.
        CellBits& clear = grid_.clear_[grid_.bitsBySlot() ? slot : brick];
        for (std::size_t part = 0; part < surface.size(); ++part)
            std::atomic_ref(clear[part]).store(~surface[part], std::memory_order_relaxed);
        grid_.slots_.publish(brick, slot);
        return true;
    }

    template <typename T>
    MacroCell layOutAll(int x, int y, int z, T* samples, LeafCache<T>& cache) const {
        const std::uint64_t listed = grid_.macroCell(x, y, z).bricks;
        std::array<BrickParts<T>, 64> parts;
        std::array<CellBits, 64> surface;
        MacroCell made;
        std::size_t count = 0;
        for (std::uint64_t rest = listed; rest != 0; rest &= rest - 1) {
            const int bit = std::countr_zero(rest);
            // The leaves of one macro cell and its neighbours have distinct entries in the cache.
            parts[count] = partsOf(4 * x + (bit >> 4), 4 * y + (bit >> 2 & 3), 4 * z + (bit & 3), cache);
            surface[count] = surfaceOf(parts[count]);
            if (!hasAny(surface[count])) continue;
            made.bricks |= std::uint64_t{1} << bit;
            ++count;
        }
        made.setFirstBrick(grid_.slots_.takeRow(static_cast<std::uint32_t>(count)));
        for (std::size_t n = 0; n < count; ++n) {
            const std::size_t brick = made.firstBrick() + n;
            march::layOut(parts[n], samples + static_cast<std::ptrdiff_t>(brick) * kBrickSamples);
            for (std::size_t part = 0; part < surface[n].size(); ++part) grid_.clear_[brick][part] = ~surface[n][part];
        }
        return made;
    }

    static bool hasAny(const CellBits& bits) {
        return std::any_of(bits.begin(), bits.end(), [](std::uint64_t word) { return word != 0; });
    }

    template <typename T>
    BrickParts<T> partsOfField(int x, int y, int z, const T* samples, LeafCache<T>& cache) const {
        BrickParts<T> parts;
        const T outside = march::convert(field_->background(), scale_, T{});
        parts.tile.fill(outside);
        parts.cap_tile.fill(outside);
        const auto take = [&](std::size_t part) {
            const int px = x + static_cast<int>(part >> 1);
            const int py = y + static_cast<int>(part & 1);
            const auto* made = part != 0 ? sharedAt(px, py, z, part, samples, cache) : nullptr;
            if (made == nullptr) made = madeAt(px, py, z, cache);
            if (made == nullptr) return;
            parts.leaf[part] = &made->samples;
            parts.cap[part] = Cap<T>(made->above);
        };
        take(0);
        neighbors_.assume(parts);
        for (std::size_t part = 1; part < parts.leaf.size(); ++part)
            if (!parts.assumed[part]) take(part);
        return parts;
    }

    template <typename T>
    BrickParts<T> partsOf(int x, int y, int z, LeafCache<T>& cache) const {
        BrickParts<T> parts;
        for (std::size_t part = 0; part < parts.leaf.size(); ++part) {
            const int px = x + static_cast<int>(part >> 1);
            const int py = y + static_cast<int>(part & 1);
            parts.leaf[part] = leafAt(px, py, z, cache);
            if (parts.leaf[part] == nullptr) parts.tile[part] = tileAt(px, py, z, T{});
            if (const auto* next = leafAt(px, py, z + 1, cache))
                parts.cap[part] = Cap<T>(*next);
            else
                parts.cap_tile[part] = tileAt(px, py, z + 1, T{});
        }
        return parts;
    }

    template <typename T>
    T tileAt(int x, int y, int z, T type) const {
        return march::convert(source_->tile(coordOf(x, y, z)), scale_, type);
    }

    openvdb::Coord coordOf(int x, int y, int z) const {
        return grid_.origin_.offsetBy(x * kBrickEdge, y * kBrickEdge, z * kBrickEdge);
    }

    // A leaf of the source, null where it has none.
    template <typename T>
    const LeafSamples<T>* leafAt(int x, int y, int z, LeafCache<T>& cache) const {
        if (x >= 4 * grid_.macros_[0] || y >= 4 * grid_.macros_[1] || z >= 4 * grid_.macros_[2]) return nullptr;
        const MacroCell& macro = grid_.macroCell(x >> 2, y >> 2, z >> 2);
        if ((macro.bricks >> Mask64::bit(x & 3, y & 3, z & 3) & 1) == 0) return nullptr;
        auto& entry = cache.at(x, y, z);
        const std::uint64_t key = cache.keyOf(x, y, z);
        if (entry.key == key) return &entry.samples;
        entry.key = 0;  // invalid if reading throws
        alignas(64) float scratch[LeafSource::kLeafSamples];
        const std::uint32_t leaf = leaves_[brickIndex(macro, x & 3, y & 3, z & 3)];
        keep(source_->samples(leaf, scratch), source_->name(), source_->origin(leaf), entry.samples);
        entry.key = key;
        return &entry.samples;
    }

    // What a neighbour that is laid out shares of its leaf, null if none is. Copying costs a tenth of sampling the
    // field.
    template <typename T>
    const typename LeafCache<T>::Entry* sharedAt(int x, int y, int z, std::size_t part, const T* samples,
                                                 LeafCache<T>& cache) const {
        if (x >= 4 * grid_.macros_[0] || y >= 4 * grid_.macros_[1]) return nullptr;
        if (cache.at(x, y, z).key == cache.keyOf(x, y, z)) return nullptr;
        const MacroCell& macro = grid_.macroCell(x >> 2, y >> 2, z >> 2);
        if ((macro.bricks >> Mask64::bit(x & 3, y & 3, z & 3) & 1) == 0) return nullptr;
        const std::uint32_t slot = grid_.slots_.of(brickIndex(macro, x & 3, y & 3, z & 3));
        if (slot < BrickSlots::kFirst) return nullptr;
        auto& entry = cache.shared(part);
        copyShared(samples + static_cast<std::ptrdiff_t>(slot - BrickSlots::kFirst) * kBrickSamples, part,
                   entry.samples, entry.above);
        return &entry;
    }

    // A leaf of the field, null where all is background.
    template <typename T>
    const typename LeafCache<T>::Entry* madeAt(int x, int y, int z, LeafCache<T>& cache) const {
        auto& entry = cache.at(x, y, z);
        const std::uint64_t key = cache.keyOf(x, y, z);
        if (entry.key != key) {
            entry.key = 0;  // invalid if sampling throws
            FieldSamples made;
            const openvdb::Coord at = coordOf(x, y, z);
            entry.uniform = !field_->samples(at, made);
            if (!entry.uniform) {
                keep(made.leaf.data(), field_->name(), at, entry.samples);
                keep(made.above.data(), field_->name(), at, entry.above);
            }
            entry.key = key;
        }
        return entry.uniform ? nullptr : &entry;
    }

    template <typename Samples>
    void keep(const float* samples, const std::string& name, const openvdb::Coord& at, Samples& out) const {
        if (march::convert(samples, scale_, out)) return;
        throw InputError(
            fmt::format("the level set {} has a voxel that is not a finite number, among the 8 x 8 x 8 voxels from "
                        "index ({}, {}, {}); make the grid again",
                        name, at[0], at[1], at[2]));
    }

    const BrickGrid& grid_;
    // One of the two is set.
    const LeafSource* const source_;
    const std::shared_ptr<const LeafSource> owned_;
    const std::vector<std::uint32_t> leaves_;  // of the source, one a brick
    const std::shared_ptr<const LeafField> field_;
    const float scale_;
    const NeighborSigns neighbors_;  // of a field
    mutable std::array<tbb::spin_mutex, 1024> mutexes_;
    mutable PerThread<LeafCache<float>> float_caches_;
    mutable PerThread<LeafCache<std::int16_t>> quanta_caches_;
};

BrickGrid::BrickGrid(const LeafSource& source, BrickValues values) : values_(values) {
    const Layouter layouter(*this, source, nullptr, listBricks(source, false, kNoBound));
    HugeArray<MacroCell> made(macro_cells_.size());  // a copy, because neighbours still need the listed bricks
    parallelFor(made.size(), kGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) {
            if (macro_cells_[n].bricks == 0) continue;
            const auto ny = static_cast<std::size_t>(macros_[1]);
            const auto nz = static_cast<std::size_t>(macros_[2]);
            made[n] = layouter.layOutAll(static_cast<int>(n / nz / ny), static_cast<int>(n / nz % ny),
                                         static_cast<int>(n % nz));
        }
    });
    macro_cells_ = std::move(made);
    listed_ = brickCount();
    measureEmptySpace(macro_cells_, macros_);
}

BrickGrid::BrickGrid(std::shared_ptr<const LeafSource> source, BrickValues values, std::size_t cache_bytes)
    : values_(values) {
    const LeafSource& leaves = *source;
    layouter_ =
        std::make_unique<const Layouter>(*this, leaves, std::move(source), listBricks(leaves, true, cache_bytes));
    measureEmptySpace(macro_cells_, macros_);
}

BrickGrid::BrickGrid(std::shared_ptr<const LeafField> field, BrickValues values, std::size_t cache_bytes)
    : values_(values) {
    listBricks(*field, cache_bytes);
    layouter_ = std::make_unique<const Layouter>(*this, std::move(field));
    measureEmptySpace(macro_cells_, macros_);
}

BrickGrid::~BrickGrid() = default;

bool BrickGrid::ensureBrick(std::size_t brick, int x, int y, int z) const {
    if (slots_.of(brick) != 0) return true;
    const tbb::spin_mutex::scoped_lock lock(layouter_->mutexOf(brick));
    if (slots_.of(brick) != 0) return true;
    return layouter_->layOut(brick, x, y, z);
}

std::uint64_t BrickGrid::ensureSurface(std::size_t brick, std::size_t part, const glm::ivec3& cell) const {
    while (!ensureBrick(brick, cell.x / kBrickEdge, cell.y / kBrickEdge, cell.z / kBrickEdge)) slots_.makeRoom(true);
    if (slots_.bounded()) {
        if (const std::uint32_t slot = slots_.of(brick); slot != BrickSlots::kNoSamples) slots_.mark(slot);
        slots_.count(1);
    }
    return surface(brick, part);
}

void BrickGrid::update(std::span<const openvdb::Coord> leaves) {
    const LeafField& field = *layouter_->field();
    const BrickMap& map = field.bricks();
    layouter_->forgetLeaves();
    // With those that aren't shown.
    for (std::size_t n = 0; n < map.masks.size(); ++n) macro_cells_[n].bricks = map.masks[n];
    numberBricks();
    for (const openvdb::Coord& leaf : leaves)
        for (int part = 0; part < 8; ++part) {
            // The leaf's own brick, and those before it that take its first samples.
            const openvdb::Coord at =
                (leaf - origin_)
                    .offsetBy(-(part >> 2) * kBrickEdge, -(part >> 1 & 1) * kBrickEdge, -(part & 1) * kBrickEdge);
            if (at[0] < 0 || at[1] < 0 || at[2] < 0 || at[0] >= size_[0] || at[1] >= size_[1] || at[2] >= size_[2])
                continue;
            const MacroCell& macro = macroCell(at[0] / kMacroEdge, at[1] / kMacroEdge, at[2] / kMacroEdge);
            const int b[3] = {at[0] / kBrickEdge & 3, at[1] / kBrickEdge & 3, at[2] / kBrickEdge & 3};
            if ((macro.bricks >> Mask64::bit(b[0], b[1], b[2]) & 1) == 0) continue;
            const std::size_t brick = brickIndex(macro, b[0], b[1], b[2]);
            slots_.forget(brick);
            if (!bitsBySlot()) clear_[brick] = {};
        }
    for (std::size_t n = 0; n < map.masks.size(); ++n) macro_cells_[n].bricks = field.shows(n) ? map.masks[n] : 0;
    measureEmptySpace(macro_cells_, macros_);
}

// Finds the box, sets the bits of all leaves, and allocates the memory. Returns the leaf of each brick.
std::vector<std::uint32_t> BrickGrid::listBricks(const LeafSource& source, bool lazy, std::size_t cache_bytes) {
    unit_ = quantumOf(source.background(), values_);
    const std::size_t count = source.leafCount();
    openvdb::CoordBBox box;
    for (std::size_t n = 0; n < count; ++n) {
        const openvdb::Coord low = source.origin(n);
        box.expand(openvdb::CoordBBox(low, low.offsetBy(kBrickEdge - 1)));
    }
    std::array<int, 3> macros{};
    const openvdb::Coord origin = box.min() & ~(kMacroEdge - 1);
    for (int axis = 0; axis < 3; ++axis)
        macros[static_cast<std::size_t>(axis)] =
            static_cast<int>((std::int64_t{box.max()[axis]} - origin[axis]) / kMacroEdge + 1);
    setBox(origin, macros, count);
    const auto within = [](int cell) { return cell / kBrickEdge & 3; };
    for (std::size_t n = 0; n < count; ++n) {
        const openvdb::Coord at = source.origin(n) - origin_;
        macroOf(at).bricks |= std::uint64_t{1} << Mask64::bit(within(at[0]), within(at[1]), within(at[2]));
    }
    countBricks(lazy, cache_bytes);
    std::vector<std::uint32_t> leaves(count);
    for (std::size_t n = 0; n < count; ++n) {
        const openvdb::Coord at = source.origin(n) - origin_;
        leaves[brickIndex(macroOf(at), within(at[0]), within(at[1]), within(at[2]))] = static_cast<std::uint32_t>(n);
    }
    return leaves;
}

void BrickGrid::listBricks(const LeafField& field, std::size_t cache_bytes) {
    unit_ = quantumOf(field.background(), values_);
    const BrickMap& map = field.bricks();
    std::size_t count = 0;
    for (const std::uint64_t mask : map.masks) count += static_cast<std::size_t>(std::popcount(mask));
    setBox(map.origin, map.macros, count);
    for (std::size_t n = 0; n < map.masks.size(); ++n) macro_cells_[n].bricks = map.masks[n];
    countBricks(true, cache_bytes);
}

bool BrickGrid::canSpan(const std::array<int, 3>& macros, std::size_t leaves) {
    double cells = 1;
    for (const int macro : macros) cells *= macro;
    // Two distant leaves must not take memory for all space between them: prints have one or two macro cells a leaf, or
    // much less, and thin towers at two corners of a plate 250 at 0.02 mm; 256 take with their copy, while bricks are
    // laid out, about twice what a brick's samples do. Where the table is large, half of the free memory is for both.
    constexpr double kFew = 2097152.0;
    constexpr double kMostPerLeaf = 256;
    double most = std::min(2147483648.0, kFew + kMostPerLeaf * static_cast<double>(leaves));
    if (cells > kFew) most = std::min(most, static_cast<double>(availableMemory()) / (4 * sizeof(MacroCell)));
    constexpr std::size_t kMostBricks = 0xff000000;  // slots have 32 bits, and some are left over
    constexpr int kLongest = (1 << 19) - 1;          // macro cells: leaf coordinates are kept in 21 bits an axis
    return cells <= most && *std::max_element(macros.begin(), macros.end()) <= kLongest && leaves <= kMostBricks;
}

void BrickGrid::setBox(const openvdb::Coord& origin, const std::array<int, 3>& macros, std::size_t leaves) {
    origin_ = origin;
    macros_ = macros;
    if (!canSpan(macros, leaves))
        throw InputError(fmt::format(
            "the level set spans {} x {} x {} voxels with {} leaves, too far apart to lay them out for rays; split it "
            "or use --march vdb",
            std::int64_t{macros[0]} * kMacroEdge, std::int64_t{macros[1]} * kMacroEdge,
            std::int64_t{macros[2]} * kMacroEdge, leaves));
    for (std::size_t axis = 0; axis < 3; ++axis) size_[axis] = macros[axis] * kMacroEdge;
    std::size_t cells = 1;
    for (const int macro : macros) cells *= static_cast<std::size_t>(macro);
    macro_cells_ = HugeArray<MacroCell>(cells);
}

// Numbers the bricks whose bits are set.
void BrickGrid::numberBricks() {
    std::uint32_t first = 0;
    for (MacroCell& macro : macro_cells_) {
        macro.setFirstBrick(first);
        first += static_cast<std::uint32_t>(std::popcount(macro.bricks));
    }
    listed_ = first;
}

// Numbers the bricks whose bits are set, and allocates their memory.
void BrickGrid::countBricks(bool lazy, std::size_t cache_bytes) {
    numberBricks();
    // Address space for all bricks, of which only the used part is ever touched, or for as many as the bound allows.
    std::size_t bricks = listed_;
    if (lazy) {
        slots_.open(listed_, cache_bytes / brickBytes());
        bricks = slots_.size();
        if (slots_.bounded() && bricks < BrickSlots::kLeastBound)
            throw UsageError(fmt::format(
                "--brick-cache: {} bytes hold {} bricks of {} bytes; the rays that are on their way at a time need {}: "
                "give {} bytes or more",
                cache_bytes, bricks, brickBytes(), BrickSlots::kLeastBound, BrickSlots::kLeastBound * brickBytes()));
    }
    // By brick, a picture writes few and scattered ones.
    using Pages = HugeArray<CellBits>::Pages;
    bits_by_slot_ = lazy && !slots_.bounded();
    clear_ = HugeArray<CellBits>(bits_by_slot_ ? bricks + BrickSlots::kFirst : listed_,
                                 slots_.bounded() ? Pages::small : Pages::huge);
    const std::size_t samples = bricks * static_cast<std::size_t>(kBrickSamples);
    if (values_ == BrickValues::Float32)
        floats_ = HugeArray<float>(samples);
    else
        quanta_ = HugeArray<std::int16_t>(samples);
}

std::size_t BrickGrid::bytes() const {
    return macro_cells_.size() * sizeof(MacroCell) + (bitsBySlot() ? brickCount() : listed_) * sizeof(CellBits) +
           slots_.bytes() + brickCount() * brickBytes();
}

}  // namespace stratum::march
