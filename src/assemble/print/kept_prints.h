// Prints that were read and made ready for rays, kept for the next scene of the same files: another selection of layers
// is not parsed anew, and other colors keep the bricks that are laid out.
#pragma once

#include "assemble/print/lazy_print.h"
#include "assemble/print/print_levels.h"
#include "trace/intersector.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace stratum::assemble {

/// A selection of a print that rays can be traced through.
struct TracedPrint {
    PrintLevels print;
    std::vector<std::shared_ptr<const trace::Intersector>> shapes;  ///< by level, without attributes
    std::shared_ptr<LazyPrint> lazy;
};

/// For requests that differ in what they select of a file and in whether they need times, and in nothing else. Programs
/// are kept until forget(), selections as long as somebody uses them. For one thread at a time.
class KeptPrints {
public:
    /// The program of that file; null if it was not read yet, or without what is needed of it.
    const ReadProgram* program(const std::string& path, bool timed, bool hash) const;
    void keep(const std::string& path, ReadProgram program);

    /// The selection of a request; null if nobody uses it any more.
    std::shared_ptr<TracedPrint> print(const std::string& path, const PrintRequest& request, bool timed) const;
    void keep(const std::string& path, const PrintRequest& request, const std::shared_ptr<TracedPrint>& print);

    /// For a file that has changed.
    void forget();

private:
    std::map<std::string, ReadProgram> programs_;  // by path
    std::map<std::string, std::weak_ptr<TracedPrint>> prints_;
};

}  // namespace stratum::assemble
