// The unit of a model file's numbers.
#pragma once

#include <filesystem>

namespace stratum::compare {

/// mm a unit. A .3mf states it (the attribute `unit` of its model; without one it is millimetres, as 3MF has it); .stl
/// and .obj have none, and are taken as mm. Throws InputError for a unit that 3MF does not have.
double unitOfModel(const std::filesystem::path& path);

}  // namespace stratum::compare
