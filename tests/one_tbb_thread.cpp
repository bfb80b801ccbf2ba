// Linked into tests under ThreadSanitizer. OpenVDB's own passes run on Debian's TBB, which is not built for that tool:
// with one TBB thread they run in their caller. The project's loops use plain threads there (src/parallel).
#include <tbb/global_control.h>

namespace {
const tbb::global_control g_one_thread(tbb::global_control::max_allowed_parallelism, 1);
}
