// libFuzzer's target: the parser that LACUNA_FUZZ_PARSER names. tests/README.md says how it is run.
#include <gtest/gtest.h>
#include <sanitizer/allocator_interface.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>

#include "libcore/image/file_bytes.h"
#include "tests/fuzz/parsers.h"

using namespace lacuna;
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

/// What an input may have allocated at one time: so much, and so much more for each of its bytes. Half of it is for
/// what is unpacked.
constexpr std::int64_t kFreeBytes = 2 * kUnpackedFree, kBytesPerByte = 2 * kUnpackedPerByte;

std::atomic<std::int64_t> heldBytes = 0, mostBytes = 0;

void allocated(const volatile void*, std::size_t size) {
    const std::int64_t held = heldBytes += std::int64_t(size);
    if (held > mostBytes) mostBytes = held;
}

void freed(const volatile void* block) {
    if (!block) return;
    heldBytes -= std::int64_t(__sanitizer_get_allocated_size(const_cast<const void*>(block)));
}

void requireModestMemory(std::int64_t before, std::size_t size) {
    const std::int64_t took = mostBytes - before;
    const std::int64_t may = kFreeBytes + kBytesPerByte * std::int64_t(size);
    if (took <= may) return;
    std::fprintf(stderr, "%zu bytes of input took %lld bytes of memory, expected at most %lld\n",
                 size, (long long)took, (long long)may);
    std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // One input at a time and one thread: the order of events does not depend on the machine.
    static const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
    static const Parser& parser = chosen();
    [[maybe_unused]] static const int watched =
        __sanitizer_install_malloc_and_free_hooks(allocated, freed);
    const std::int64_t before = heldBytes;
    mostBytes = before;
    parser.accepts({data, size});
    requireModestMemory(before, size);
    if (testing::Test::HasFailure()) std::abort();  // what failed is on stdout
    return 0;
}
