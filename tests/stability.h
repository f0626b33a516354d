// Ties a test to the hard case that it covers: stability_cases.py lists the cases, and
// stability_table.py makes the table of STABILITY.md of what is recorded here.
#pragma once

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace lacuna::test {

/// The running test covers `name`, a case of stability_cases.py, and `measured` is what it found;
/// `unit` says of what, the larger the worse (of a test's parameters the table shows the largest).
/// Called at the end of a test, once per case, with the name in quotes: stability_table.py reads it
/// in the source as well.
inline void stabilityCase(const std::string& name, double measured, const std::string& unit) {
    std::ostringstream text;
    text.precision(2);
    text << measured << ' ' << unit;
    testing::Test::RecordProperty("case-" + name, text.str());
}

}  // namespace lacuna::test
