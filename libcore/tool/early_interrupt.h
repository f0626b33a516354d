// Handling of interrupts while a tool has no InterruptGuard: before its work, or always in quick
// tools.
#pragma once

namespace lacuna {

/// From now on, SIGINT, SIGTERM and SIGHUP print that nothing is written and end the process with
/// kInterruptedExit. Files are whole or absent (atomic_file.h). A SIGHUP that is ignored (nohup)
/// stays ignored. An InterruptGuard takes over. After it the work is done, and the first signal has
/// no effect.
void endAtInterrupts();
/// From now on these signals end the process without a message, for a process whose messages
/// another one prints.
void endSilentlyAtInterrupts();

}  // namespace lacuna
