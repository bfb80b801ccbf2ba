// stratum.LevelSet, stratum.PrintField and stratum.Intersector: what is sampled and traced.
#pragma once

#include "march/attribute/attribute_grid.h"
#include "ondemand/point_distance.h"
#include "ondemand/print_field.h"
#include "trace/attribute.h"
#include "trace/intersector.h"

#include <openvdb/openvdb.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <vector>

namespace stratum::python {

/// Grids in memory. Never changes, so that any number of threads read it without the GIL.
struct LevelSetObject {
    openvdb::GridPtrVec grids;  ///< the surface first, then its attributes; their trees are only read

    const openvdb::FloatGrid& surface() const { return static_cast<const openvdb::FloatGrid&>(*grids.front()); }
    /// Throws UsageError, with the names that there are.
    openvdb::GridBase::ConstPtr attribute(const std::string& name) const;
};

/// A print that is evaluated where it is asked. Never changes.
struct PrintFieldObject {
    std::shared_ptr<const ondemand::PrintField> field;
};

/// Rays through one of them, or a file. Never changes.
struct IntersectorObject {
    std::shared_ptr<const trace::Intersector> intersector;
    std::vector<std::string> attributes;  ///< names, by number
    std::vector<trace::AttributeSummary::Kind> kinds;
    pybind11::object source;  ///< what it reads from
};

void bindLevelSet(pybind11::module_& module);
void bindPrintField(pybind11::module_& module);
void bindIntersector(pybind11::module_& module);

/// The type of an attribute grid's values. Throws InputError for others.
trace::AttributeSummary::Kind kindOf(const openvdb::GridBase& grid);

/// The values of an attribute at points, world space: int32 with -1 where there is none, float32 with NaN, or colors
/// (N, 3) with NaN.
pybind11::array lookUp(const march::AttributeSource& source, trace::AttributeSummary::Kind kind,
                       const pybind11::object& points);

}  // namespace stratum::python
