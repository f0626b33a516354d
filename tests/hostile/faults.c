/* A system that refuses: LD_PRELOADed, the call that LACUNA_FAULT counts to fails.

     LACUNA_FAULT=NAME:N[+]      the N-th call of that name (1: the first) fails; with + all later ones too
     LACUNA_FAULT_FIRED=FILE     made when it does, so that who counts on knows where the calls end
     LACUNA_FULL=DIR             every write to a file below this directory, a real path, fails (disk full)

   Names: write (disk full), fsync (input/output error), open (too many files), rename, read (input/output
   error), mkdir (no permission), memory (allocations of 64 KiB and more), thread, clock (the time of day is
   six hours ahead or behind, in turn; the monotonic clock goes on as it is). Files are those that are named
   relative to the working directory, as the tests name theirs, or that were opened so. Standard streams never
   fail here. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

enum { LARGE = 64 * 1024, LEAP = 6 * 60 * 60 };

static const char* fault;  /* NAME:N */
static size_t fault_name;  /* length of NAME */
static long first;         /* N */
static int and_later;
static atomic_long calls;
static const char* full; /* a directory's real path, or null */

__attribute__((constructor)) static void read_fault(void) {
    full = getenv("LACUNA_FULL");
    const char* text = getenv("LACUNA_FAULT");
    const char* colon = text ? strchr(text, ':') : NULL;
    if (!colon) return;
    first = atol(colon + 1);
    and_later = text[strlen(text) - 1] == '+';
    fault_name = (size_t)(colon - text);
    fault = text;
}

/* Whether this call is one that fails. No call in here may be one that is counted. */
static int fails(const char* name) {
    if (!fault || strlen(name) != fault_name || strncmp(name, fault, fault_name) != 0) return 0;
    const long call = atomic_fetch_add(&calls, 1) + 1;
    if (call != first && !(and_later && call > first)) return 0;
    const char* fired = getenv("LACUNA_FAULT_FIRED");
    if (fired) {
        const long fd = syscall(SYS_openat, AT_FDCWD, fired, O_WRONLY | O_CREAT, 0600);
        if (fd >= 0) syscall(SYS_close, fd);
    }
    return 1;
}

static int refuse(int error) {
    errno = error;
    return -1;
}

static int is_file(int fd) {
    struct stat of;
    return fd > STDERR_FILENO && fstat(fd, &of) == 0 && S_ISREG(of.st_mode);
}

static int has_no_room(int fd) {
    char link[32], name[PATH_MAX] = "";
    if (!full) return 0;
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t length = readlink(link, name, sizeof name - 1);
    return length > 0 && strncmp(name, full, strlen(full)) == 0 && name[strlen(full)] == '/';
}

static int write_fails(int fd) {
    return is_file(fd) && (has_no_room(fd) || fails("write"));
}

static int is_ours(const char* path) {
    return path[0] != '/';
}

#define NEXT(type, name) ((type)dlsym(RTLD_NEXT, name))

ssize_t write(int fd, const void* data, size_t size) {
    if (write_fails(fd)) return refuse(ENOSPC);
    return syscall(SYS_write, fd, data, size);
}

ssize_t writev(int fd, const struct iovec* parts, int count) {
    if (write_fails(fd)) return refuse(ENOSPC);
    return syscall(SYS_writev, fd, parts, count);
}

ssize_t read(int fd, void* data, size_t size) {
    if (is_file(fd) && fails("read")) return refuse(EIO);
    return syscall(SYS_read, fd, data, size);
}

int fsync(int fd) {
    if (fails("fsync")) return refuse(EIO);
    return (int)syscall(SYS_fsync, fd);
}

int rename(const char* from, const char* to) {
    if (fails("rename")) return refuse(EACCES);
    return (int)syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to);
}

int mkdir(const char* path, mode_t mode) {
    if (is_ours(path) && fails("mkdir")) return refuse(EACCES);
    return (int)syscall(SYS_mkdirat, AT_FDCWD, path, mode);
}

static int open_mode(int flags, va_list rest) {
    return flags & O_CREAT || (flags & O_TMPFILE) == O_TMPFILE ? va_arg(rest, int) : 0;
}

int open(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const int mode = open_mode(flags, rest);
    va_end(rest);
    if (is_ours(path) && fails("open")) return refuse(EMFILE);
    return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

int open64(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const int mode = open_mode(flags, rest);
    va_end(rest);
    return open(path, flags, mode);
}

FILE* fopen(const char* path, const char* mode) {
    if (is_ours(path) && fails("open")) {
        errno = EMFILE;
        return NULL;
    }
    return NEXT(FILE * (*)(const char*, const char*), "fopen")(path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
    return fopen(path, mode);
}

/* glibc's own allocators: dlsym itself may allocate. */
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);

static void* no_memory(void) {
    errno = ENOMEM;
    return NULL;
}

void* malloc(size_t size) {
    return size >= LARGE && fails("memory") ? no_memory() : __libc_malloc(size);
}

void* calloc(size_t count, size_t size) {
    return size && count >= LARGE / size && fails("memory") ? no_memory() : __libc_calloc(count, size);
}

void* realloc(void* old, size_t size) {
    return size >= LARGE && fails("memory") ? no_memory() : __libc_realloc(old, size);
}

void* aligned_alloc(size_t alignment, size_t size) {
    return size >= LARGE && fails("memory") ? no_memory() : __libc_memalign(alignment, size);
}

int posix_memalign(void** result, size_t alignment, size_t size) {
    void* block = aligned_alloc(alignment, size);
    if (!block) return ENOMEM;
    *result = block;
    return 0;
}

void* mmap(void* at, size_t size, int protection, int flags, int fd, off_t offset) {
    if ((flags & MAP_ANONYMOUS) && size >= LARGE && fails("memory")) {
        errno = ENOMEM;
        return MAP_FAILED;
    }
    return (void*)syscall(SYS_mmap, at, size, protection, flags, fd, offset);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*body)(void*), void* with) {
    if (fails("thread")) return EAGAIN;
    return NEXT(int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*),
                "pthread_create")(thread, attributes, body, with);
}

/* Seconds by which the time of day is wrong on this look. */
static time_t leap(void) {
    static atomic_uint leaps;
    if (!fails("clock")) return 0;
    return atomic_fetch_add(&leaps, 1) % 2 == 0 ? LEAP : -LEAP;
}

int clock_gettime(clockid_t clock, struct timespec* now) {
    const int done = (int)syscall(SYS_clock_gettime, clock, now);
    if (done == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) now->tv_sec += leap();
    return done;
}

int gettimeofday(struct timeval* now, void* zone) {
    const int done = (int)syscall(SYS_gettimeofday, now, zone);
    if (done == 0) now->tv_sec += leap();
    return done;
}

time_t time(time_t* result) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (result) *result = now.tv_sec;
    return now.tv_sec;
}
