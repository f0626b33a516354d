// Interrupts while a tool has no InterruptGuard: before its work, or all the time for quick tools.
#pragma once

namespace lacuna {

/// From now on SIGINT, SIGTERM and SIGHUP say that nothing is written and end the process with
/// kInterruptedExit; files are whole or not there (atomic_file.h). A SIGHUP that is ignored (nohup)
/// stays so. An InterruptGuard takes over, and behind it the work is done: the first signal then
/// changes nothing.
void endAtInterrupts();
/// The same, but says nothing: for a process that another one speaks for.
void endSilentlyAtInterrupts();

}  // namespace lacuna
