// Which attributes hits are to know, and of which files they are read.
#pragma once

#include "assemble/object_file.h"

#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace stratum::assemble {

/// Collected over all objects before the first file is read: objects of the same file share what is read of it. Objects
/// are told apart by file and grid; not for shapes by formula, which have no attributes.
class AttributeNeeds {
public:
    /// The number of that attribute for Tracer::attribute(); the next free one if it has none yet.
    std::size_t number(const std::string& name);
    /// Names by number.
    const std::vector<std::string>& names() const { return names_; }

    /// The object's file must have that attribute.
    void want(const ObjectOptions& object, const std::string& name);
    bool wanted(const ObjectOptions& object, const std::string& name) const;

    /// The object has the colours that its file states, if it states some.
    void wantStatedColors(const ObjectOptions& object);
    bool statedColorsWanted(const ObjectOptions& object) const;

private:
    using File = std::pair<std::string, std::string>;  // path, grid
    static File fileOf(const ObjectOptions& object) { return {object.vdb, object.grid}; }

    std::vector<std::string> names_;
    std::set<std::pair<File, std::string>> wanted_;
    std::set<File> stated_colors_;
};

}  // namespace stratum::assemble
