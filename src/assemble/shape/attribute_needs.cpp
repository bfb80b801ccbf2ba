#include "assemble/shape/attribute_needs.h"

#include <algorithm>

namespace stratum::assemble {

std::size_t AttributeNeeds::number(const std::string& name) {
    const auto found = std::find(names_.begin(), names_.end(), name);
    const auto number = static_cast<std::size_t>(found - names_.begin());
    if (found == names_.end()) names_.push_back(name);
    return number;
}

void AttributeNeeds::add(const ObjectOptions& object, const std::string& name) {
    needed_.emplace(fileOf(object), name);
}

bool AttributeNeeds::contains(const ObjectOptions& object, const std::string& name) const {
    return needed_.contains({fileOf(object), name});
}

void AttributeNeeds::addStatedColors(const ObjectOptions& object) { stated_colors_.insert(fileOf(object)); }

bool AttributeNeeds::needsStatedColors(const ObjectOptions& object) const {
    return stated_colors_.contains(fileOf(object));
}

}  // namespace stratum::assemble
