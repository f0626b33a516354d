// TCP to someone who may be away, slow or gone: no wait without an end, no signals.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <span>

#include "render/live/server_address.h"

namespace lacuna {

class TcpConnection {
  public:
    /// Asked every few milliseconds while there is waiting to do; false ends it.
    using GoOn = std::function<bool()>;
    using Seconds = std::chrono::duration<double>;

    /// Throws std::runtime_error that says why there is none after `limit`.
    TcpConnection(const ServerAddress& server, Seconds limit, const GoOn& goOn);
    ~TcpConnection();
    TcpConnection(TcpConnection&& other) noexcept;
    TcpConnection(const TcpConnection&) = delete;
    TcpConnection& operator=(const TcpConnection&) = delete;

    /// All of it. Throws std::runtime_error if the other side is gone, or has taken nothing for
    /// `stall`; nothing sensible can be sent after that.
    void send(std::span<const std::byte> bytes, Seconds stall, const GoOn& goOn);
    /// Whether the other side has closed it, as far as that is known.
    bool closed() const;

  private:
    int fd_ = -1;
};

}  // namespace lacuna
