#include "export/mesh/mesh_formats.h"

#include "base/error.h"
#include "export/mesh/two_materials.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <string>

namespace stratum::exporter {
namespace {

template <typename T>
T valueAt(const std::string& bytes, std::size_t offset) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof(T));
    return value;
}

class GltfFile : public testing::Test {
protected:
    // Writes the mesh and takes the file apart.
    void write(const SurfaceMesh& mesh, const MeshSpace& space) {
        writeGlb(mesh, folder_.path() / "part.glb", space);
        const std::string bytes = test::bytesOf(folder_.path() / "part.glb");
        ASSERT_GE(bytes.size(), 20U);
        EXPECT_EQ(bytes.substr(0, 4), "glTF");
        EXPECT_EQ(valueAt<std::uint32_t>(bytes, 4), 2U);
        EXPECT_EQ(valueAt<std::uint32_t>(bytes, 8), bytes.size());
        const auto head = valueAt<std::uint32_t>(bytes, 12);
        EXPECT_EQ(head % 4, 0U);
        EXPECT_EQ(bytes.substr(16, 4), "JSON");
        root_ = nlohmann::json::parse(bytes.substr(20, head));
        if (bytes.size() == 20 + head) return;
        EXPECT_EQ(bytes.substr(24 + head, 4), std::string("BIN\0", 4));
        binary_ = bytes.substr(28 + head);
        EXPECT_EQ(valueAt<std::uint32_t>(bytes, 20 + head), binary_.size());
    }
    float coordinate(std::size_t point, std::size_t axis) const {
        return valueAt<float>(binary_, 12 * point + 4 * axis);
    }

    test::ScratchFolder folder_;
    nlohmann::json root_;
    std::string binary_;
};

TEST_F(GltfFile, IsInMetresWithYUp) {
    write(test::twoMaterials(), {});
    // (2, 2, 0) mm goes to the right and away from the viewer; (1, 1, 3) is the top.
    EXPECT_FLOAT_EQ(coordinate(2, 0), 0.002F);
    EXPECT_FLOAT_EQ(coordinate(2, 1), 0.0F);
    EXPECT_FLOAT_EQ(coordinate(2, 2), -0.002F);
    EXPECT_FLOAT_EQ(coordinate(4, 1), 0.003F);
    EXPECT_EQ(root_["accessors"][0]["max"][1].get<float>(), 0.003F);
    EXPECT_EQ(root_["accessors"][0]["min"][2].get<float>(), -0.002F);
    write(test::twoMaterials(), {1000, true});
    EXPECT_FLOAT_EQ(coordinate(4, 2), 3.0F);  // as it was
}

TEST_F(GltfFile, APrimitiveAMaterial) {
    write(test::twoMaterials(), {});
    const auto& primitives = root_["meshes"][0]["primitives"];
    ASSERT_EQ(primitives.size(), 2U);
    EXPECT_EQ(root_["accessors"][1]["count"], 6);
    EXPECT_EQ(root_["accessors"][2]["count"], 12);
    EXPECT_EQ(primitives[1]["material"], 1);
    const auto& orange = root_["materials"][0]["pbrMetallicRoughness"];
    EXPECT_NEAR(orange["baseColorFactor"][1].get<double>(), 0.2158605, 1e-6);  // linear
    EXPECT_EQ(orange["metallicFactor"], 0.0);
    // The first triangle of the first group, behind the points.
    EXPECT_EQ(valueAt<std::uint32_t>(binary_, 60), 2U);
    EXPECT_EQ(valueAt<std::uint32_t>(binary_, 64), 3U);
    EXPECT_EQ(valueAt<std::uint32_t>(binary_, 68), 4U);
    EXPECT_EQ(binary_.size(), 60U + 6U * 12U);
}

TEST_F(GltfFile, OfNothingIsAFileWithoutAMesh) {
    write({}, {});
    EXPECT_FALSE(root_.contains("meshes"));
    EXPECT_TRUE(binary_.empty());
}

TEST(GlbSize, FourGibibytesAreTheLimit) {
    const std::size_t most = (std::size_t{1} << 32U) / 12;
    EXPECT_NO_THROW(requireGlbSize(1000, most - 2000000, "part.glb"));
    EXPECT_THROW(requireGlbSize(1000, most, "part.glb"), UsageError);
    EXPECT_THROW(requireGlbSize(most, 12, "part.glb"), UsageError);
}

}  // namespace
}  // namespace stratum::exporter
