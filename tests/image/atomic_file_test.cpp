#include "libcore/base/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "tests/image/test_files.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using test::messageOf;
using Names = std::vector<std::string>;

/// A disk that is full after `bytes` bytes of a file, for one scope: write(2) fails with EFBIG.
class SmallDisk {
  public:
    explicit SmallDisk(rlim_t bytes) : oldHandler_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &old_);
        rlimit small = old_;
        small.rlim_cur = bytes;
        ::setrlimit(RLIMIT_FSIZE, &small);
    }
    ~SmallDisk() {
        ::setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, oldHandler_);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

  private:
    rlimit old_{};
    void (*oldHandler_)(int);
};

std::string text(const std::string& path) {
    const test::Bytes bytes = test::slurp(path);
    return {bytes.begin(), bytes.end()};
}

class AtomicFileTest : public test::FileTest {};

TEST_F(AtomicFileTest, TargetAppearsWithTheCommitOnly) {
    test::spill(path("a"), "old");
    {
        AtomicFile file(path("a"));
        file.write("new content", 11);
        EXPECT_EQ(text(path("a")), "old");
        EXPECT_EQ(file.tell(), 11u);
        file.seek(4);
        file.write("C", 1);
        file.commit();
        EXPECT_EQ(text(path("a")), "new Content");
    }
    EXPECT_EQ(text(path("a")), "new Content");
    EXPECT_EQ(listing(), Names{"a"});
}

TEST_F(AtomicFileTest, WithoutCommitNothingChanges) {
    test::spill(path("a"), "old");
    {
        AtomicFile file(path("a")), other(path("b"));
        file.write("new", 3);
        other.write("new", 3);
    }
    EXPECT_EQ(text(path("a")), "old");
    EXPECT_EQ(listing(), Names{"a"});
}

TEST_F(AtomicFileTest, FullDiskKeepsTheOldFile) {
    test::spill(path("a"), "old");
    test::spill(path("a.exr"), "old");
    test::spill(path("a.png"), "old");
    test::spill(path("a.pfm"), "old");
    const LayeredImage image = test::layered(test::randomImage(64, 64, 1));
    {
        const SmallDisk disk(1000);
        const std::string message =
            messageOf<RunError>([&] { writeFileAtomically(path("a"), std::string(5000, 'x')); });
        EXPECT_NE(message.find("File too large"), std::string::npos) << message;
        for (const char* name : {"a.exr", "a.png", "a.pfm"}) {
            EXPECT_THROW(writeImage(path(name), image), RunError) << name;
        }
    }
    for (const char* name : {"a", "a.exr", "a.png", "a.pfm"}) EXPECT_EQ(text(path(name)), "old");
    EXPECT_EQ(listing(), (Names{"a", "a.exr", "a.pfm", "a.png"}));
}

/// It does not matter which part of the header, the table or the pixels no longer fits.
TEST_F(AtomicFileTest, FullDiskIsNoticedAtEveryByteOfAnExr) {
    const LayeredImage image = test::layered(test::randomImage(5, 40, 1));
    writeExr(path("a.exr"), image);
    const auto size = fs::file_size(path("a.exr"));
    fs::remove(path("a.exr"));
    for (std::uintmax_t limit = 0; limit < size; ++limit) {
        const SmallDisk disk(limit);
        ASSERT_THROW(writeExr(path("a.exr"), image), RunError) << limit;
    }
    EXPECT_TRUE(listing().empty());
}

TEST_F(AtomicFileTest, ExceptionSwallowedBySomeoneElseStillFailsTheCommit) {
    AtomicFile file(path("a"));
    {
        const SmallDisk disk(10);
        EXPECT_THROW(file.write("12345678901234567890", 20), RunError);
    }
    EXPECT_THROW(file.commit(), RunError);
    EXPECT_FALSE(fs::exists(path("a")));
}

TEST_F(AtomicFileTest, UnwritableTargets) {
    EXPECT_NE(messageOf<RunError>([&] { AtomicFile f(path("none/a")); }).find("No such file"),
              std::string::npos);
    fs::create_directory(path("directory"));
    EXPECT_THROW(AtomicFile(path("directory")), RunError);
    EXPECT_THROW(AtomicFile(path("a/")), RunError);
    EXPECT_THROW(AtomicFile(""), RunError);
    test::spill(path("file"), "x");
    EXPECT_THROW(AtomicFile(path("file/a")), RunError);
    EXPECT_THROW(AtomicFile("/proc/a"), RunError);  // root may write everywhere else
    EXPECT_EQ(listing(), (Names{"directory", "file"}));
    if (::geteuid() == 0) return;
    fs::permissions(path("file"), fs::perms::owner_read);
    EXPECT_THROW(AtomicFile(path("file")), RunError);
    fs::permissions(path("directory"), fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_THROW(AtomicFile(path("directory/a")), RunError);
    fs::permissions(path("directory"), fs::perms::owner_all);
}

TEST_F(AtomicFileTest, LinksAndDevices) {
    test::spill(path("real"), "old");
    fs::create_symlink("real", path("link"));
    writeFileAtomically(path("link"), "new");
    EXPECT_TRUE(fs::is_symlink(path("link")));
    EXPECT_EQ(text(path("real")), "new");

    // Also links to a file that does not exist yet, and through other links.
    fs::create_directory(path("folder"));
    fs::create_symlink("folder/later", path("dangling"));
    fs::create_symlink(path("dangling"), path("twice"));
    writeFileAtomically(path("twice"), "first");
    EXPECT_TRUE(fs::is_symlink(path("twice")));
    EXPECT_TRUE(fs::is_symlink(path("dangling")));
    EXPECT_EQ(text(path("folder/later")), "first");
    fs::create_symlink("round", path("round"));
    EXPECT_THROW(writeFileAtomically(path("round"), "x"), RunError);

    writeFileAtomically("/dev/null", "into the void");
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    EXPECT_NE(messageOf<RunError>([] { writeFileAtomically("/dev/full", "x"); }).find("No space"),
              std::string::npos);
}

/// `kill -9` leaves such files where the file system has no files without names.
TEST_F(AtomicFileTest, LeftoversOfKilledProcessesAreRemoved) {
    test::spill(path(".lacuna-123-0.tmp"), "left");
    test::spill(path(".lacuna-456.tmp"), "being written");
    test::spill(path(".lacuna-456.tmp.txt"), "somebody's");
    const int writer = ::open(path(".lacuna-456.tmp").c_str(), O_WRONLY);
    ASSERT_EQ(::flock(writer, LOCK_EX | LOCK_NB), 0);
    writeFileAtomically(path("a"), "x");
    EXPECT_EQ(listing(), (Names{".lacuna-456.tmp", ".lacuna-456.tmp.txt", "a"}));
    ::close(writer);
    writeFileAtomically(path("a"), "x");
    EXPECT_EQ(listing(), (Names{".lacuna-456.tmp.txt", "a"}));
}

TEST_F(AtomicFileTest, PipesWithoutAReaderAreRefusedAtOnce) {
    ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
    EXPECT_NE(messageOf<RunError>([&] { AtomicFile f(path("pipe")); }).find("start the reader"),
              std::string::npos);
    const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
    { const AtomicFile probe(path("pipe")); }
    char text[8] = {};
    EXPECT_EQ(::read(reader, text, sizeof text), -1);  // not ended, though nobody writes now
    EXPECT_EQ(errno, EAGAIN);
    writeFileAtomically(path("pipe"), "whole");
    EXPECT_EQ(::read(reader, text, sizeof text), 5);
    EXPECT_STREQ(text, "whole");
    ::close(reader);
}

TEST_F(AtomicFileTest, LongNamesAndUsualPermissions) {
    const std::string name(255, 'n');
    writeFileAtomically(path(name), "x");
    EXPECT_EQ(listing(), Names{name});
    const mode_t mask = ::umask(0);
    ::umask(mask);
    struct stat info {};
    ASSERT_EQ(::stat(path(name).c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0666 & ~mask);
}

TEST_F(AtomicFileTest, RequireWritableLeavesNoTrace) {
    test::spill(path("old.exr"), "old");
    for (const char* name : {"a.exr", "a.PNG", "a.pfm", "old.exr"}) requireWritable(path(name));
    EXPECT_EQ(listing(), Names{"old.exr"});
    EXPECT_EQ(text(path("old.exr")), "old");
    EXPECT_THROW(requireWritable(path("none/a.exr")), RunError);
    for (const char* name : {"a.jpg", "a", "a.exr.bak", ".exr", ""}) {
        EXPECT_THROW(requireWritable(path(name)), UsageError) << name;
        EXPECT_THROW(writeImage(path(name), test::layered(Image(1, 1))), UsageError) << name;
    }
    EXPECT_EQ(listing(), Names{"old.exr"});
}

}  // namespace
}  // namespace lacuna
