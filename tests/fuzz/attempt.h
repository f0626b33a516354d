// What all parsers have in common: bytes as a file, and what a proper refusal looks like.
#pragma once

#include <string>

#include "libcore/base/error.h"
#include "tests/fuzz/parsers.h"

namespace lacuna::test {

/// The path of a file with this content, the same one for all calls with this name. Its folder is this
/// process's own and gone at its end.
std::string fileOf(const std::string& name, Bytes bytes);

/// Throws std::logic_error unless it is one line that says what was expected.
void requireProper(const Error& refusal);

/// Whether `read` comes to its end. What it throws must be a proper InputError or UsageError.
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
