// The parts of two .vdb files that must be the same bytes.
#pragma once

#include <gtest/gtest.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace stratum::test {

/// Writes grids as OpenVDB does.
class OpenVdbArchive : public openvdb::io::Archive {
public:
    static void writeFile(const openvdb::GridPtrVec& grids, const std::filesystem::path& path,
                          std::uint32_t compression) {
        OpenVdbArchive archive;
        archive.setCompression(compression);
        std::ofstream stream(path, std::ios::binary);
        archive.write(stream, grids, true);
    }
};

/// Bytes of the leaves of each grid, and all bytes between its metadata and them: its transform and its topology.
inline std::vector<std::string> treesOf(const std::filesystem::path& path) {
    std::vector<std::string> trees;
    std::ifstream stream(path, std::ios::binary);
    const auto head = [&] {
        char skipped[8 + 4 + 8 + 1 + 36];
        stream.read(skipped, sizeof skipped);
        openvdb::io::setCurrentVersion(stream);
        openvdb::MetaMap meta;
        meta.readMeta(stream);
        std::int32_t grids = 0;
        stream.read(reinterpret_cast<char*>(&grids), sizeof grids);
        return grids;
    };
    const int grids = head();
    for (int n = 0; n < grids; ++n) {
        openvdb::io::GridDescriptor descriptor;
        descriptor.read(stream);
        std::uint32_t compression = 0;
        stream.read(reinterpret_cast<char*>(&compression), sizeof compression);
        openvdb::MetaMap meta;
        meta.readMeta(stream);
        const auto from = static_cast<std::int64_t>(stream.tellg());
        std::string tree(static_cast<std::size_t>(descriptor.getEndPos() - from), '\0');
        stream.read(tree.data(), static_cast<std::streamsize>(tree.size()));
        trees.push_back(tree);
    }
    EXPECT_TRUE(stream.good());
    EXPECT_EQ(stream.peek(), std::char_traits<char>::eof());
    return trees;
}

inline openvdb::GridPtrVecPtr readAll(const std::filesystem::path& path, bool delayed = false) {
    openvdb::io::File file(path.string());
    file.open(delayed);
    return file.getGrids();
}

/// All metadata, as text.
inline std::string metadataOf(const openvdb::GridBase& grid) {
    std::string text;
    for (auto meta = grid.beginMeta(); meta != grid.endMeta(); ++meta)
        text += meta->first + "=" + meta->second->typeName() + ":" + meta->second->str() + "\n";
    return text;
}

/// The trees have the same bytes, and OpenVDB reads the same metadata.
inline void expectSameContents(const std::filesystem::path& a, const std::filesystem::path& b) {
    const std::vector<std::string> ours = treesOf(a);
    const std::vector<std::string> theirs = treesOf(b);
    ASSERT_EQ(ours.size(), theirs.size());
    for (std::size_t n = 0; n < ours.size(); ++n)
        EXPECT_TRUE(ours[n] == theirs[n])
            << "grid " << n << ", " << ours[n].size() << " and " << theirs[n].size() << " bytes, different from "
            << std::mismatch(ours[n].begin(), ours[n].end(), theirs[n].begin(), theirs[n].end()).first -
                   ours[n].begin();
    const auto my_grids = readAll(a);
    const auto grids = readAll(b);
    for (std::size_t n = 0; n < grids->size(); ++n) EXPECT_EQ(metadataOf(*(*my_grids)[n]), metadataOf(*(*grids)[n]));
}

}  // namespace stratum::test
