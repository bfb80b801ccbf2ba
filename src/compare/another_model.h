// Whether a model is that of a print, and if not, what would fit: another unit, another size, the mirror image.
#pragma once

#include "compare/comparison.h"

#include <string>
#include <vector>

namespace stratum::compare {

/// Sentences for the user, without a capital and a full stop; none of a model that fits. It does not fit if more than
/// 5 % of one of the surfaces is farther from the other than a line's width. Then units and sizes are tried, which the
/// spread of both surfaces about their middles tells, and the mirror image; one that fits by the same rule is named.
/// What is said anyway: bodies that the file has twice, and a volume of another order of magnitude. A placement on the
/// bed is not tried.
std::vector<std::string> doubtsOf(const PrintedSurface& print, const ClosedModel& model, const Comparison& found,
                                  const CompareOptions& options);

}  // namespace stratum::compare
