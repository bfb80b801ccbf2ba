#include "export/parts/merge_prints.h"

#include "base/checksum.h"
#include "base/error.h"
#include "base/part_set.h"
#include "export/parts/part_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <fstream>
#include <string>
#include <utility>

namespace stratum::exporter {
namespace {

constexpr std::size_t kCopied = std::size_t{1} << 20;  // bytes at once, which the cache of a core holds

// Why two parts can't be of one print; empty if they can.
std::string differenceOf(const PartFile& one, const PartFile& other) {
    if (one.part.version != other.part.version)
        return fmt::format("made by version {}, not {}", one.part.version, other.part.version);
    if (one.part.shard.count != other.part.shard.count)
        return fmt::format("one of {} shards, not of {}", one.part.shard.count, other.part.shard.count);
    if (one.part.scene != other.part.scene) return "of another scene: the input files or the options differ";
    const auto voxel = [](const PartFile& file) { return file.grid->metaValue<double>("voxel_size_mm"); };
    if (voxel(one) != voxel(other))
        return fmt::format(
            "of voxels of {:g} mm, not of {:g} mm; give all --voxel-size, as the default minds free memory", voxel(one),
            voxel(other));
    if (static_cast<const openvdb::MetaMap&>(*one.grid) != static_cast<const openvdb::MetaMap&>(*other.grid) ||
        one.grid->transform() != other.grid->transform() || one.grid->background() != other.grid->background() ||
        one.format.compression != other.format.compression ||
        one.part.print.upper_nodes != other.part.print.upper_nodes)
        return "of another print of the same scene";
    return {};
}

// What all parts together have at most. Throws InputError if they leave blocks out, or share them.
voxelize::NodeBounds boundsOf(const std::vector<PartFile>& parts) {
    voxelize::NodeBounds print = parts.front().part.print;
    print.leaves = print.lower_nodes = 0;
    std::size_t next = 0;  // block
    std::vector<std::string> problems;
    for (const PartFile& file : parts) {
        if (file.part.blocks.first != next)
            problems.push_back(
                fmt::format("{}: begins with block {}, but the shards before it end before block {}; make all on "
                            "machines of one kind",
                            file.path.string(), file.part.blocks.first, next));
        next = file.part.blocks.end;
        print.leaves += file.part.print.leaves;
        print.lower_nodes += file.part.print.lower_nodes;
    }
    print.upper_nodes = std::min(print.upper_nodes, print.lower_nodes);
    if (!problems.empty()) refuseParts(std::move(problems));
    return print;
}

void appendPart(const PartFile& part, LevelSetOutput& output) {
    std::size_t leaf = 0;
    for (LowerNode& node : nodesOf(part)) {
        for (std::size_t n = 0; n < node.leaves.size(); ++n) output.add(leafOf(part, leaf++));
        output.add(std::move(node));
    }
    if (leaf > 0) output.count(part.statistics.active_voxels, part.statistics.active_box);
    std::ifstream leaves(part.path, std::ios::binary);
    leaves.seekg(static_cast<std::streamoff>(part.places.leaves));
    std::vector<char> bytes(kCopied);
    std::uint32_t checksum = 0;
    for (std::uint64_t left = part.places.end - part.places.leaves; left > 0;) {
        const std::size_t count = std::min<std::uint64_t>(left, bytes.size());
        if (!leaves.read(bytes.data(), static_cast<std::streamsize>(count)))
            throw InputError(damageOf(part.path, "it ends early"));
        checksum = checksumOf({bytes.data(), count}, checksum);
        iovec piece{bytes.data(), count};
        output.append({&piece, 1});
        left -= count;
    }
    if (checksum != part.part.checksum) throw InputError(damageOf(part.path, "the checksum of its leaves is wrong"));
}

}  // namespace

MergedPrint mergePrint(const std::filesystem::path& path, const std::vector<std::filesystem::path>& paths) {
    const auto parts = wholeSet<PartFile>(
        paths, readPartFile, [](const PartFile& file) { return file.part.shard; }, differenceOf, "make it with");
    const PartFile& any = parts.front();
    LevelSetOutput output(any.grid, path, any.format.compression, boundsOf(parts));
    std::vector<std::string> problems;
    for (const PartFile& part : parts) {
        try {
            appendPart(part, output);
        } catch (const OutputError&) {
            throw;
        } catch (const InputError& error) {
            problems.emplace_back(error.what());
        } catch (const std::exception& error) {
            // OpenVDB throws its own kinds, and those of the standard library for impossible counts.
            problems.push_back(damageOf(part.path, error.what()));
        }
    }
    if (!problems.empty()) refuseParts(std::move(problems));
    return {output.finish(), static_cast<int>(parts.size())};
}

}  // namespace stratum::exporter
