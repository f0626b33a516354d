// What becomes of memory that the process has freed: it stays for the next use, or goes back to the system.
#pragma once

namespace lacuna {

/// Freed memory stays in the process from now on. Every iteration adds a film and frees it, and where pages are dear (in
/// virtual machines) new ones take longer than the sums that are made in them. For programs, not for libraries: it
/// holds for the whole process. Without glibc it does nothing.
void keepFreedMemory();

/// Gives all freed memory back once, before something large is made that cannot use it. Without glibc it does nothing.
void returnFreedMemory();

}  // namespace lacuna
