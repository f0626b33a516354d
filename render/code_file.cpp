#include "render/code_file.h"

#include <dlfcn.h>
#include <link.h>

namespace lacuna {

std::string codeFile() {
    Dl_info info;
    link_map* map = nullptr;
    const void* here = reinterpret_cast<const void*>(&codeFile);
    if (dladdr1(here, &info, reinterpret_cast<void**>(&map), RTLD_DL_LINKMAP) == 0 || !map ||
        map->l_name[0] == '\0') {
        return "/proc/self/exe";
    }
    return map->l_name;
}

}  // namespace lacuna
