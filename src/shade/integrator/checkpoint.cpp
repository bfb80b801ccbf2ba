#include "shade/integrator/checkpoint.h"

#include "base/atomic_file.h"
#include "base/checksum.h"
#include "base/error.h"
#include "base/input_file.h"

#include <fmt/format.h>

#include <cstring>
#include <type_traits>

namespace stratum::shade {
namespace {

constexpr std::string_view kMagic = "stratum checkpoint 1\n";

/// Goes through all that a file holds, in its order: for writing and for reading.
template <typename State, typename Block>
void eachBlock(State& state, const Block& block) {
    block(state.done);
    block(state.film.pixels());
    for (auto& layer : state.film.layers()) block(layer.values);
}

/// Numbers of a state beside its blocks.
struct Totals {
    RayCounts rays;
    std::uint64_t samples;
};
static_assert(std::is_trivially_copyable_v<Totals> && std::is_trivially_copyable_v<Pixel>);

}  // namespace

Checkpoint::Checkpoint(std::filesystem::path path, std::string identity)
    : path_(std::move(path)), identity_(std::move(identity) + "\n") {}

bool Checkpoint::read(RenderState& state) const {
    if (!std::filesystem::exists(path_)) return false;
    const InputFile file(path_);
    std::string_view bytes = file.bytes();
    const auto refuse = [&](const char* why) {
        throw InputError(
            fmt::format("{}: {}; name another file for --checkpoint, or remove this one", path_.string(), why));
    };
    if (!bytes.starts_with(kMagic)) refuse("is no checkpoint of a render");
    std::uint32_t crc = 0;
    if (bytes.size() < kMagic.size() + sizeof crc) refuse("is a damaged checkpoint (cut off)");
    std::memcpy(&crc, bytes.data() + bytes.size() - sizeof crc, sizeof crc);
    bytes.remove_suffix(sizeof crc);
    if (crc != checksumOf(bytes)) refuse("is a damaged checkpoint (its checksum is wrong)");
    bytes.remove_prefix(kMagic.size());
    if (!bytes.starts_with(identity_))
        refuse("is a checkpoint of another picture: the print, the scene, the seed or the options differ");
    bytes.remove_prefix(identity_.size());
    std::size_t expected = sizeof(Totals);
    eachBlock(state, [&](const auto& block) { expected += block.size() * sizeof block[0]; });
    if (bytes.size() != expected) refuse("is a checkpoint of another picture: its size differs");
    Totals totals;
    std::memcpy(&totals, bytes.data(), sizeof totals);
    bytes.remove_prefix(sizeof totals);
    state.rays = totals.rays;
    state.samples = totals.samples;
    eachBlock(state, [&](auto& block) {
        std::memcpy(block.data(), bytes.data(), block.size() * sizeof block[0]);
        bytes.remove_prefix(block.size() * sizeof block[0]);
    });
    return true;
}

std::string Checkpoint::bytesOf(const RenderState& state) const {
    std::string bytes(kMagic);
    bytes += identity_;
    const auto append = [&bytes](const void* data, std::size_t size) {
        bytes.append(static_cast<const char*>(data), size);
    };
    const Totals totals{state.rays, state.samples};
    append(&totals, sizeof totals);
    eachBlock(state, [&](const auto& block) { append(block.data(), block.size() * sizeof block[0]); });
    const std::uint32_t crc = checksumOf(bytes);
    append(&crc, sizeof crc);
    return bytes;
}

void Checkpoint::write(const std::string& bytes) const { writeFile(path_, bytes); }

}  // namespace stratum::shade
