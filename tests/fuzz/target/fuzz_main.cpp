// libFuzzer's target: the parser that LACUNA_FUZZ_PARSER names. tests/README.md says how it is run.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/parsers.h"

using namespace lacuna::test;

namespace {

const Parser& chosen() {
    const char* name = std::getenv("LACUNA_FUZZ_PARSER");
    for (const Parser& parser : parsers()) {
        if (name && parser.name == name) return parser;
    }
    std::fprintf(stderr, "LACUNA_FUZZ_PARSER: expected one of");
    for (const Parser& parser : parsers()) {
        std::fprintf(stderr, " %.*s", int(parser.name.size()), parser.name.data());
    }
    std::fprintf(stderr, ", found '%s'\n", name ? name : "");
    std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // One input at a time and one thread: the order of events does not depend on the machine.
    static const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
    static const Parser& parser = chosen();
    parser.accepts({data, size});
    if (testing::Test::HasFailure()) std::abort();  // what failed is on stdout
    return 0;
}
