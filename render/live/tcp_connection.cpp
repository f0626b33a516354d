#include "render/live/tcp_connection.h"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <future>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace lacuna {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kTick = std::chrono::milliseconds(20);

[[noreturn]] void fail(const std::string& why) {
    throw std::runtime_error(why);
}

std::string textOf(int error) {
    return std::generic_category().message(error);
}

struct SocketAddress {
    sockaddr_storage address{};
    socklen_t length = 0;
};

std::vector<SocketAddress> addressesOf(const ServerAddress& server) {
    addrinfo hints{}, *list = nullptr;
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_NUMERICSERV;
    const std::string port = std::to_string(server.port);
    const int error = getaddrinfo(server.host.c_str(), port.c_str(), &hints, &list);
    if (error != 0) fail(error == EAI_SYSTEM ? textOf(errno) : gai_strerror(error));
    std::vector<SocketAddress> addresses;
    for (const addrinfo* a = list; a; a = a->ai_next) {
        addresses.push_back({{}, a->ai_addrlen});
        std::memcpy(&addresses.back().address, a->ai_addr, a->ai_addrlen);
    }
    freeaddrinfo(list);
    return addresses;
}

/// Looks up the addresses of a host. A look-up may take any time and cannot be cancelled: therefore
/// a detached thread does it.
std::vector<SocketAddress> lookUp(const ServerAddress& server, Clock::time_point end,
                                  const TcpConnection::GoOn& goOn) {
    std::packaged_task<std::vector<SocketAddress>()> task([server] { return addressesOf(server); });
    std::future<std::vector<SocketAddress>> addresses = task.get_future();
    std::thread(std::move(task)).detach();
    while (addresses.wait_for(kTick) != std::future_status::ready) {
        if (Clock::now() >= end || !goOn()) fail("the name was not looked up in time");
    }
    return addresses.get();
}

/// False when the time is over or `goOn` returns false.
bool waitUntilWritable(int fd, Clock::time_point end, const TcpConnection::GoOn& goOn) {
    for (;;) {
        pollfd wanted{fd, POLLOUT, 0};
        const int ready = ::poll(&wanted, 1, int(kTick.count()));
        if (ready > 0) return true;
        if (ready < 0 && errno != EINTR) fail(textOf(errno));
        if (Clock::now() >= end || !goOn()) return false;
    }
}

/// Connects the socket; returns 0 or errno.
int connectTo(int fd, const SocketAddress& to, Clock::time_point end,
              const TcpConnection::GoOn& goOn) {
    if (::connect(fd, reinterpret_cast<const sockaddr*>(&to.address), to.length) == 0) return 0;
    if (errno != EINPROGRESS) return errno;
    if (!waitUntilWritable(fd, end, goOn)) return ETIMEDOUT;
    int error = 0;
    socklen_t size = sizeof error;
    return ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

Clock::time_point after(TcpConnection::Seconds seconds) {
    return Clock::now() + std::chrono::duration_cast<Clock::duration>(seconds);
}

}  // namespace

TcpConnection::TcpConnection(const ServerAddress& server, Seconds limit, const GoOn& goOn) {
    const Clock::time_point end = after(limit);
    int error = EADDRNOTAVAIL;
    for (const SocketAddress& address : lookUp(server, end, goOn)) {
        fd_ = ::socket(address.address.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
        error = fd_ < 0 ? errno : connectTo(fd_, address, end, goOn);
        if (error == 0) return;
        if (fd_ >= 0) ::close(std::exchange(fd_, -1));
    }
    fail(textOf(error));
}

TcpConnection::~TcpConnection() {
    if (fd_ >= 0) ::close(fd_);
}

TcpConnection::TcpConnection(TcpConnection&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

void TcpConnection::send(std::span<const std::byte> bytes, Seconds stall, const GoOn& goOn) {
    while (!bytes.empty()) {
        const ::ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent >= 0) {
            bytes = bytes.subspan(std::size_t(sent));
        } else if (errno == EAGAIN) {
            if (!waitUntilWritable(fd_, after(stall), goOn)) fail("nothing was taken any more");
        } else if (errno != EINTR) {
            fail(textOf(errno));
        }
    }
}

bool TcpConnection::closed() const {
    char byte = 0;
    const ::ssize_t got = ::recv(fd_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    return got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR);
}

}  // namespace lacuna
