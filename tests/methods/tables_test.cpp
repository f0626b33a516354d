// Tables of options: mistakes in an option's row that a compiler does not see.
#include <gtest/gtest.h>

#include <set>

#include "libcore/subspace/training_settings.h"
#include "libcore/voxel/voxel_settings.h"
#include "tests/fixtures/test_rows.h"

namespace lacuna::test {
namespace {

void expectSound(const std::string& owner, const std::vector<Option>& options) {
    std::set<std::string> names;
    for (const Option& o : options) {
        SCOPED_TRACE(owner + " " + o.name);
        EXPECT_TRUE(names.insert(o.name).second) << "a name twice";
        EXPECT_FALSE(o.help.empty());
        EXPECT_EQ(o.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_."),
                  std::string::npos);
        // The default must be written in its shortest form; the default of a choice must be one of
        // its names.
        EXPECT_NO_THROW(EXPECT_EQ(o.checked(o.standard, o.name), o.standard));
        const bool number = o.kind == Option::Kind::Integer || o.kind == Option::Kind::Real;
        EXPECT_EQ(o.low < o.high, number);
        // Integers are read as doubles, which are not exact beyond this.
        EXPECT_LE(o.high, 0x1p53);
    }
}

TEST(OptionTables, everyDefaultIsWhatItsOptionTakes) {
    for (const MethodRow& row : methods()) expectSound(row.name, row.options);
    expectSound("voxels", voxelOptions().options());
    expectSound("training", trainingOptions().options());
}

TEST(OptionTables, presetsAreValuesThatTheRowTakes) {
    for (const MethodRow& row : methods()) {
        SCOPED_TRACE(row.name);
        const Settings measured = resolve(row, {});
        EXPECT_NO_THROW(row.create(measured));
        if (row.paper.empty()) continue;
        const std::vector<std::string> preset = {"preset=paper"};
        const Settings paper = resolve(row, preset);
        EXPECT_NO_THROW(row.create(paper));
        for (const std::string& assignment : row.paper) {
            const std::string name = assignment.substr(0, assignment.find('='));
            EXPECT_EQ(name + "=" + paper.at(name), assignment) << "in its shortest form";
            // A single parameter overrides the preset, wherever it stands.
            const std::vector<std::string> both = {name + "=" + measured.at(name), preset[0]};
            EXPECT_EQ(resolve(row, both).at(name), measured.at(name));
        }
    }
}

}  // namespace
}  // namespace lacuna::test
