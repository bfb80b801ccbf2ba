#include "assemble/print/kept_prints.h"

#include <fmt/format.h>

#include <iterator>
#include <utility>

namespace stratum::assemble {
namespace {

// What selections of one file differ in.
std::string keyOf(const std::string& path, const PrintRequest& request) {
    return fmt::format("{}\n{}\n{}", path, voxelize::describeSelection(request.print), request.printed);
}

}  // namespace

const ReadProgram* KeptPrints::program(const std::string& path, bool timed, bool hash) const {
    const auto found = programs_.find(path);
    if (found == programs_.end()) return nullptr;
    const ReadProgram& program = found->second;
    if ((timed && program.toolpath->timing.empty()) || (hash && program.content.empty())) return nullptr;
    return &program;
}

void KeptPrints::keep(const std::string& path, ReadProgram program) {
    programs_.insert_or_assign(path, std::move(program));
}

std::shared_ptr<TracedPrint> KeptPrints::print(const std::string& path, const PrintRequest& request, bool timed) const {
    const auto found = prints_.find(keyOf(path, request));
    auto print = found == prints_.end() ? nullptr : found->second.lock();
    if (print && timed && print->print.toolpath->timing.empty()) return nullptr;
    return print;
}

void KeptPrints::keep(const std::string& path, const PrintRequest& request, const std::shared_ptr<TracedPrint>& print) {
    for (auto entry = prints_.begin(); entry != prints_.end();)
        entry = entry->second.expired() ? prints_.erase(entry) : std::next(entry);
    prints_[keyOf(path, request)] = print;
}

void KeptPrints::forget() {
    programs_.clear();
    prints_.clear();
}

}  // namespace stratum::assemble
