/* A disk, or a network's file system, that takes its time: LD_PRELOADed, every write to a file waits
   before it goes on. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

static void wait_if_file(int fd) {
    struct stat of;
    if (fd <= STDERR_FILENO || fstat(fd, &of) != 0 || !S_ISREG(of.st_mode)) return;
    const struct timespec pause = {0, 3 * 1000 * 1000};
    nanosleep(&pause, NULL);
}

ssize_t write(int fd, const void* data, size_t size) {
    ssize_t (*next)(int, const void*, size_t) =
        (ssize_t(*)(int, const void*, size_t))dlsym(RTLD_NEXT, "write");
    wait_if_file(fd);
    return next(fd, data, size);
}

ssize_t writev(int fd, const struct iovec* parts, int count) {
    ssize_t (*next)(int, const struct iovec*, int) =
        (ssize_t(*)(int, const struct iovec*, int))dlsym(RTLD_NEXT, "writev");
    wait_if_file(fd);
    return next(fd, parts, count);
}
