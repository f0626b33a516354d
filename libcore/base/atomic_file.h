// Files that are either written completely or not at all: results, caches, logs, JSON.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lacuna {

/// A file under construction. What is written goes to a temporary file beside the target, without
/// a name where the file system can do that; `commit` syncs it and renames it over the target.
/// Without a commit (an exception, an early return, a kill) the temporary file is gone and an older
/// target stays as it was.
///
/// A target that is a symbolic link keeps the link; one that is no regular file (/dev/stdout, a
/// pipe) is written to directly. A write-protected target is refused although it could be replaced.
/// Constructing and dropping one is the test whether a file can be written (it leaves no trace).
/// Every member that fails throws RunError, one line that names the target.
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

    /// Throws as well if an earlier write failed and its exception was swallowed by a library.
    void commit();

  private:
    [[noreturn]] void fail(const std::string& expected, int error);

    std::string path_;       // as the user named it
    std::string target_;     // symbolic links resolved
    std::string temporary_;  // empty: without a name yet, written directly, or committed
    bool nameless_ = false;
    int fd_ = -1;
    int error_ = 0;  // errno of the first failure
    std::uint64_t position_ = 0;
};

/// All of `content` to `path`, atomically. Throws RunError.
void writeFileAtomically(const std::string& path, std::string_view content);

}  // namespace lacuna
