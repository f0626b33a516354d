#include "render/study/page.h"

#include <map>
#include <nlohmann/json.hpp>

#include "libcore/base/error.h"
#include "libcore/image/file_bytes.h"
#include "render/study/page_parts.h"

namespace lacuna {
namespace {

using nlohmann::json;

/// JSON for a script element; nothing in it can end the element.
std::string scriptText(const json& value) {
    std::string text;
    for (const char c : value.dump(-1, ' ', false, json::error_handler_t::replace)) {
        text += c == '<' ? std::string("\\u003c") : std::string(1, c);
    }
    return text;
}

std::string htmlText(const std::string& plain) {
    std::string text;
    for (const char c : plain) {
        text += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    }
    return text;
}

}  // namespace

std::string readChartLibrary() {
    const std::string path = LACUNA_CHART_JS;
    try {
        const std::vector<std::uint8_t> bytes = readFileBytes(path);
        return {bytes.begin(), bytes.end()};
    } catch (const InputError&) {
        throw RunError(path +
                       ": expected Chart.js, which draws the page's plots, found no file that can "
                       "be read; install libjs-chart.js");
    }
}

std::string pageHtml(const std::string& title, const std::string& chartLibrary, const json& data,
                     const json& pictures) {
    const std::map<std::string, std::string> parts = {{"title", htmlText(title)},
                                                      {"style", kPageStyle},
                                                      {"chart", chartLibrary},
                                                      {"data", scriptText(data)},
                                                      {"pictures", scriptText(pictures)},
                                                      {"script", kPageScript}};
    const std::string_view page = kPageFrame;
    std::string html;
    for (std::size_t at = 0; at < page.size();) {
        const std::size_t open = page.find("{{", at);
        html += page.substr(at, open - at);
        if (open == std::string_view::npos) break;
        const std::size_t close = page.find("}}", open);
        html += parts.at(std::string(page.substr(open + 2, close - open - 2)));
        at = close + 2;
    }
    return html;
}

}  // namespace lacuna
