// Names for content: equal bytes have equal names, whatever their file is called and wherever it
// lies.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>

namespace lacuna {

/// XXH3-128 of bytes that are added piece by piece.
class ContentHash {
  public:
    ContentHash();
    ~ContentHash();
    ContentHash(const ContentHash&) = delete;
    ContentHash& operator=(const ContentHash&) = delete;

    void add(std::span<const std::byte> bytes);
    /// Adds the bytes of trivially copyable values, which must have no padding.
    template <class T>
    void addValues(std::span<const T> values) {
        add(std::as_bytes(values));
    }
    template <class T>
    void addValue(const T& value) {
        addValues(std::span(&value, 1));
    }

    /// Adds the rest of a stream. Afterwards the stream has reached its end or failed to read.
    void addStream(std::istream& stream);

    /// The hash, low half first.
    std::array<std::uint64_t, 2> digest() const;
    /// The hash in 32 hexadecimal digits, high half first.
    std::string hex() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// ContentHash::hex() of a file. Throws InputError if it cannot be read.
std::string hashOfFile(const std::string& path);

}  // namespace lacuna
