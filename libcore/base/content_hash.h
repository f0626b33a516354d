// Names for content: the same bytes have the same name, whatever they are called or lie in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>

namespace lacuna {

/// XXH3-128 of bytes that are given piece by piece.
class ContentHash {
  public:
    ContentHash();
    ~ContentHash();
    ContentHash(const ContentHash&) = delete;
    ContentHash& operator=(const ContentHash&) = delete;

    void add(std::span<const std::byte> bytes);
    /// The bytes of trivially copyable values, which must have no padding.
    template <class T>
    void addValues(std::span<const T> values) {
        add(std::as_bytes(values));
    }
    template <class T>
    void addValue(const T& value) {
        addValues(std::span(&value, 1));
    }

    /// All that is left of a stream. At its end the stream is at its end, or failed to read.
    void addStream(std::istream& stream);

    /// Low half first.
    std::array<std::uint64_t, 2> digest() const;
    /// 32 hexadecimal digits, high half first.
    std::string hex() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// ContentHash::hex() of a file. Throws InputError if it cannot be read.
std::string hashOfFile(const std::string& path);

}  // namespace lacuna
