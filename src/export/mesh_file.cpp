#include "export/mesh_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

namespace stratum::exporter {
namespace {

static_assert(std::endian::native == std::endian::little, "STL and PLY are written as the machine holds numbers");

std::string extensionOf(const std::filesystem::path& path) { return lowerCase(path.extension().string()); }

// Buffers bytes and writes a megabyte at a time.
class Writer {
public:
    explicit Writer(std::ofstream& out) : out_(out) { buffer_.reserve(kChunk + 4096); }
    void text(std::string_view text) {
        buffer_.append(text);
        if (buffer_.size() >= kChunk) flush();
    }
    template <typename T>
    void raw(const T& value) {
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        text({bytes, sizeof(T)});
    }
    void flush() {
        out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        buffer_.clear();
    }

private:
    static constexpr std::size_t kChunk = 1 << 20;
    std::ofstream& out_;
    std::string buffer_;
};

void writeStl(const SurfaceMesh& mesh, Writer& out) {
    std::array<char, 80> header{};
    fmt::format_to_n(header.data(), header.size() - 1, "binary STL by Stratum {}", STRATUM_VERSION);
    out.raw(header);
    out.raw(static_cast<std::uint32_t>(mesh.triangleCount()));
    mesh.forEachTriangle([&](std::uint32_t ia, std::uint32_t ib, std::uint32_t ic) {
        const openvdb::Vec3s& a = mesh.points[ia];
        const openvdb::Vec3s& b = mesh.points[ib];
        const openvdb::Vec3s& c = mesh.points[ic];
        openvdb::Vec3s normal = (b - a).cross(c - a);
        // A triangle without area has no normal; with zeros the reader computes its own.
        if (!normal.normalize()) normal = openvdb::Vec3s(0);
        for (const openvdb::Vec3s& v : {normal, a, b, c})
            for (int axis = 0; axis < 3; ++axis) out.raw(v[axis]);
        out.raw(std::uint16_t{0});
    });
}

std::size_t cornersOf(const SurfaceMesh::Face& face) { return face[3] == SurfaceMesh::kNone ? 3 : 4; }

void writePly(const SurfaceMesh& mesh, Writer& out) {
    out.text(
        fmt::format("ply\nformat binary_little_endian 1.0\ncomment by Stratum {}\nelement vertex {}\nproperty float x\n"
                    "property float y\nproperty float z\n{}element face {}\nproperty list uchar uint vertex_indices\n"
                    "end_header\n",
                    STRATUM_VERSION, mesh.points.size(),
                    mesh.colors.empty() ? "" : "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                    mesh.faces.size()));
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        for (int axis = 0; axis < 3; ++axis) out.raw(mesh.points[n][axis]);
        if (!mesh.colors.empty()) out.raw(mesh.colors[n]);
    }
    for (const SurfaceMesh::Face& face : mesh.faces) {
        out.raw(static_cast<std::uint8_t>(cornersOf(face)));
        for (std::size_t n = 0; n < cornersOf(face); ++n) out.raw(face[n]);
    }
}

void writeObj(const SurfaceMesh& mesh, Writer& out) {
    out.text(fmt::format("# by Stratum {}\n", STRATUM_VERSION));
    for (const openvdb::Vec3s& p : mesh.points) out.text(fmt::format("v {} {} {}\n", p[0], p[1], p[2]));
    // Counted from 1.
    for (const SurfaceMesh::Face& face : mesh.faces) {
        out.text(fmt::format("f {} {} {}", face[0] + 1, face[1] + 1, face[2] + 1));
        out.text(cornersOf(face) == 4 ? fmt::format(" {}\n", face[3] + 1) : "\n");
    }
}

}  // namespace

bool isMeshPath(const std::filesystem::path& path) {
    const std::string extension = extensionOf(path);
    return extension == ".stl" || extension == ".ply" || extension == ".obj";
}

bool meshHasColors(const std::filesystem::path& path) { return extensionOf(path) == ".ply"; }

void writeMesh(const SurfaceMesh& mesh, const std::filesystem::path& path) {
    AtomicFile file(path);
    if (mesh.triangleCount() > std::numeric_limits<std::uint32_t>::max())
        throw UsageError(fmt::format("{}: {} triangles are more than the format can count; choose a larger voxel",
                                     path.string(), mesh.triangleCount()));
    std::ofstream stream(file.temporary(), std::ios::binary);
    Writer out(stream);
    const std::string extension = extensionOf(path);
    if (extension == ".stl")
        writeStl(mesh, out);
    else if (extension == ".ply")
        writePly(mesh, out);
    else
        writeObj(mesh, out);
    out.flush();
    stream.close();
    if (!stream) throw writeError(path.string());
    file.commit();
}

}  // namespace stratum::exporter
