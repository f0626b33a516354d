// libFuzzer's target of one parser, LACUNA_FUZZ_PARSER. tests/README.md says how it is run.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdlib>

#include "tests/fuzz/parsers.h"

using namespace lacuna::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // One input at a time and one thread: the order of events does not depend on the machine.
    static const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
    static const Parser& parser = parserOf(LACUNA_FUZZ_PARSER);
    parser.accepts({data, size});
    if (testing::Test::HasFailure()) std::abort();  // what failed is on stdout
    return 0;
}
