#include "export/mesh/mesh_formats.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/own_file.h"
#include "gcode/toolpath/color.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::exporter {
namespace {

constexpr std::string_view kContentTypes =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
    "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
constexpr std::string_view kRelationships =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
    "<Relationship Id=\"model\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\" "
    "Target=\"/3D/3dmodel.model\"/></Relationships>\n";

constexpr const char* kModel = "3D/3dmodel.model";

const char* unitName(double mm) { return mm > 500 ? "meter" : mm > 5 ? "centimeter" : "millimeter"; }

/// The XML of the model, made piece by piece, as often as it is asked for.
class ModelText {
public:
    ModelText(const SurfaceMesh& mesh, const MeshSpace& space) : mesh_(mesh), space_(space) { rewind(); }

    void rewind() {
        stage_ = Stage::head;
        next_ = 0;
        piece_.clear();
        read_ = 0;
    }
    /// Fills as much of the bytes as there is text; 0 at its end.
    std::size_t read(char* to, std::size_t size) {
        std::size_t done = 0;
        while (done < size) {
            if (read_ == piece_.size() && !makePiece()) break;
            const std::size_t count = std::min(size - done, piece_.size() - read_);
            std::memcpy(to + done, piece_.data() + read_, count);
            done += count;
            read_ += count;
        }
        return done;
    }
    /// Without keeping it.
    std::uint64_t length() {
        rewind();
        std::uint64_t bytes = 0;
        while (makePiece()) bytes += piece_.size();
        rewind();
        return bytes;
    }

private:
    enum class Stage { head, points, between, triangles, tail, end };
    static constexpr std::size_t kItems = 8192;  // in a piece

    template <typename... Args>
    void add(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(piece_), format, std::forward<Args>(args)...);
    }

    bool makePiece() {
        piece_.clear();
        read_ = 0;
        switch (stage_) {
            case Stage::head:
                addHead();
                stage_ = Stage::points;
                return true;
            case Stage::points:
                addPoints();
                if (next_ == mesh_.points.size()) stage_ = Stage::between;
                return true;
            case Stage::between:
                add("</vertices><triangles>\n");
                stage_ = Stage::triangles;
                next_ = 0;
                return true;
            case Stage::triangles:
                addTriangles();
                if (next_ == mesh_.faces.size()) stage_ = Stage::tail;
                return true;
            case Stage::tail:
                add("</triangles></mesh></object></resources><build><item objectid=\"2\"/></build></model>\n");
                stage_ = Stage::end;
                return true;
            case Stage::end:
                break;
        }
        return false;
    }

    void addHead() {
        add("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"{}\" xml:lang=\"en-US\" "
            "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">"
            "<metadata name=\"Application\">Stratum {}</metadata><resources>\n",
            unitName(space_.mm_per_unit), STRATUM_VERSION);
        if (!mesh_.materials.empty()) {
            add("<basematerials id=\"1\">");
            for (const MeshMaterial& m : mesh_.materials)
                add("<base name=\"{}\" displaycolor=\"{}\"/>", m.name, gcode::colorText(m.color));
            add("</basematerials>\n");
        }
        add("<object id=\"2\" type=\"model\"{}><mesh><vertices>\n",
            mesh_.materials.empty() ? "" : " pid=\"1\" pindex=\"0\"");
    }

    void addPoints() {
        const std::size_t end = std::min(next_ + kItems, mesh_.points.size());
        for (; next_ < end; ++next_) {
            const openvdb::Vec3s p(space_.upZ(openvdb::Vec3d(mesh_.points[next_])));
            add("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", p[0], p[1], p[2]);
        }
    }

    void addTriangles() {
        const std::size_t end = std::min(next_ + kItems, mesh_.faces.size());
        for (; next_ < end; ++next_) {
            const SurfaceMesh::Face& face = mesh_.faces[next_];
            // The object's own is the first.
            const std::uint32_t material = mesh_.material_of_point.empty() ? 0 : mesh_.materialOf(face);
            addTriangle(face[0], face[1], face[2], material);
            if (face[3] != SurfaceMesh::kNone) addTriangle(face[0], face[2], face[3], material);
        }
    }

    void addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material) {
        add("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"", a, b, c);
        if (material != 0) add(" pid=\"1\" p1=\"{}\"", material);
        add("/>\n");
    }

    const SurfaceMesh& mesh_;
    const MeshSpace& space_;
    Stage stage_ = Stage::head;
    std::size_t next_ = 0;
    std::string piece_;
    std::size_t read_ = 0;
};

/// What libzip reads the model from.
struct ModelSource {
    ModelText text;
    std::uint64_t bytes;  // known before, because an entry of unknown size would be ZIP64, which not all readers know
};

zip_int64_t answer(void* of, void* data, zip_uint64_t size, zip_source_cmd_t command) {
    auto& source = *static_cast<ModelSource*>(of);
    switch (command) {
        case ZIP_SOURCE_OPEN:
            source.text.rewind();
            return 0;
        case ZIP_SOURCE_READ:
            return static_cast<zip_int64_t>(source.text.read(static_cast<char*>(data), size));
        case ZIP_SOURCE_STAT: {
            auto* stat = static_cast<zip_stat_t*>(data);
            zip_stat_init(stat);
            stat->size = source.bytes;
            stat->valid |= ZIP_STAT_SIZE;
            return sizeof(*stat);
        }
        case ZIP_SOURCE_ERROR: {
            zip_error_t none;
            zip_error_init(&none);
            return zip_error_to_data(&none, data, size);
        }
        case ZIP_SOURCE_SUPPORTS:
            return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE, ZIP_SOURCE_STAT,
                                                  ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, -1);
        default:
            return 0;
    }
}

struct Closing {
    void operator()(zip_t* archive) const { zip_discard(archive); }
    void operator()(zip_source_t* source) const { zip_source_free(source); }
};
using Archive = std::unique_ptr<zip_t, Closing>;
using Source = std::unique_ptr<zip_source_t, Closing>;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& why) {
    throw OutputError(fmt::format("{}: the 3MF can't be made: {}", path.string(), why));
}

void addEntry(zip_t* archive, const char* name, zip_source_t* content, const std::filesystem::path& path) {
    constexpr zip_uint32_t kLevel = 3;                 // libzip's own, 9, takes several times as long for little
    constexpr zip_uint16_t kFirstDay = 1U << 5U | 1U;  // 1980-01-01: files must not tell the time
    if (content == nullptr) fail(path, zip_strerror(archive));
    const zip_int64_t entry = zip_file_add(archive, name, content, ZIP_FL_ENC_UTF_8);
    if (entry < 0) {
        zip_source_free(content);
        fail(path, zip_strerror(archive));
    }
    const auto index = static_cast<zip_uint64_t>(entry);
    if (zip_file_set_dostime(archive, index, 0, kFirstDay, 0) != 0 ||
        zip_set_file_compression(archive, index, ZIP_CM_DEFLATE, kLevel) != 0)
        fail(path, zip_strerror(archive));
}

// The archive's bytes.
Source pack(ModelSource& model, const std::filesystem::path& path) {
    zip_error_t error;
    zip_error_init(&error);
    Source packed(zip_source_buffer_create(nullptr, 0, 0, &error));
    if (!packed) fail(path, zip_error_strerror(&error));
    zip_source_keep(packed.get());
    Archive archive(zip_open_from_source(packed.get(), ZIP_CREATE | ZIP_TRUNCATE, &error));
    if (!archive) {
        zip_source_free(packed.get());
        fail(path, zip_error_strerror(&error));
    }
    const auto add = [&](const char* name, std::string_view text) {
        addEntry(archive.get(), name, zip_source_buffer(archive.get(), text.data(), text.size(), 0), path);
    };
    add("[Content_Types].xml", kContentTypes);
    add("_rels/.rels", kRelationships);
    addEntry(archive.get(), kModel, zip_source_function(archive.get(), answer, &model), path);
    // Where it can be read without unpacking: see isOwnFile().
    const std::string mark = fmt::format("by {}", kProgramMark);
    (void)zip_set_archive_comment(archive.get(), mark.data(), static_cast<zip_uint16_t>(mark.size()));
    if (zip_close(archive.get()) != 0) fail(path, zip_strerror(archive.get()));
    (void)archive.release();
    return packed;
}

}  // namespace

void write3mf(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space) {
    constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
    if (mesh.triangleCount() > kMost || mesh.points.size() > kMost)
        throw UsageError(fmt::format("{}: {} triangles are more than 3MF can count; choose a larger voxel",
                                     path.string(), mesh.triangleCount()));
    FileWriter out(path);
    ModelSource model{ModelText(mesh, space), 0};
    model.bytes = model.text.length();
    const Source packed = pack(model, path);
    std::vector<char> bytes(std::size_t{1} << 20);
    if (zip_source_open(packed.get()) != 0) fail(path, "its bytes can't be read back");
    for (;;) {
        const zip_int64_t count = zip_source_read(packed.get(), bytes.data(), bytes.size());
        if (count < 0) fail(path, "its bytes can't be read back");
        if (count == 0) break;
        out.text({bytes.data(), static_cast<std::size_t>(count)});
    }
    zip_source_close(packed.get());
    out.commit();
}

}  // namespace stratum::exporter
