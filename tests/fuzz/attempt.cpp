#include "tests/fuzz/attempt.h"

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace lacuna::test {
namespace {

namespace fs = std::filesystem;

class Folder {
  public:
    Folder() {
        std::string name = (fs::temp_directory_path() / "lacuna-fuzz-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error(name + ": cannot be made");
        path_ = name;
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

}  // namespace

std::string fileOf(const std::string& name, Bytes bytes) {
    static const Folder folder;
    const std::string path = (folder.path() / name).string();
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    return path;
}

void requireProper(const Error& refusal) {
    const std::string line = refusal.what();
    if (line.find('\n') != std::string::npos) throw std::logic_error("two lines: " + line);
    if (line.find("expected") == std::string::npos && line.find("command line: ") != 0) {
        throw std::logic_error("a refusal that does not say what was expected: " + line);
    }
}

}  // namespace lacuna::test
