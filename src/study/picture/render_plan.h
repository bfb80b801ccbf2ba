// What `vdbstudy render` compares: ways to make one picture, and the references they are held against.
#pragma once

#include "study/picture/picture_subject.h"

#include <string>
#include <vector>

namespace stratum::study {

/// A way to make the picture.
struct Variant {
    std::string name;
    PictureKind kind;
    std::string reference;  ///< the name of one
    bool apart = false;     ///< samples that know nothing of each other
    bool denoised = false;
    int least_spp = 1;
    int most_spp = 1 << 30;
    int only_spp = 0;  ///< above 0: this number alone, whatever the others have
};

/// A picture with many samples.
struct Reference {
    std::string name;
    PictureKind kind;
};

struct RenderPlan {
    std::vector<int> per_layer;  ///< voxel sizes, ascending
    int base = 2;                ///< the middle one: of all comparisons but that of the sizes
    std::vector<int> spp;
    std::vector<Reference> references;
    std::vector<Variant> variants;

    /// Throws UsageError if there is none of that name.
    const Reference& referenceNamed(const std::string& name) const;
    const Variant& variantNamed(const std::string& name) const;
};

/// Pixels of the pictures; they are three quarters as high.
constexpr int pictureWidth(bool quick) { return quick ? 48 : 200; }

/// The name of the picture that vdbtrace makes when nobody asks for samples or denoising.
inline constexpr const char* kDefaultPicture = "default picture";

/// @param per_layer  voxels a layer; empty: 1, 2, 4, 8, or 1, 2 if quick
RenderPlan makePlan(std::vector<int> per_layer, bool quick);

/// The name of the path-traced reference of this voxel size.
std::string ofSize(int per_layer);

}  // namespace stratum::study
