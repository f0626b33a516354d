#include "libcore/cache/guarded_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "libcore/base/atomic_file.h"
#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"

namespace lacuna {

namespace {

std::string sidecarText(std::string_view bytes) {
    ContentHash hash;
    hash.addValues(std::span(bytes));
    return "lacuna-guard 1\nbytes " + std::to_string(bytes.size()) + "\nxxh3-128 " + hash.hex() +
           "\n";
}

bool readAll(const std::string& path, std::string& bytes) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream content;
    // An empty file sets failbit on `content`: only the source tells whether it could be read.
    if (!file.is_open()) return false;
    content << file.rdbuf();
    bytes = std::move(content).str();
    return !file.bad();
}

/// Holds the folder's lock while a file and its checksum are written or read. Without it, the file of one process could
/// lie beside the checksum of another. Where folders have no locks (some network file systems), such a pair is refused
/// and made again.
class PairLock {
  public:
    /// `how`: LOCK_EX to write, LOCK_SH to read.
    PairLock(const std::string& path, int how) {
        const std::string parent = std::filesystem::path(path).parent_path().string();
        fd_ = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        while (fd_ >= 0 && ::flock(fd_, how) != 0 && errno == EINTR) {
        }
    }
    ~PairLock() {
        if (fd_ >= 0) ::close(fd_);
    }
    PairLock(const PairLock&) = delete;
    PairLock& operator=(const PairLock&) = delete;

  private:
    int fd_ = -1;
};

}  // namespace

void writeGuarded(const std::string& path, std::string_view bytes) {
    const PairLock lock(path, LOCK_EX);
    writeFileAtomically(path, bytes);
    writeFileAtomically(path + ".xxh3", sidecarText(bytes));
}

std::string readGuarded(const std::string& path, const std::string& remedy) {
    std::string bytes, sidecar;
    const PairLock lock(path, LOCK_SH);
    if (!readAll(path, bytes)) {
        throw InputError(path + ": expected a cache, found no such file; " + remedy);
    }
    if (!readAll(path + ".xxh3", sidecar)) {
        throw InputError(path + ".xxh3: expected the checksum beside the cache, found none; " +
                         remedy);
    }
    if (sidecar != sidecarText(bytes)) {
        throw InputError(path + ": expected what its checksum says, found other bytes; " + remedy);
    }
    return bytes;
}

}  // namespace lacuna
