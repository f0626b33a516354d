#include <CLI/CLI.hpp>
#include <cctype>
#include <cstddef>
#include <regex>

#include "libcore/base/text_list.h"
#include "libcore/tool/help_forms.h"

namespace lacuna {
namespace {

constexpr const char* kPrograms[] = {"lacuna-compare", "lacuna-merge",       "lacuna-relight",
                                     "lacuna-render",  "lacuna-skeletonize", "lacuna-study",
                                     "lacuna-train",   "lacuna-voxelize"};

/// Text escaped for roff.
std::string roff(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        const bool lineBegins = safe.empty() || safe.back() == '\n';
        if (lineBegins && (c == '.' || c == '\'')) safe += "\\&";
        if (c == '\\') {
            safe += "\\e";
        } else if (c == '-') {
            safe += "\\-";
        } else {
            safe += c;
        }
    }
    return safe;
}

/// The footer as roff. Footers are broken at a terminal's width; indented lines stay as they are.
std::string paragraphs(const std::string& text) {
    std::string page;
    bool asItIs = false;
    for (const std::string& line : CLI::detail::split(text, '\n')) {
        if (line.empty()) continue;
        const bool indented = line.starts_with("  ");
        if (indented != asItIs) page += indented ? ".RS 2\n.nf\n" : ".fi\n.RE\n";
        asItIs = indented;
        page += roff(indented ? line.substr(2) : line) + "\n";
    }
    return page + (asItIs ? ".fi\n.RE\n" : "");
}

std::string bold(const std::string& text) {
    return "\\fB" + roff(text) + "\\fR";
}
std::string italic(const std::string& text) {
    return "\\fI" + roff(text) + "\\fR";
}

std::string sentence(std::string text) {
    text[0] = char(std::toupper(static_cast<unsigned char>(text[0])));
    return text + (text.ends_with('.') ? "" : ".");
}

/// "-o FILE [OPTIONS] SCENE.glb"
std::string synopsis(const CLI::App& app) {
    std::string line = bold(app.get_name());
    for (const CLI::Option* option : app.get_options()) {
        if (option->get_positional() || !option->get_required()) continue;
        line += " " + bold(namesOf(*option).front()) + " " + italic(typeOf(*option));
    }
    line += " [" + italic("OPTIONS") + "]";
    for (const CLI::Option* option : app.get_options()) {
        if (!option->get_positional()) continue;
        std::string name = italic(typeOf(*option));
        if (option->get_items_expected_max() > 1) name += " ...";
        line += option->get_required() ? " " + name : " [" + name + "]";
    }
    return line;
}

std::string entry(const CLI::Option& option) {
    std::string names = joined(namesOf(option), ", ", bold);
    const std::string type = typeOf(option);
    if (option.get_positional()) {
        names = italic(type);
    } else if (option.get_items_expected_max() > 0 && !type.empty()) {
        names += " " + italic(type);
    }
    return ".TP\n" + names + "\n" + roff(sentence(option.get_description())) + "\n";
}

/// "0 done, 1 failed while running, ..." as a table.
std::string exitStatus(const std::string& text) {
    static const std::regex row(R"((\d+) ((?:[^,.]|,(?! \d))+))");
    std::string page;
    for (std::sregex_iterator i(text.begin(), text.end(), row), end; i != end; ++i) {
        page += ".TP\n" + bold(i->str(1)) + "\n" + roff(sentence(i->str(2))) + "\n";
    }
    return page;
}

/// Removes `heading` and all that follows from `text`. Returns the part after `heading`.
std::string takeFrom(std::string& text, const std::string& heading) {
    const std::size_t at = text.find(heading);
    if (at == std::string::npos) return {};
    const std::string taken = text.substr(at + heading.size());
    text.resize(at);
    return taken;
}

}  // namespace

std::string manualPage(const CLI::App& app) {
    std::string upper = app.get_name();
    for (char& c : upper) c = char(std::toupper(static_cast<unsigned char>(c)));
    std::string summary = app.get_description();
    summary[0] = char(std::tolower(static_cast<unsigned char>(summary[0])));
    std::string notes = app.get_footer();
    std::string codes = takeFrom(notes, "Exit codes:");
    std::replace(codes.begin(), codes.end(), '\n', ' ');
    const std::string examples = takeFrom(notes, "Examples:");

    std::string page = ".TH " + upper + " 1 \"\" \"Lacuna " LACUNA_VERSION "\" \"User Commands\"\n";
    page += ".SH NAME\n" + roff(app.get_name()) + " \\- " + roff(summary) + "\n";
    page += ".SH SYNOPSIS\n" + synopsis(app) + "\n";
    page += ".SH DESCRIPTION\n" + roff(sentence(app.get_description())) + "\n.PP\n";
    page += paragraphs(notes) + ".SH OPTIONS\n";
    for (const std::string& group : app.get_groups()) {
        if (group.empty()) continue;  // hidden
        if (group != "Options" && group != "Positionals") page += ".SS " + roff(group) + "\n";
        for (const CLI::Option* option : app.get_options()) {
            if (option->get_group() == group) page += entry(*option);
        }
    }
    page += ".SH EXIT STATUS\n" + exitStatus(codes);
    page += ".SH EXAMPLES\n" + paragraphs(examples) + ".SH SEE ALSO\n.nh\n";
    std::string others;
    for (const std::string name : kPrograms) {
        if (name != app.get_name()) others += (others.empty() ? "" : ",\n") + bold(name) + "(1)";
    }
    return page + others + "\n";
}

}  // namespace lacuna
