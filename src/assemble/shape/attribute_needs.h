// The attributes that shading needs, and the files that they are read from.
#pragma once

#include "assemble/file/object_file.h"

#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace stratum::assemble {

/// Collected over all objects before the first file is read: objects of one file and grid share what is read. Not for
/// shapes by formula, which have no attributes.
class AttributeNeeds {
public:
    /// The number of that attribute for Tracer::attribute(); the next free one if it has none yet.
    std::size_t number(const std::string& name);
    /// Names by number.
    const std::vector<std::string>& names() const { return names_; }

    /// The object's file must have that attribute.
    void add(const ObjectOptions& object, const std::string& name);
    bool contains(const ObjectOptions& object, const std::string& name) const;

    /// The object has the colors that its file states, if it states some.
    void addStatedColors(const ObjectOptions& object);
    bool needsStatedColors(const ObjectOptions& object) const;

    /// The object's material needs to know along which direction its beads were laid.
    void addGrain(const ObjectOptions& object) { grain_.insert(fileOf(object)); }
    bool needsGrain(const ObjectOptions& object) const { return grain_.contains(fileOf(object)); }

private:
    using File = std::pair<std::string, std::string>;  // path, grid
    static File fileOf(const ObjectOptions& object) { return {object.vdb, object.grid}; }

    std::vector<std::string> names_;
    std::set<std::pair<File, std::string>> needed_;
    std::set<File> stated_colors_;
    std::set<File> grain_;
};

}  // namespace stratum::assemble
