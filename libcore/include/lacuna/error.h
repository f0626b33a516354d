// Exceptions. Each carries the exit code of its kind.
#pragma once

#include <stdexcept>
#include <string>

namespace lacuna {

/// Base class. The message is one line for stderr: `place: what was expected, what was found, what
/// to do`.
class Error : public std::runtime_error {
  public:
    Error(int exitCode, const std::string& message)
        : std::runtime_error(message), exitCode_(exitCode) {}
    int exitCode() const { return exitCode_; }

  private:
    int exitCode_;
};

/// Something failed while running (disk full, output not writable): exit code 1.
class RunError : public Error {
  public:
    explicit RunError(const std::string& message) : Error(1, message) {}
};

/// The command line is wrong (unknown method, absurd size): exit code 2.
class UsageError : public Error {
  public:
    explicit UsageError(const std::string& message) : Error(2, message) {}
};

/// The input (scene, image, cache) cannot be used: exit code 3.
class InputError : public Error {
  public:
    explicit InputError(const std::string& message) : Error(3, message) {}
};

/// Exit code of an interrupted tool: 128 + SIGINT, the shells' convention.
inline constexpr int kInterruptedExit = 130;

/// The work was asked to stop before it had any result: exit code 130.
class InterruptedError : public Error {
  public:
    explicit InterruptedError(const std::string& message) : Error(kInterruptedExit, message) {}
};

}  // namespace lacuna
