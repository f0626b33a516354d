#include "tests/render/tev_double.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace lacuna::test {
namespace {

constexpr auto kLong = std::chrono::seconds(120);

/// Reads the fields of a packet from its front.
class Fields {
  public:
    Fields(const std::uint8_t* bytes, std::size_t size) : at_(bytes), left_(size) {}

    std::uint64_t number(int bytes) {
        if (left_ < std::size_t(bytes)) throw std::runtime_error("a packet that is too short");
        std::uint64_t value = 0;
        for (int i = 0; i < bytes; ++i) value |= std::uint64_t(at_[i]) << (8 * i);
        at_ += bytes;
        left_ -= std::size_t(bytes);
        return value;
    }
    int integer() { return int(std::uint32_t(number(4))); }
    std::string text() {
        std::string s;
        while (const auto c = char(number(1))) s += c;
        return s;
    }
    std::vector<std::string> texts(int n) {
        std::vector<std::string> list;
        for (int i = 0; i < n; ++i) list.push_back(text());
        return list;
    }
    std::vector<std::int64_t> numbers(int n) {
        std::vector<std::int64_t> list;
        for (int i = 0; i < n; ++i) list.push_back(std::int64_t(number(8)));
        return list;
    }
    float value(std::size_t index) const {
        if (4 * index + 4 > left_) throw std::runtime_error("a tile without all its values");
        return std::bit_cast<float>(std::uint32_t(Fields(at_ + 4 * index, 4).number(4)));
    }
    std::size_t left() const { return left_; }

  private:
    const std::uint8_t* at_;
    std::size_t left_;
};

void require(bool holds, const char* what) {
    if (!holds) throw std::runtime_error(what);
}

}  // namespace

TevDouble::TevDouble(Manner manner) : manner_(Manner::Absent) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int little = 1 << 14;  // so that a picture does not fit into the unread buffer
    setsockopt(listener_, SOL_SOCKET, SO_RCVBUF, &little, sizeof little);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
        throw std::runtime_error("no port to listen at");
    }
    socklen_t size = sizeof address;
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    setManner(manner);
    thread_ = std::thread([this] { run(); });
}

TevDouble::~TevDouble() {
    stop_ = true;
    thread_.join();
    close(listener_);
}

void TevDouble::setManner(Manner manner) {
    if (manner_ == Manner::Absent && manner != Manner::Absent) listen(listener_, 5);
    manner_ = manner;
}

TevDouble::State TevDouble::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

bool TevDouble::waitFor(const std::function<bool(const State&)>& wanted) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kLong, [&] { return wanted(state_); });
}

bool TevDouble::waitForPicture(const std::string& name) const {
    return waitFor([&](const State& s) {
        const auto found = s.pictures.find(name);
        return found != s.pictures.end() && found->second.whole;
    });
}

void TevDouble::run() {
    std::vector<Guest> guests;
    while (!stop_) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        if (manner_ == Manner::Absent) continue;
        const int fd = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (fd >= 0) {
            guests.push_back({fd, {}, 0});
            const std::lock_guard lock(mutex_);
            ++state_.connections;
            changed_.notify_all();
        }
        if (manner_ == Manner::NeverReads) continue;
        std::erase_if(guests, [&](Guest& g) {
            const bool stays = receive(g);
            if (!stays) close(g.fd);
            return !stays;
        });
    }
    for (const Guest& g : guests) close(g.fd);
}

/// Receives the available bytes. False if the connection has ended.
bool TevDouble::receive(Guest& guest) {
    constexpr std::size_t kInTheMiddleOfATile = 100'000;
    std::vector<std::uint8_t> buffer(1 << 20);
    for (;;) {
        const ssize_t got = recv(guest.fd, buffer.data(), buffer.size(), 0);
        if (got < 0) return true;
        if (got == 0) return false;
        guest.taken += std::size_t(got);
        guest.bytes.insert(guest.bytes.end(), buffer.begin(), buffer.begin() + got);
        std::size_t done = 0;
        while (guest.bytes.size() - done >= 4) {
            const auto length = std::size_t(Fields(guest.bytes.data() + done, 4).number(4));
            if (length >= 5 && guest.bytes.size() - done < length) break;
            decode(guest.bytes.data() + done, length);
            done += std::max<std::size_t>(length, 4);
        }
        guest.bytes.erase(guest.bytes.begin(), guest.bytes.begin() + std::ptrdiff_t(done));
        if (manner_ == Manner::LeavesEarly && guest.taken > kInTheMiddleOfATile) {
            manner_ = Manner::Reads;
            return false;
        }
    }
}

void TevDouble::decode(const std::uint8_t* packet, std::size_t size) {
    const std::lock_guard lock(mutex_);
    changed_.notify_all();
    try {
        require(size >= 5, "a packet without a kind");
        Fields f(packet + 4, size - 4);
        const auto kind = f.number(1);
        const auto focus = f.number(1);
        require(focus <= 1, "a switch that is neither on nor off");
        const std::string name = f.text();
        if (kind == 4) {
            Picture picture;
            picture.width = f.integer();
            picture.height = f.integer();
            const std::size_t pixels = std::size_t(picture.width) * std::size_t(picture.height);
            for (const std::string& channel : f.texts(f.integer())) {
                picture.channels[channel].resize(pixels);
            }
            require(f.left() == 0, "a packet that is too long");
            seen_[name].assign(pixels, false);
            state_.pictures[name] = std::move(picture);
            ++state_.created;
            return;
        }
        require(kind == 6, "a packet of another kind");
        require(state_.pictures.contains(name), "a tile of an image that is not there");
        Picture& picture = state_.pictures[name];
        const int n = f.integer();
        const std::vector<std::string> channels = f.texts(n);
        const int x0 = f.integer(), y0 = f.integer(), width = f.integer(), height = f.integer();
        require(width > 0 && height > 0 && x0 >= 0 && y0 >= 0 && x0 + width <= picture.width &&
                    y0 + height <= picture.height,
                "a tile that is not inside its image");
        const std::vector<std::int64_t> offsets = f.numbers(n), strides = f.numbers(n);
        std::size_t values = 0;
        const std::size_t pixels = std::size_t(width) * std::size_t(height);
        for (int c = 0; c < n; ++c) {
            require(picture.channels.contains(channels[c]), "a channel that is not there");
            std::vector<float>& plane = picture.channels[channels[c]];
            for (std::size_t i = 0; i < pixels; ++i) {
                const std::size_t index = std::size_t(offsets[c]) + i * std::size_t(strides[c]);
                const std::size_t x = std::size_t(x0) + i % std::size_t(width);
                const std::size_t y = std::size_t(y0) + i / std::size_t(width);
                values = std::max(values, index + 1);
                plane[y * std::size_t(picture.width) + x] = f.value(index);
                seen_[name][y * std::size_t(picture.width) + x] = true;
            }
        }
        require(f.left() == 4 * values, "a tile with more than its values");
        ++picture.updates;
        picture.whole = std::ranges::all_of(seen_[name], [](bool seen) { return seen; });
    } catch (const std::exception& e) {
        state_.fault = e.what();
    }
}

}  // namespace lacuna::test
