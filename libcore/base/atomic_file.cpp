#include "libcore/base/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <system_error>

#include "libcore/base/error.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

std::string directoryOf(const std::string& path) {
    const std::string parent = fs::path(path).parent_path().string();
    return parent.empty() ? "." : parent;
}

/// The path at which the bytes end up: symbolic links are followed, also to a file that does not
/// exist yet.
std::string resolved(const std::string& path) {
    constexpr int kMostLinks = 40;  // as in Linux
    fs::path at = path;
    std::error_code error;
    for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(at, error)); ++i) {
        const fs::path to = fs::read_symlink(at, error);
        if (error) return path;
        at = at.parent_path() / to;  // an absolute path replaces `at`
    }
    const fs::path real = fs::canonical(at, error);
    return error ? at.string() : real.string();
}

constexpr const char* kTemporaryStart = ".lacuna-";
constexpr const char* kTemporaryEnd = ".tmp";

/// Tries to lock a temporary file. Its writer holds the lock, which ends with the process: a file
/// that can be locked was left by a killed process. On file systems without locks the answer is
/// always true.
bool lockOwn(int fd) {
    return ::flock(fd, LOCK_EX | LOCK_NB) == 0 || errno == EOPNOTSUPP || errno == ENOLCK;
}

/// Removes the temporary files that killed processes left in the directory.
void removeLeftovers(const std::string& directory) {
    std::error_code error;
    for (fs::directory_iterator at(directory, error), end; !error && at != end;
         at.increment(error)) {
        const std::string name = at->path().filename().string();
        if (!name.starts_with(kTemporaryStart) || !name.ends_with(kTemporaryEnd)) continue;
        const int fd = ::open(at->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
        if (fd < 0) continue;
        if (::flock(fd, LOCK_EX | LOCK_NB) == 0) ::unlink(at->path().c_str());
        ::close(fd);
    }
}

/// Opens a named pipe and returns a duplicate of its descriptor. The pipe is opened once and kept
/// open until the process ends: otherwise its reader would take the end of a mere check for
/// writability for the end of the data. Returns -1 with errno ENXIO where nobody reads the pipe; an
/// ordinary open would wait for a reader.
int openPipe(const std::string& path) {
    static std::mutex mutex;
    static std::map<std::string, int> open;
    const std::lock_guard lock(mutex);
    const auto known = open.find(path);
    int kept = known == open.end() ? -1 : known->second;
    if (kept < 0) {
        kept = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
        if (kept < 0) return -1;
        ::fcntl(kept, F_SETFL, 0);  // writing waits for the reader
        open[path] = kept;
    }
    return ::fcntl(kept, F_DUPFD_CLOEXEC, 0);
}

/// Opens a file without a name, which a killed process cannot leave behind. Returns -1 where the
/// file system does not support such files, or where no /proc exists through which to name it.
int openNameless(const std::string& directory) {
    if (::access("/proc/self/fd", X_OK) != 0) return -1;
    return ::open(directory.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
}

/// Gives the nameless file the target's name. Returns -1 with errno where that fails. It takes two
/// calls, link and rename: a process that is killed between them leaves a temporary name, which the
/// next process for this target reuses. Two processes at a time may take each other's temporary
/// name; each file is whole.
int nameOver(int fd, const std::string& directory, const std::string& target) {
    const std::string link = "/proc/self/fd/" + std::to_string(fd);
    const std::string name = directory + "/" + kTemporaryStart +
                             std::to_string(std::hash<std::string>{}(target)) + kTemporaryEnd;
    for (int attempt = 0; attempt < 1000; ++attempt) {
        ::unlink(name.c_str());
        if (::linkat(AT_FDCWD, link.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) {
            if (errno == EEXIST) continue;
            return -1;
        }
        if (::rename(name.c_str(), target.c_str()) == 0) return 0;
        if (errno == ENOENT) continue;
        const int error = errno;
        ::unlink(name.c_str());
        errno = error;
        return -1;
    }
    errno = EBUSY;
    return -1;
}

/// Opens a new file beside the target. Its name does not grow with the target's (NAME_MAX). The
/// file is created with O_EXCL, so that two tools never share one.
int openNamed(const std::string& directory, std::string& name) {
    const std::string stem = directory + "/" + kTemporaryStart + std::to_string(::getpid()) + "-";
    for (int attempt = 0;; ++attempt) {
        name = stem + std::to_string(attempt) + kTemporaryEnd;
        const int fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd < 0 && errno == EEXIST && attempt < 9999) continue;
        if (fd < 0) return fd;
        // Another process may have removed the file as a leftover before it was locked.
        struct stat info {};
        if (lockOwn(fd) && ::fstat(fd, &info) == 0 && info.st_nlink > 0) return fd;
        ::close(fd);
    }
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path), target_(resolved(path)) {
    struct stat info {};
    const bool exists = ::stat(target_.c_str(), &info) == 0;
    if (!exists && errno == ELOOP) fail("expected a link that leads somewhere", ELOOP);
    if (path.empty() || path.back() == '/' || (exists && S_ISDIR(info.st_mode))) {
        fail("expected the name of a file", EISDIR);
    }
    if (exists && ::access(target_.c_str(), W_OK) != 0) {
        fail("expected a file that may be overwritten", errno);
    }
    if (exists && !S_ISREG(info.st_mode)) {
        if (S_ISFIFO(info.st_mode)) {
            fd_ = openPipe(target_);
            if (fd_ < 0 && errno == ENXIO) {
                throw RunError(path +
                               ": expected someone to read the pipe, found nobody; start the "
                               "reader first");
            }
        } else {
            fd_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
        }
    } else {
        const std::string directory = directoryOf(target_);
        removeLeftovers(directory);
        fd_ = openNameless(directory);
        nameless_ = fd_ >= 0;
        if (nameless_) lockOwn(fd_);
        if (!nameless_) {
            std::string name;
            fd_ = openNamed(directory, name);
            if (fd_ >= 0) temporary_ = name;
        }
    }
    if (fd_ < 0) {
        const int error = errno;
        fail("expected a directory '" + directoryOf(path_) + "' to write into", error);
    }
}

AtomicFile::~AtomicFile() {
    if (fd_ >= 0) ::close(fd_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::write(const void* data, std::size_t bytes) {
    const char* from = static_cast<const char*>(data);
    while (bytes > 0) {
        const ::ssize_t written = ::write(fd_, from, bytes);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            fail("expected to write " + std::to_string(bytes) + " more bytes",
                 written < 0 ? errno : EIO);
        }
        from += written;
        bytes -= std::size_t(written);
        position_ += std::uint64_t(written);
    }
}

void AtomicFile::seek(std::uint64_t position) {
    if (::lseek(fd_, off_t(position), SEEK_SET) < 0) fail("expected a seekable file", errno);
    position_ = position;
}

void AtomicFile::commit() {
    if (error_ != 0) fail("expected all of it to be written", error_);
    if (temporary_.empty() && !nameless_) {
        const int closed = ::close(fd_);
        fd_ = -1;
        if (closed != 0) fail("expected to close it", errno);
        return;
    }
    // Data before name: after a crash the target is the old file or the new one, never a part of
    // it.
    if (::fsync(fd_) != 0) fail("expected to reach the disk", errno);
    if (nameless_ && nameOver(fd_, directoryOf(target_), target_) != 0) {
        fail("expected to name it", errno);
    }
    const int closed = ::close(fd_);
    fd_ = -1;
    if (closed != 0) fail("expected to close it", errno);
    if (!nameless_ && ::rename(temporary_.c_str(), target_.c_str()) != 0) {
        fail("expected to rename " + temporary_ + " to it", errno);
    }
    temporary_.clear();
    // This makes the rename durable where the file system allows it. The file is whole either way.
    const int directory = ::open(directoryOf(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory >= 0) {
        (void)::fsync(directory);
        ::close(directory);
    }
}

void AtomicFile::fail(const std::string& expected, int error) {
    if (error_ == 0) error_ = error;
    throw RunError((path_.empty() ? "output" : path_) + ": " + expected + ", found: " +
                   std::generic_category().message(error) + "; choose another output or make room");
}

void writeFileAtomically(const std::string& path, std::string_view content) {
    AtomicFile file(path);
    file.write(content.data(), content.size());
    file.commit();
}

}  // namespace lacuna
