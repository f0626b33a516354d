#include "tests/fuzz/attempt.h"

#include <stdexcept>

#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {

std::string fileOf(const std::string& name, Bytes bytes) {
    static const TempDir folder;
    return folder.write(name, bytes.data(), bytes.size());
}

void requireProper(const Error& refusal) {
    const std::string line = refusal.what();
    if (line.find('\n') != std::string::npos) throw std::logic_error("two lines: " + line);
    if (line.find("expected") == std::string::npos && line.find("command line: ") != 0) {
        throw std::logic_error("a refusal that does not say what was expected: " + line);
    }
}

}  // namespace lacuna::test
