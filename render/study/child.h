// One child process, waited for; an interrupt is passed on to it.
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace lacuna {

/// Runs `arguments` (the first is the program's path) with stdout and stderr in `log`. When
/// `cancel` becomes true, the child is asked to end (SIGTERM) and waited for. It dies with us,
/// should we be killed. Returns its exit code, 128 + n where signal n ended it. Throws RunError if
/// it could not be started.
int runChild(const std::vector<std::string>& arguments, const std::string& log,
             const std::atomic<bool>& cancel);

}  // namespace lacuna
