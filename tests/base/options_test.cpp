// Options as a table of typed fields: which texts they take, and what they say of others.
#include "libcore/base/options.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <stdexcept>

#include "libcore/base/error.h"

namespace lacuna::test {
namespace {

enum class Metal { Tin, Lead };

struct Inner {
    int count = 3;
};

struct Record {
    std::uint64_t paths = 1000;
    double share = 0.25;
    bool loud = true;
    Metal metal = Metal::Lead;
    std::string note = "a b";
    Inner inner;
};

OptionTable<Inner> innerTable(const Inner& defaults = {}) {
    OptionTable<Inner> table(defaults);
    table.integer("count", &Inner::count, -5, 10, "parts", "how many");
    return table;
}

OptionTable<Record> table(const Record& defaults = {}) {
    OptionTable<Record> t(defaults);
    t.integer("paths", &Record::paths, 1, 1e6, "light subpaths", "in the pool");
    t.standardText("as many as there are");
    t.real(
        "share", [](auto& r) -> auto& { return r.share; }, 0, 0.99, "", "of all");
    t.onOff("loud", &Record::loud, "whether it speaks");
    t.choice<Metal>("metal", &Record::metal, {{"tin", Metal::Tin}, {"lead", Metal::Lead}},
                    "what it is made of");
    t.text("note", &Record::note, "whatever");
    t.include("part.", &Record::inner, innerTable(defaults.inner));
    return t;
}

Settings resolved(const std::vector<std::string>& assignments) {
    return resolveOptions(table().options(), assignments, "method x", "--set ");
}

std::string refusalOf(const std::vector<std::string>& assignments) {
    try {
        resolved(assignments);
    } catch (const UsageError& e) {
        return e.what();
    }
    return "accepted";
}

void expectDefaults(const Record& r) {
    EXPECT_EQ(r.paths, 1000u);
    EXPECT_EQ(r.share, 0.25);
    EXPECT_TRUE(r.loud);
    EXPECT_EQ(r.metal, Metal::Lead);
    EXPECT_EQ(r.note, "a b");
    EXPECT_EQ(r.inner.count, 3);
}

TEST(OptionTable, aRecordsOwnValuesAreTheDefaults) {
    const std::vector<Option> options = table().options();
    ASSERT_EQ(options.size(), 6u);
    const std::vector<std::pair<std::string, std::string>> defaults = {
        {"paths", "1000"}, {"share", "0.25"}, {"loud", "on"},
        {"metal", "lead"}, {"note", "a b"},   {"part.count", "3"}};
    EXPECT_EQ(table().values({}), defaults);
    for (std::size_t i = 0; i < options.size(); ++i) {
        EXPECT_EQ(options[i].name, defaults[i].first);
        EXPECT_EQ(options[i].standard, defaults[i].second);
    }
    expectDefaults(table().read(resolved({})));
    Record others;
    others.metal = Metal::Tin;
    others.inner.count = -2;
    EXPECT_EQ(table(others).options()[3].standard, "tin");
    EXPECT_EQ(table(others).options()[5].standard, "-2");
}

TEST(OptionTable, saysWhatItTakes) {
    const std::vector<Option> options = table().options();
    EXPECT_EQ(options[0].range(), "an integer from 1 to 1000000");
    EXPECT_EQ(options[0].unit, "light subpaths");
    EXPECT_EQ(options[0].help, "in the pool");
    EXPECT_EQ(options[0].standardText, "as many as there are");
    EXPECT_EQ(options[1].range(), "a number from 0 to 0.99");
    EXPECT_EQ(options[1].standardText, "") << "only the option before is described otherwise";
    EXPECT_EQ(options[2].range(), "on or off");
    EXPECT_EQ(options[3].range(), "one of tin lead");
    EXPECT_EQ(options[4].range(), "a text");
    EXPECT_EQ(options[5].range(), "an integer from -5 to 10");
    EXPECT_EQ(options[5].unit, "parts");
}

TEST(OptionTable, readsWhatIsGivenAndTheLastOfSeveral) {
    const Record r = table().read(resolved({"paths=1e3", "share=.5", "loud=off", "metal=tin",
                                            "note=x=y, z", "part.count=-5", "paths=70"}));
    EXPECT_EQ(r.paths, 70u);
    EXPECT_EQ(r.share, 0.5);
    EXPECT_FALSE(r.loud);
    EXPECT_EQ(r.metal, Metal::Tin);
    EXPECT_EQ(r.note, "x=y, z") << "all behind the first =";
    EXPECT_EQ(r.inner.count, -5);
    EXPECT_EQ(table().read(resolved({"note="})).note, "");
}

/// The written values of a record read back as the same record.
TEST(OptionTable, valuesReadBack) {
    Record record;
    record.paths = 999'999;
    record.share = 0.1 + 0.2;
    record.loud = false;
    record.metal = Metal::Tin;
    record.inner.count = 10;
    std::vector<std::string> assignments;
    for (const auto& [name, value] : table().values(record)) {
        assignments.push_back(std::string(name).append("=").append(value));
    }
    const Record back = table().read(resolved(assignments));
    EXPECT_EQ(table().values(back), table().values(record));
    EXPECT_EQ(back.share, record.share);
}

TEST(OptionTable, limitsAreInclusiveAndNothingBeyondIsTaken) {
    EXPECT_EQ(resolved({"paths=1"}).at("paths"), "1");
    EXPECT_EQ(resolved({"paths=1e6"}).at("paths"), "1000000");
    EXPECT_EQ(resolved({"share=0.99"}).at("share"), "0.99");
    EXPECT_EQ(resolved({"part.count=-5"}).at("part.count"), "-5");
    for (const char* bad : {"paths=0", "paths=1000001", "share=0.9900000001", "share=-1e-300",
                            "part.count=-6", "part.count=11"}) {
        EXPECT_NE(refusalOf({bad}), "accepted") << bad;
    }
}

TEST(OptionTable, textsThatAreNoNumberOfItsKind) {
    for (const char* text : {"",
                             " ",
                             "1.5",
                             "0x10",
                             "0b1",
                             "1e",
                             "1,000",
                             "1 ",
                             " 1",
                             "+1",
                             "--1",
                             "1e-1",
                             "nan",
                             "inf",
                             "1e400",
                             "18446744073709551616",
                             "18446744073709551617",
                             "one",
                             "on",
                             "1;2"}) {
        EXPECT_EQ(refusalOf({std::string("paths=").append(text)}),
                  std::string("--set paths: expected an integer from 1 to 1000000, found '") +
                      text + "'");
    }
    // Zeros in front do not make a number octal.
    EXPECT_EQ(resolved({"paths=010"}).at("paths"), "10");
    for (const char* text : {"", "nan", "-nan", "inf", "0x0p0", "0.5f", "1/2", "0,5"}) {
        EXPECT_EQ(
            refusalOf({std::string("share=").append(text)}),
            std::string("--set share: expected a number from 0 to 0.99, found '") + text + "'");
    }
}

TEST(OptionTable, messagesNameTheOptionAndWhatItTakes) {
    EXPECT_EQ(refusalOf({"loud=yes"}), "--set loud: expected on or off, found 'yes'");
    EXPECT_EQ(refusalOf({"loud="}), "--set loud: expected on or off, found ''");
    EXPECT_EQ(refusalOf({"metal=Tin"}), "--set metal: expected one of tin lead, found 'Tin'");
    EXPECT_EQ(refusalOf({"part.count=x"}),
              "--set part.count: expected an integer from -5 to 10, found 'x'");
    EXPECT_EQ(refusalOf({"paths"}), "--set expected name=value, found 'paths'");
    EXPECT_EQ(refusalOf({""}), "--set expected name=value, found ''");
    const std::string names =
        "expected one of paths, share, loud, metal, note, part.count, found one that method x does "
        "not have";
    EXPECT_EQ(refusalOf({"count=1"}), "--set count: " + names) << "without its group's name";
    EXPECT_EQ(refusalOf({"=1"}), "--set : " + names);
    EXPECT_EQ(refusalOf({"Paths=1"}), "--set Paths: " + names);
    // A later value does not mend an earlier mistake.
    EXPECT_NE(refusalOf({"paths=0", "paths=1"}), "accepted");
    try {
        resolveOptions({}, std::vector<std::string>{"a=1"}, "method pt", "");
        ADD_FAILURE();
    } catch (const UsageError& e) {
        EXPECT_STREQ(e.what(), "a: expected no parameter, found one that method pt does not have");
    }
}

/// Incomplete settings are a mistake of the code, not of a user.
TEST(OptionTable, incompleteSettingsAreNoRecord) {
    Settings settings = resolved({});
    settings.erase("metal");
    EXPECT_THROW(table().read(settings), std::out_of_range);
    EXPECT_THROW(table().read({}), std::out_of_range);
}

TEST(OptionTable, readsItsOwnAmongOthers) {
    const Settings all = {{"train.count", "7"}, {"count", "1"}, {"else", "x"}};
    EXPECT_EQ(innerTable().read(all, "train.").count, 7);
    EXPECT_EQ(innerTable().read(all).count, 1);
}

TEST(NumberText, isTheShortestThatReadsBack) {
    EXPECT_EQ(numberText(0), "0");
    EXPECT_EQ(numberText(-0.0), "0");
    EXPECT_EQ(numberText(0.1), "0.1");
    EXPECT_EQ(numberText(1e6), "1000000") << "whole numbers have no exponent";
    EXPECT_EQ(numberText(-12), "-12");
    EXPECT_EQ(numberText(1.0 / 3.0), "0.3333333333333333");
    const double most = std::numeric_limits<double>::max();
    for (const double v : {0.1 + 0.2, 1e-300, -2.5e-8, 123456.789, 999'999'999'999'999.0, 1e15,
                           0x1p53 + 2.0, 0x1p63, 0x1p64, most, -most, 5e-324}) {
        ASSERT_TRUE(parseNumber(numberText(v))) << numberText(v);
        EXPECT_EQ(*parseNumber(numberText(v)), v) << numberText(v);
    }
}

}  // namespace
}  // namespace lacuna::test
