// What a fuzz target demands of what it has read: a trap is a crash, whose input the fuzzer keeps.
#pragma once

inline void require(bool good) {
    if (!good) __builtin_trap();
}
