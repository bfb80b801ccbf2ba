#include "early_failure.h"

#include <unistd.h>

#include <string_view>

namespace stratum::tools {
namespace {

std::terminate_handler g_usual = nullptr;

[[noreturn]] void endEarly() {
    constexpr std::string_view kText =
        "the libraries of this program can't start; there is too little memory for their threads (ulimit -v)\n";
    [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, kText.data(), kText.size());
    ::_exit(1);
}

void beforeLibraries() { g_usual = std::set_terminate(&endEarly); }

// Called before the initializers of all libraries.
[[gnu::section(".preinit_array"), gnu::used]] void (*const g_before_libraries)() = &beforeLibraries;

}  // namespace

void mainHasBegun() {
    if (g_usual != nullptr) std::set_terminate(g_usual);
}

}  // namespace stratum::tools
