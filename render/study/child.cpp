#include "render/study/child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "libcore/base/error.h"

namespace lacuna {
namespace {

/// Blocks all signals until the returned mask is restored.
sigset_t holdSignals() {
    sigset_t all, mask;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &mask);
    return mask;
}

/// Runs in the child between fork and exec, where only system calls are allowed. Signals are
/// blocked: this process's handlers would consume an interrupt before exec, and the program would
/// never get it.
[[noreturn]] void becomeProgram(char* const* argv, int log, pid_t parent, const sigset_t& mask) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction action {};
        sigaction(number, nullptr, &action);
        if (action.sa_handler != SIG_IGN) signal(number, SIG_DFL);
    }
    sigprocmask(SIG_SETMASK, &mask, nullptr);
    // Leaves the terminal's foreground group: Ctrl-C reaches only the parent, which passes it on.
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);  // the parent was killed meanwhile
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    execv(argv[0], argv);
    _exit(127);
}

}  // namespace

int runChild(const std::vector<std::string>& arguments, const std::string& log,
             const std::atomic<bool>& cancel) {
    std::vector<char*> argv;
    for (const std::string& argument : arguments) {
        argv.push_back(const_cast<char*>(argument.c_str()));  // exec does not write to it
    }
    argv.push_back(nullptr);
    const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) throw RunError(log + ": expected to write there, found it not writable");
    const pid_t parent = getpid();
    const sigset_t mask = holdSignals();
    const pid_t child = fork();
    if (child == 0) becomeProgram(argv.data(), file, parent, mask);
    pthread_sigmask(SIG_SETMASK, &mask, nullptr);
    close(file);
    if (child < 0) throw RunError(arguments[0] + ": expected to start it, found no process left");

    bool asked = false;
    for (;;) {
        int status = 0;
        if (waitpid(child, &status, WNOHANG) == child) {
            return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        }
        if (cancel && !asked) {
            kill(child, SIGTERM);
            asked = true;
        }
        // Short compared with a run, and long enough to leave the processors to the child.
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
}

}  // namespace lacuna
