#include "voxelize/leaf/leaf_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/leaf/leaf_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "voxelize/leaf/path_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace stratum::voxelize {
namespace HWY_NAMESPACE {

template <typename Path>
HWY_INLINE void minimumOf(const ColumnGrid& grid, std::span<const Path> paths, PlanField& d, const std::uint32_t* ids,
                          PlanOwners* owners) {
    const F f;
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF qx = hn::Load(f, grid.qx.v + c);
        const VF qy = hn::Load(f, grid.qy.v + c);
        VF least = hn::Load(f, d.v + c);
        if (owners == nullptr) {
            for (const Path& path : paths) least = hn::Min(least, offset(path, qx, qy));
        } else {
            const U u;
            hn::Vec<U> owner = hn::Load(u, owners->v + c);
            for (std::size_t n = 0; n < paths.size(); ++n) {
                const VF own = offset(paths[n], qx, qy);
                const auto nearer = hn::Lt(own, least);
                least = hn::IfThenElse(nearer, own, least);
                owner = hn::IfThenElse(hn::RebindMask(u, nearer), hn::Set(u, ids[n]), owner);
            }
            hn::Store(owner, u, owners->v + c);
        }
        hn::Store(least, f, d.v + c);
    });
}

void MinimumOfLines(const ColumnGrid& grid, std::span<const LocalLine> lines, PlanField& d, const std::uint32_t* ids,
                    PlanOwners* owners) {
    minimumOf(grid, lines, d, ids, owners);
}

void MinimumOfArcs(const ColumnGrid& grid, std::span<const LocalArc> arcs, PlanField& d, const std::uint32_t* ids,
                   PlanOwners* owners) {
    minimumOf(grid, arcs, d, ids, owners);
}

void MinimumOfTapers(const ColumnGrid& grid, std::span<const LocalTaper> tapers, PlanField& d, const std::uint32_t* ids,
                     PlanOwners* owners) {
    minimumOf(grid, tapers, d, ids, owners);
}

float SquaredSides(const PlanField& d, PlanField& out) {
    const F f;
    VF least = hn::Set(f, 3e38f);
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF side = hn::Max(hn::Load(f, d.v + c), hn::Zero(f));
        const VF squared = hn::Mul(side, side);
        hn::Store(squared, f, out.v + c);
        least = hn::Min(least, squared);
    });
    return hn::GetLane(hn::MinOfLanes(f, least));
}

float MaximumOf(const PlanField& a, const PlanField& b, PlanField& out) {
    const F f;
    VF least = hn::Set(f, 3e38f);
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF larger = hn::Max(hn::Load(f, a.v + c), hn::Load(f, b.v + c));
        hn::Store(larger, f, out.v + c);
        least = hn::Min(least, larger);
    });
    return hn::GetLane(hn::MinOfLanes(f, least));
}

// The height over the center plane before the upper half was moved up by `rise`. Where that is negative, heights just
// over the plane count twice, so that none is passed over.
HWY_INLINE VF heightBefore(float dz, VF rise) {
    const F f;
    const VF height = hn::Set(f, dz);
    return hn::Max(hn::Min(hn::Sub(height, rise), hn::Set(f, 2 * dz)), hn::Min(height, hn::Zero(f)));
}

// The same as below, of layers whose tops are raised.
HWY_INLINE VF raisedLayers(const PlaneTerm* terms, const PlaneTerms& of, std::size_t c) {
    const F f;
    const VF zero = hn::Zero(f);
    const VF half_side = hn::Set(f, of.half_side);
    VF least = hn::Set(f, 3e38f);
    VF deepest = zero;
    for (std::uint32_t t = of.first; t != of.last; ++t) {
        const PlaneTerm& term = terms[t];
        VF above2 = hn::Set(f, term.dz2);
        VF over = hn::Set(f, term.over);
        if (term.rise != nullptr) {
            over = hn::Sub(hn::Abs(heightBefore(term.dz, hn::Load(f, term.rise->v + c))), half_side);
            const VF above = hn::Max(over, zero);
            above2 = hn::Mul(above, above);
        }
        least = hn::Min(least, hn::Add(hn::Load(f, term.sides2->v + c), above2));
        if (of.straight_sides) deepest = hn::Min(deepest, hn::Max(hn::Load(f, term.d->v + c), over));
    }
    return hn::Add(hn::Sub(hn::Sqrt(least), hn::Set(f, of.radius)), deepest);
}

void ExpandLayers(const LeafTerms& leaf, float background, LeafPlanes& phi) {
    const F f;
    const PlaneTerm* const terms = leaf.terms.data();
    std::uint32_t group = 0;
    std::uint32_t weld = 0;
    for (std::size_t z = 0; z < leaf.planes; ++z) {
        const std::uint32_t group_end = leaf.group_end[z];
        const std::uint32_t weld_end = leaf.weld_end[z];
        forEachVector([&](std::size_t c) HWY_ATTR {
            VF value = hn::Set(f, background);
            for (std::uint32_t g = group; g != group_end; ++g) {
                const PlaneTerms& of = leaf.groups[g];
                if (of.rises) {
                    value = hn::Min(value, raisedLayers(terms, of, c));
                    continue;
                }
                VF least = hn::Add(hn::Load(f, terms[of.first].sides2->v + c), hn::Set(f, terms[of.first].dz2));
                for (std::uint32_t t = of.first + 1; t != of.last; ++t)
                    least = hn::Min(least, hn::Add(hn::Load(f, terms[t].sides2->v + c), hn::Set(f, terms[t].dz2)));
                VF layers = hn::Sub(hn::Sqrt(least), hn::Set(f, of.radius));
                if (of.straight_sides) {
                    // Inside the rectangle of flats and sides the root is 0, and the depth in it counts.
                    VF deepest = hn::Zero(f);
                    for (std::uint32_t t = of.first; t != of.last; ++t)
                        deepest = hn::Min(deepest, hn::Max(hn::Load(f, terms[t].d->v + c), hn::Set(f, terms[t].over)));
                    layers = hn::Add(layers, deepest);
                }
                value = hn::Min(value, layers);
            }
            for (std::uint32_t w = weld; w != weld_end; ++w) {
                // A bound, not a distance: used only where it is negative, because outside it can be below the
                // distance.
                const VF body = hn::Max(hn::Load(f, leaf.welds[w].d->v + c), hn::Set(f, leaf.welds[w].bound));
                value = hn::IfThenElse(hn::Lt(body, hn::Zero(f)), hn::Min(value, body), value);
            }
            hn::Store(value, f, phi.plane[z].v + c);
        });
        group = group_end;
        weld = weld_end;
    }
}

void SlopedLine(const ColumnGrid& grid, const LocalLine& line, float z0, float climb_per_unit, PlanField& d,
                PlanField& center_z) {
    const F f;
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF qx = hn::Load(f, grid.qx.v + c);
        const VF qy = hn::Load(f, grid.qy.v + c);
        hn::Store(offset(line, qx, qy), f, d.v + c);
        const VF s = hn::Min(hn::Max(along(line, qx, qy), hn::Set(f, line.lo)), hn::Set(f, line.hi));
        hn::Store(hn::Add(hn::Set(f, z0), hn::Mul(s, hn::Set(f, climb_per_unit))), f, center_z.v + c);
    });
}

// The height over the center line of a sloped bead, its underside lowered.
HWY_INLINE VF slopedHeight(const PlanField& center_z, std::size_t c, const SlopedTerm& term, float z) {
    const F f;
    const VF up = hn::Mul(hn::Sub(hn::Set(f, z), hn::Load(f, center_z.v + c)), hn::Set(f, term.cosine));
    const VF below = hn::Min(hn::Add(up, hn::Set(f, term.reach)), hn::Zero(f));
    return hn::IfThenElse(hn::Lt(up, hn::Zero(f)), below, up);
}

void ExpandSloped(const PlanField& sides2, const PlanField& center_z, const SlopedTerm& term, float z, PlanField& phi) {
    const F f;
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF height = slopedHeight(center_z, c, term, z);
        const VF value =
            hn::Sub(hn::Sqrt(hn::Add(hn::Load(f, sides2.v + c), hn::Mul(height, height))), hn::Set(f, term.radius));
        hn::Store(hn::Min(hn::Load(f, phi.v + c), value), f, phi.v + c);
    });
}

// Of a section with straight sides: the distance to its rectangle of flats and sides, negative inside, less the radius.
HWY_INLINE VF cornered(VF d, VF over, float radius) {
    const F f;
    const VF zero = hn::Zero(f);
    const VF side = hn::Max(d, zero);
    const VF above = hn::Max(over, zero);
    const VF outside = hn::Sqrt(dot(side, above, side, above));
    return hn::Sub(hn::Add(outside, hn::Min(hn::Max(d, over), zero)), hn::Set(f, radius));
}

void ExpandSlopedSides(const PlanField& d, const PlanField& center_z, const SlopedTerm& term, float z, PlanField& phi) {
    const F f;
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF over = hn::Sub(hn::Abs(slopedHeight(center_z, c, term, z)), hn::Set(f, term.half_side));
        const VF value = cornered(hn::Load(f, d.v + c), over, term.radius);
        hn::Store(hn::Min(hn::Load(f, phi.v + c), value), f, phi.v + c);
    });
}

void ExpandRod(const ColumnGrid& grid, const LocalRod& rod, float z, PlanField& phi) {
    const F f;
    const VF b0 = hn::Set(f, rod.b0 + rod.bz * z);
    const VF s0 = hn::Set(f, rod.uz * z);
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF qx = hn::Load(f, grid.qx.v + c);
        const VF qy = hn::Load(f, grid.qy.v + c);
        const VF a = hn::Add(hn::Set(f, rod.n0), dot(hn::Set(f, rod.nx), hn::Set(f, rod.ny), qx, qy));
        const VF b = hn::Add(b0, dot(hn::Set(f, rod.bx), hn::Set(f, rod.by), qx, qy));
        const VF s = hn::Add(s0, dot(hn::Set(f, rod.ux), hn::Set(f, rod.uy), qx, qy));
        const VF e = beyond(s, rod.lo, rod.hi);
        const VF value = hn::Sub(hn::Sqrt(hn::Add(dot(a, b, a, b), hn::Mul(e, e))), hn::Set(f, rod.radius));
        hn::Store(hn::Min(hn::Load(f, phi.v + c), value), f, phi.v + c);
    });
}

LeafContent ClampLeaf(LeafPlanes& phi, std::size_t planes, float background) {
    const F f;
    const VF low = hn::Set(f, -background);
    const VF high = hn::Set(f, background);
    VF least = high;
    VF most = low;
    for (std::size_t z = 0; z < planes; ++z) {
        PlanField& plane = phi.plane[z];
        forEachVector([&](std::size_t c) HWY_ATTR {
            const VF value = hn::Min(hn::Max(hn::Load(f, plane.v + c), low), high);
            least = hn::Min(least, value);
            most = hn::Max(most, value);
            hn::Store(value, f, plane.v + c);
        });
    }
    if (hn::GetLane(hn::MinOfLanes(f, least)) >= background) return LeafContent::outside;
    if (hn::GetLane(hn::MaxOfLanes(f, most)) <= -background) return LeafContent::inside;
    return LeafContent::surface;
}

// Packs test(n), a vector mask for values n and up, into 8 words.
template <typename Test>
HWY_INLINE void maskOf(const Test& test, std::uint64_t* HWY_RESTRICT mask) {
    const F f;
    const std::size_t lanes = hn::Lanes(f);
    for (std::size_t word = 0; word < kColumnSamples * kLeafPlanes / 64; ++word) {
        std::uint64_t bits = 0;
        for (std::size_t n = 0; n < 64; n += lanes) {
            // Stores whole bytes, and no more than two for 16 lanes.
            std::uint8_t some[8] = {};
            hn::StoreMaskBits(f, test(word * 64 + n), some);
            bits |= static_cast<std::uint64_t>(some[0] | some[1] << 8) << n;
        }
        mask[word] = bits;
    }
}

void StoreLeaf(const LeafPlanes& phi, float* HWY_RESTRICT values) {
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t z = 0; z < kLeafPlanes; ++z)
        for (std::size_t c = 0; c < kColumnSamples; ++c) values[c * kLeafPlanes + z] = phi.plane[z].v[c];
#else
    // 4 x 4 blocks: four planes of four samples become four samples of four planes.
    const hn::FixedTag<float, 4> f4;
    for (std::size_t z = 0; z < kLeafPlanes; z += 4)
        for (std::size_t c = 0; c < kColumnSamples; c += 4) {
            const auto r0 = hn::Load(f4, phi.plane[z].v + c);
            const auto r1 = hn::Load(f4, phi.plane[z + 1].v + c);
            const auto r2 = hn::Load(f4, phi.plane[z + 2].v + c);
            const auto r3 = hn::Load(f4, phi.plane[z + 3].v + c);
            const auto a = hn::InterleaveLower(f4, r0, r2);
            const auto b = hn::InterleaveUpper(f4, r0, r2);
            const auto d = hn::InterleaveLower(f4, r1, r3);
            const auto e = hn::InterleaveUpper(f4, r1, r3);
            float* out = values + c * kLeafPlanes + z;
            hn::StoreU(hn::InterleaveLower(f4, a, d), f4, out);
            hn::StoreU(hn::InterleaveUpper(f4, a, d), f4, out + kLeafPlanes);
            hn::StoreU(hn::InterleaveLower(f4, b, e), f4, out + 2 * kLeafPlanes);
            hn::StoreU(hn::InterleaveUpper(f4, b, e), f4, out + 3 * kLeafPlanes);
        }
#endif
}

void MaskWithin(const float* HWY_RESTRICT values, float background, std::uint64_t* HWY_RESTRICT mask) {
    const F f;
    const VF high = hn::Set(f, background);
    maskOf([&](std::size_t n) HWY_ATTR { return hn::Lt(hn::Abs(hn::LoadU(f, values + n)), high); }, mask);
}

void MaskFrom(const float* HWY_RESTRICT values, float least, std::uint64_t* HWY_RESTRICT mask) {
    const F f;
    maskOf([&](std::size_t n) HWY_ATTR { return hn::Ge(hn::LoadU(f, values + n), hn::Set(f, least)); }, mask);
}

const char* KernelTarget() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace stratum::voxelize
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::voxelize {

HWY_EXPORT(MinimumOfLines);
HWY_EXPORT(MinimumOfArcs);
HWY_EXPORT(MinimumOfTapers);
HWY_EXPORT(SquaredSides);
HWY_EXPORT(MaximumOf);
HWY_EXPORT(ExpandLayers);
HWY_EXPORT(SlopedLine);
HWY_EXPORT(ExpandSloped);
HWY_EXPORT(ExpandSlopedSides);
HWY_EXPORT(ExpandRod);
HWY_EXPORT(ClampLeaf);
HWY_EXPORT(StoreLeaf);
HWY_EXPORT(MaskWithin);
HWY_EXPORT(MaskFrom);
HWY_EXPORT(KernelTarget);

ColumnGrid::ColumnGrid(float voxel) {
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        const std::size_t x = c / 8;
        const std::size_t y = c % 8;
        qx.v[c] = (static_cast<float>(x) - 3.5f) * voxel;
        qy.v[c] = (static_cast<float>(y) - 3.5f) * voxel;
    }
}

ColumnGrid ColumnGrid::spread(float voxel) {
    ColumnGrid grid(voxel);
    constexpr std::size_t kGenerator = 19;
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        grid.qx.v[c] = (static_cast<float>(c) - 27.5f) / 8 * voxel;
        grid.qy.v[c] = (static_cast<float>(c * kGenerator % kColumnSamples) - 27.5f) / 8 * voxel;
    }
    return grid;
}

void minimumOfLines(const ColumnGrid& grid, std::span<const LocalLine> lines, PlanField& d, const std::uint32_t* ids,
                    PlanOwners* owners) {
    HWY_DYNAMIC_DISPATCH(MinimumOfLines)(grid, lines, d, ids, owners);
}
void minimumOfArcs(const ColumnGrid& grid, std::span<const LocalArc> arcs, PlanField& d, const std::uint32_t* ids,
                   PlanOwners* owners) {
    HWY_DYNAMIC_DISPATCH(MinimumOfArcs)(grid, arcs, d, ids, owners);
}
void minimumOfTapers(const ColumnGrid& grid, std::span<const LocalTaper> tapers, PlanField& d, const std::uint32_t* ids,
                     PlanOwners* owners) {
    HWY_DYNAMIC_DISPATCH(MinimumOfTapers)(grid, tapers, d, ids, owners);
}
float squaredSides(const PlanField& d, PlanField& out) { return HWY_DYNAMIC_DISPATCH(SquaredSides)(d, out); }
float maximumOf(const PlanField& a, const PlanField& b, PlanField& out) {
    return HWY_DYNAMIC_DISPATCH(MaximumOf)(a, b, out);
}
void expandLayers(const LeafTerms& leaf, float background, LeafPlanes& phi) {
    HWY_DYNAMIC_DISPATCH(ExpandLayers)(leaf, background, phi);
}
void slopedLine(const ColumnGrid& grid, const LocalLine& line, float z0, float climb_per_unit, PlanField& d,
                PlanField& center_z) {
    HWY_DYNAMIC_DISPATCH(SlopedLine)(grid, line, z0, climb_per_unit, d, center_z);
}
void expandSloped(const PlanField& sides2, const PlanField& center_z, const SlopedTerm& term, float z, PlanField& phi) {
    HWY_DYNAMIC_DISPATCH(ExpandSloped)(sides2, center_z, term, z, phi);
}
void expandSlopedSides(const PlanField& d, const PlanField& center_z, const SlopedTerm& term, float z, PlanField& phi) {
    HWY_DYNAMIC_DISPATCH(ExpandSlopedSides)(d, center_z, term, z, phi);
}
void expandRod(const ColumnGrid& grid, const LocalRod& rod, float z, PlanField& phi) {
    HWY_DYNAMIC_DISPATCH(ExpandRod)(grid, rod, z, phi);
}
LeafContent clampLeaf(LeafPlanes& phi, std::size_t planes, float background) {
    return HWY_DYNAMIC_DISPATCH(ClampLeaf)(phi, planes, background);
}
void storeLeaf(const LeafPlanes& phi, float* values) { HWY_DYNAMIC_DISPATCH(StoreLeaf)(phi, values); }
void maskWithin(const float* values, float background, std::uint64_t* mask) {
    HWY_DYNAMIC_DISPATCH(MaskWithin)(values, background, mask);
}
void maskFrom(const float* values, float least, std::uint64_t* mask) {
    HWY_DYNAMIC_DISPATCH(MaskFrom)(values, least, mask);
}
const char* kernelTarget() { return HWY_DYNAMIC_DISPATCH(KernelTarget)(); }

}  // namespace stratum::voxelize
#endif  // HWY_ONCE
