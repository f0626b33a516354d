#include "render/study/report.h"

#include <nlohmann/json.hpp>

#include "libcore/base/atomic_file.h"
#include "render/output.h"
#include "render/study/page.h"
#include "render/study/page_data.h"
#include "render/study/pictures.h"
#include "render/study/tables.h"

namespace lacuna {

std::vector<std::string> writeReport(const Results& results, const std::string& directory,
                                     const std::string& chartLibrary, const std::string& json) {
    std::vector<std::string> written;
    const auto write = [&](const std::string& name, const std::string& content) {
        written.push_back(directory + "/" + name);
        writeFileAtomically(written.back(), content);
    };
    write("raw.csv", rawCsv(results));
    write("runs.csv", runsCsv(results));
    const std::vector<Table> tables = makeTables(results);
    for (const Table& table : tables) write(table.id + ".csv", csv(table));
    write("tables.md", markdown(results.study, tables));
    const nlohmann::json data = pageData(results, tables);
    write("index.html", pageHtml(results.study.title, chartLibrary, data, picturesJson(results)));
    if (!json.empty()) writeJson(json, data);
    return written;
}

}  // namespace lacuna
