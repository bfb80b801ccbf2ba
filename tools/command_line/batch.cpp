#include "batch.h"

#include "command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace stratum::tools {

bool Batch::attempt(const std::string& input, const std::function<void()>& work) {
    if (count_ == 1) {
        work();
        return true;
    }
    try {
        work();
        return true;
    } catch (...) {
        const Failure failure = currentFailure();
        // An option that is wrong for all is wrong for the same reason: once is enough.
        if (failure.message != last_message_)
            tellError(failure.message.starts_with(input + ":")
                          ? fmt::format("{}: {}\n", tool_, failure.message)
                          : fmt::format("{}: {}: {}\n", tool_, input, failure.message));
        last_message_ = failure.message;
        worst_ = std::max(worst_, failure.status);
        failed_.push_back(input);
        failures_.push_back(
            {{"input", {{"path", input}}}, {"error", failure.message}, {"exit_status", failure.status}});
        return false;
    }
}

void Batch::finish() const {
    if (failed_.empty()) return;
    throw BatchFailure(fmt::format("{} of {} inputs failed: {}", failed_.size(), count_, fmt::join(failed_, ", ")),
                       worst_);
}

}  // namespace stratum::tools
