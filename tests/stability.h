// Connects a test to the hard case that it covers. stability_cases.py lists the cases, and
// stability_table.py makes the table of STABILITY.md from the values recorded here.
#pragma once

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace lacuna::test {

/// Records that the running test covers `name`, a case of stability_cases.py, with the result
/// `measured` in `unit`. Larger values are worse; for parameterised tests the table shows the
/// largest. To be called at the end of a test, once per case, with the name in quotes:
/// stability_table.py also reads it from the source.
inline void stabilityCase(const std::string& name, double measured, const std::string& unit) {
    std::ostringstream text;
    text.precision(2);
    text << measured << ' ' << unit;
    testing::Test::RecordProperty("case-" + name, text.str());
}

}  // namespace lacuna::test
