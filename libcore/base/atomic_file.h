// Files that are either written completely or not at all: results, caches, logs, JSON.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lacuna {

/// A file under construction. The bytes go to a temporary file beside the target, which has no name
/// where the file system supports that. `commit` syncs the file and renames it over the target.
/// Without a commit (an exception, an early return, a kill) the temporary file vanishes and an
/// older target stays as it was.
///
/// A target that is a symbolic link stays one. A target that is no regular file (/dev/stdout, a
/// pipe) is written to directly. A write-protected target is refused although it could be replaced.
/// To construct and drop an AtomicFile tests whether the file can be written, and leaves no trace.
/// Every member that fails throws RunError with one line that names the target.
class AtomicFile {
  public:
    explicit AtomicFile(const std::string& path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(const void* data, std::size_t bytes);
    /// Position in bytes from the start, for formats that go back to fill in a table.
    void seek(std::uint64_t position);
    std::uint64_t tell() const { return position_; }

    /// Also throws if an earlier write failed and a library swallowed its exception.
    void commit();

  private:
    [[noreturn]] void fail(const std::string& expected, int error);

    std::string path_;       // as the user named it
    std::string target_;     // symbolic links resolved
    std::string temporary_;  // empty: nameless so far, written directly, or committed
    bool nameless_ = false;
    int fd_ = -1;
    int error_ = 0;  // errno of the first failure
    std::uint64_t position_ = 0;
};

/// Writes all of `content` to `path` atomically. Throws RunError.
void writeFileAtomically(const std::string& path, std::string_view content);

}  // namespace lacuna
