// Runs one child process and waits for it; passes interrupts on to it.
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace lacuna {

/// Runs `arguments` (the first is the program's path) with stdout and stderr in `log`. When
/// `cancel` becomes true, the child is asked to end (SIGTERM) and waited for. It dies if this
/// process is killed. Returns its exit code, or 128 + n if signal n ended it. Throws RunError if it
/// could not be started.
int runChild(const std::vector<std::string>& arguments, const std::string& log,
             const std::atomic<bool>& cancel);

}  // namespace lacuna
