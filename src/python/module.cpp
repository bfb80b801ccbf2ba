// The Python module stratum._stratum: the package stratum takes everything from it.
#include "python/bare_objects.h"
#include "python/bindings.h"
#include "python/errors.h"
#include "python/level_set_object.h"
#include "python/threads.h"
#include "python/toolpath_object.h"

#include "base/atomic_file.h"

#include <openvdb/openvdb.h>
#include <pybind11/pybind11.h>

PYBIND11_MODULE(_stratum, module) {
    using namespace stratum::python;
    // Docstrings begin with signatures of their own: documented().
    pybind11::options docstrings;
    docstrings.disable_function_signatures();
    module.attr("__version__") = STRATUM_VERSION;
    openvdb::initialize();
    stratum::Replacement::guard(true);
    bindErrors(module);
    bindToolpath(module);
    bindLevelSet(module);
    bindMeasures(module);
    bindPrintField(module);
    bindIntersector(module);
    bindPicture(module);
    bindThreads(module);
    refuseBareObjects(module);
}
