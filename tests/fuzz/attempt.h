// Shared parts of all parsers' tests: bytes as a file, and the check of proper refusals.
#pragma once

#include <string>

#include "libcore/base/error.h"
#include "tests/fuzz/parsers.h"

namespace lacuna::test {

/// Writes a file with this content and returns its path, which depends only on the name. Its folder belongs to this
/// process and is deleted at its end.
std::string fileOf(const std::string& name, Bytes bytes);

/// Throws std::logic_error unless the message is one line that says what was expected.
void requireProper(const Error& refusal);

/// Whether `read` succeeds. It may only throw a proper InputError or UsageError.
template <class Read>
bool attempt(const Read& read) {
    try {
        read();
        return true;
    } catch (const InputError& refusal) {
        requireProper(refusal);
    } catch (const UsageError& refusal) {
        requireProper(refusal);
    }
    return false;
}

}  // namespace lacuna::test
