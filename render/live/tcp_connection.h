// A TCP connection to a peer that may be absent, slow or gone: every wait is bounded, and no
// signals occur.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <span>

#include "render/live/server_address.h"

namespace lacuna {

class TcpConnection {
  public:
    /// Called every few milliseconds while waiting; false ends the wait.
    using GoOn = std::function<bool()>;
    using Seconds = std::chrono::duration<double>;

    /// Connects. Throws std::runtime_error with the reason if there is no connection within
    /// `limit`.
    TcpConnection(const ServerAddress& server, Seconds limit, const GoOn& goOn);
    ~TcpConnection();
    TcpConnection(TcpConnection&& other) noexcept;
    TcpConnection(const TcpConnection&) = delete;
    TcpConnection& operator=(const TcpConnection&) = delete;

    /// Sends all bytes. Throws std::runtime_error if the peer is gone or has accepted nothing for
    /// `stall`. The connection is unusable afterwards.
    void send(std::span<const std::byte> bytes, Seconds stall, const GoOn& goOn);
    /// Whether the peer is known to have closed the connection.
    bool closed() const;

  private:
    int fd_ = -1;
};

}  // namespace lacuna
