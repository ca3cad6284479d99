// SPDX-License-Identifier: BSD-3-Clause
// Runs all tests with the widest registers of this machine, and once more for every other instruction set that the build
// has and the machine runs, the tests of the rooms whose code calls vector loops. The other rooms do the same whatever
// the registers. `--vectors=AVX2` runs all tests on that instruction set alone, and `--vectors=best` on the first alone;
// other options are doctest's.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "simd/targets.hpp"

namespace {

constexpr const char* vector_rooms = "*/simd/*,*/zones/*,*/stepping/*,*/sweeping/*";

// The best first. The baseline is what the compiler may use anywhere, and runs on any machine that this program runs on.
std::vector<std::int64_t> instruction_sets() {
    const std::int64_t runs = HWY_TARGETS & (hwy::SupportedTargets() | HWY_STATIC_TARGET);
    std::vector<std::int64_t> found;
    for (std::int64_t rest = runs; rest != 0; rest &= rest - 1) found.push_back(rest & -rest);
    return found;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string option = "--vectors=";
    std::string wanted;
    for (int k = 1; k < argc; ++k) {
        if (std::string(argv[k]).rfind(option, 0) == 0) wanted = argv[k] + option.size();
    }
    bool first = true;
    int failed = 0;
    for (const std::int64_t set : instruction_sets()) {
        if (wanted == "best" && !first) break;
        if (!wanted.empty() && wanted != "best" && wanted != hwy::TargetName(set)) continue;
        doctest::Context context(argc, argv);
        if (!first) context.addFilter("source-file", vector_rooms);
        first = false;
        hwy::SetSupportedTargetsForTest(set);
        std::printf("vector loops by %s\n", hwy::TargetName(set));
        std::fflush(stdout);
        failed |= context.run();
        if (context.shouldExit()) return failed;  // after a list or a help text
    }
    if (first) {
        std::fprintf(stderr, "%s%s: this build or this machine has no such instruction set; there are",
                     option.c_str(), wanted.c_str());
        for (const std::int64_t set : instruction_sets()) std::fprintf(stderr, " %s", hwy::TargetName(set));
        std::fprintf(stderr, "\n");
        return 1;
    }
    return failed;
}
